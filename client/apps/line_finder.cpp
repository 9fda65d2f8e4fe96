// SPDX-License-Identifier: Apache-2.0
#include "client/apps/line_finder.h"

#include <chrono>
#include <utility>

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

bool isChosen(LineKind kind, const FeatureChoice& choice) {
  switch (kind) {
    case LineKind::kSilhouette:
      return true;
    case LineKind::kCrease:
      return choice.crease;
    case LineKind::kBorder:
      return choice.border;
    case LineKind::kSeam:
      return choice.seam;
  }
  return false;
}

/// Appends the lines of `from` that `choice` wants.
void append(const PolylineSet& from, const FeatureChoice& choice, PolylineSet& to) {
  for (const PolylineSet::Line& line : from.lines) {
    if (!isChosen(line.kind, choice)) continue;
    PolylineSet::Line moved = line;
    moved.begin = static_cast<std::uint32_t>(to.points.size());
    moved.end = moved.begin + (line.end - line.begin);
    to.points.insert(
        to.points.end(),
        from.points.begin() + line.begin,
        from.points.begin() + line.end);
    to.halfEdges.insert(
        to.halfEdges.end(),
        from.halfEdges.begin() + line.begin,
        from.halfEdges.begin() + line.end);
    to.faces.insert(to.faces.end(), from.faces.begin() + line.begin, from.faces.begin() + line.end);
    to.lines.push_back(moved);
  }
}

}  // namespace

LineFinder::LineFinder(
    std::shared_ptr<const MeshSnapshot> snapshot,
    const LineFinderOptions& options)
    : snapshot_(std::move(snapshot)),
      light_(options.light),
      field_(snapshot_->mesh.mesh(), snapshot_->mesh.positions(), options.silhouette) {
  DetectorOptions detector;
  detector.seeds = snapshot_->seeds.get();
  detector.slotOf = [&mesh = snapshot_->mesh](VertexId v) {
    return mesh.holds(v) ? mesh.slotOf(v) : kNone;
  };
  detector_ = makeDetector(options.detector, field_, detector);
  append(
      chainFeatures(
          snapshot_->mesh.mesh(),
          snapshot_->mesh.positions(),
          snapshot_->mesh.features()),
      options.features,
      features_);
}

LineFinder::Lines LineFinder::find(const Camera& camera) {
  const SilhouetteView view = viewOf(camera);
  Lines result;
  auto begin = Clock::now();
  const SilhouetteResult& found = detector_->detect(view);
  result.detectMs = millisecondsSince(begin);
  begin = Clock::now();
  const PolylineSet& silhouettes = chainer_.chain(field_, view, found);
  result.chainMs = millisecondsSince(begin);
  result.stats = found.stats;
  for (const PolylineSet::Line& line : silhouettes.lines)
    result.loops += line.closed ? 1 : 0;
  result.lines = silhouettes;
  append(features_, {true, true, true}, result.lines);
  return result;
}

double LineFinder::recallFrom(const Camera& camera) {
  const SilhouetteView view = viewOf(camera);
  const auto brute = makeDetector(DetectorMethod::kBrute, field_);
  return recall(detector_->detect(view), brute->detect(view));
}

SilhouetteView LineFinder::viewOf(const Camera& camera) const {
  SilhouetteView view;
  if (light_) {
    view.eye = snapshot_->model.grid.fromModel(*light_);
    return view;
  }
  view.eye = snapshot_->model.grid.fromModel(camera.eye);
  view.forward = camera.forward();
  view.orthographic = camera.orthographic;
  return view;
}

}  // namespace limn
