// SPDX-License-Identifier: Apache-2.0
#include "client/pose/path_recorder.h"

namespace limn {
namespace {

bool isSame(const Camera& a, const Camera& b) {
  return a.eye == b.eye && a.target == b.target && a.up == b.up && a.fovDegrees == b.fovDegrees &&
         a.orthographic == b.orthographic;
}

}  // namespace

void PathRecorder::add(double seconds, const Camera& camera) {
  if (!moments_.empty()) {
    if (!(seconds > lastSeconds_)) return;
    if (isSame(moments_.back().camera, camera)) {
      lastSeconds_ = seconds;
      return;
    }
    // It stood until a moment ago: the way to the new place begins there.
    if (lastSeconds_ > moments_.back().seconds)
      moments_.push_back({lastSeconds_, moments_.back().camera});
  }
  moments_.push_back({seconds, camera});
  lastSeconds_ = seconds;
}

RecordedPath PathRecorder::path() const {
  RecordedPath path = moments_;
  if (path.empty()) return path;
  if (lastSeconds_ > path.back().seconds) path.push_back({lastSeconds_, path.back().camera});
  const double start = path.front().seconds;
  for (RecordedCamera& moment : path)
    moment.seconds -= start;
  return path;
}

}  // namespace limn
