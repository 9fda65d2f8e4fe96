// SPDX-License-Identifier: Apache-2.0
#include "client/apps/render_views.h"

#include "client/apps/drawing_options.h"
#include "client/pose/camera_file.h"
#include "client/pose/recorded_path.h"

#include <algorithm>

namespace limn {
namespace {

protocol::Goal goalOf(const StopCondition& until) {
  if (until.kind != StopCondition::Kind::kState) return protocol::Goal::kSettled;
  switch (until.state) {
    case MeshState::kExact:
      return protocol::Goal::kExact;
    case MeshState::kComplete:
      return protocol::Goal::kComplete;
    default:
      return protocol::Goal::kSettled;
  }
}

}  // namespace

Result<CameraPath> camerasOf(const RenderCommandOptions& options, const BoundingSphere& sphere) {
  const std::uint32_t frames = std::max(options.frames, 1U);  // what streams is looked at, too
  Camera first;
  if (!options.cameraFile.empty()) {
    auto camera = readCameraFile(options.cameraFile);
    if (!camera) return tl::unexpected(camera.error());
    first = *camera;
    if (options.fovDegrees) first.fovDegrees = *options.fovDegrees;
    first.orthographic = first.orthographic || options.orthographic;
    fitDepthRange(sphere, first);
    return CameraPath(frames, first);
  }
  CameraPath path;
  if (!options.recordedPath.empty()) {
    const auto recorded = readRecordedPath(options.recordedPath);
    if (!recorded) return tl::unexpected(recorded.error());
    const double step = durationOf(*recorded) / std::max(frames - 1, 1U);
    for (std::uint32_t i = 0; i < frames; ++i) {
      path.push_back(cameraAt(*recorded, i * step));
      if (options.fovDegrees) path.back().fovDegrees = *options.fovDegrees;
      path.back().orthographic = path.back().orthographic || options.orthographic;
    }
  } else {
    const Orbit orbit = options.orbit.value_or(Orbit{});
    const double fov = options.fovDegrees.value_or(Camera{}.fovDegrees);
    path = orbitPath(sphere, orbit, fov, options.orbitPath ? frames : 1);
    path.resize(frames, path.front());
    for (Camera& camera : path)
      camera.orthographic = options.orthographic;
  }
  for (Camera& camera : path)
    fitDepthRange(sphere, camera);
  return path;
}

ClientView
viewOf(const RenderCommandOptions& options, const StopCondition& until, const Camera& camera) {
  ClientView view;
  view.camera = camera;
  view.viewport = options.viewport;
  view.errorPx = static_cast<float>(options.errorPx);
  view.silhouette = wantedSilhouette(options);
  view.goal = goalOf(until);
  return view;
}

}  // namespace limn
