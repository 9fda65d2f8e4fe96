// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/pose/recorded_path.h"

namespace limn {

/// Records a camera that is looked at again and again. While it stands nothing is kept but how
/// long. Threads: one at a time.
class PathRecorder {
 public:
  /// seconds: of any clock, not before the last ones.
  void add(double seconds, const Camera& camera);

  /// The path so far, its times from 0. Empty when nothing was added.
  [[nodiscard]] RecordedPath path() const;

 private:
  RecordedPath moments_;
  double lastSeconds_ = 0.0;  // when the last of them still stood
};

}  // namespace limn
