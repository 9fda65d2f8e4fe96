// SPDX-License-Identifier: Apache-2.0
#include "client/core/pose_reporter.h"

#include "protocol/limits.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

std::uint16_t toPixels(int pixels) {
  return static_cast<std::uint16_t>(std::clamp<int>(pixels, 1, limits::kMaxViewportPixels));
}

}  // namespace

protocol::Pose toPose(const ClientView& view, std::uint8_t channel, std::uint32_t id) {
  protocol::Pose pose;
  pose.channel = channel;
  pose.id = id;
  pose.eye = view.camera.eye;
  pose.forward = view.camera.forward();
  pose.up = view.camera.up;
  pose.fovY = static_cast<float>(glm::radians(view.camera.fovDegrees));
  if (view.camera.orthographic) {
    // The height that the perspective camera sees at its target.
    pose.orthoHeight = 2.0 * std::tan(glm::radians(view.camera.fovDegrees) / 2.0) *
                       glm::distance(view.camera.eye, view.camera.target);
  }
  pose.width = toPixels(view.viewport.width);
  pose.height = toPixels(view.viewport.height);
  pose.errorPx = std::clamp(view.errorPx, limits::kMinErrorPx, limits::kMaxErrorPx);
  pose.silhouette = view.silhouette;
  pose.goal = view.goal;
  return pose;
}

void PoseReporter::set(const ClientView& view) {
  if (view_ &&
      encodeMessage(toPose(*view_, channel_, 0)) == encodeMessage(toPose(view, channel_, 0))) {
    return;
  }
  view_ = view;
  waiting_ = true;
  ++newestId_;
}

void PoseReporter::repeat() {
  if (!view_) return;
  waiting_ = true;
  ++newestId_;
  earliestMs_ = 0;
}

std::optional<protocol::Pose> PoseReporter::next(std::uint64_t nowMs) {
  if (!waiting_ || nowMs < earliestMs_) return std::nullopt;
  waiting_ = false;
  earliestMs_ = nowMs + kMinIntervalMs;
  return toPose(*view_, channel_, newestId_);
}

std::optional<protocol::Pose> PoseReporter::newest() const {
  if (!view_) return std::nullopt;
  return toPose(*view_, channel_, newestId_);
}

std::optional<std::uint64_t> PoseReporter::dueAtMs() const {
  if (!waiting_) return std::nullopt;
  return earliestMs_;
}

}  // namespace limn
