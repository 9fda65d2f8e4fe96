// SPDX-License-Identifier: Apache-2.0
#include "server/session/view.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {
namespace {

constexpr double kFrustumSlack = 1.03;

}  // namespace

bool View::maySee(const glm::dvec3& center, double radius) const {
  const glm::dvec3 offset = center - eye;
  switch (clip) {
    case Clip::kEverything:
      return true;
    case Clip::kPlanes: {
      if (!orthographic && glm::dot(offset, forward) < -radius) return false;
      for (std::size_t i = 0; i < planeNormals.size(); ++i) {
        if (glm::dot(offset, planeNormals[i]) < planeOffsets[i] - radius) return false;
      }
      return true;
    }
    case Clip::kCone: {
      const double distance = glm::length(offset);
      if (distance <= radius) return true;
      const double angle = std::acos(std::clamp(glm::dot(offset, forward) / distance, -1.0, 1.0));
      return angle <= coneHalfAngle + std::asin(radius / distance);
    }
  }
  return true;
}

double View::projectedPx(double length, const glm::dvec3& center, double radius) const {
  if (orthographic) return length * pixelsPerUnit;
  const double nearest = glm::distance(center, eye) - radius - eyeRadius;
  if (nearest <= 0.0) return length > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
  return length * pixelsPerUnit / nearest;
}

View viewOfPose(const protocol::Pose& pose, const Grid& grid) {
  View view;
  view.eye = grid.fromModel(pose.eye);
  view.forward = glm::normalize(pose.forward);
  const glm::dvec3 right = glm::normalize(glm::cross(view.forward, glm::normalize(pose.up)));
  const glm::dvec3 up = glm::cross(right, view.forward);
  view.errorPx = pose.errorPx;
  view.silhouette = pose.silhouette;
  view.clip = View::Clip::kPlanes;
  const double aspect = static_cast<double>(pose.width) / pose.height;
  if (pose.orthoHeight > 0.0) {
    view.orthographic = true;
    const double height = pose.orthoHeight / grid.step;
    view.pixelsPerUnit = pose.height / height;
    const double halfY = kFrustumSlack * height / 2.0;
    const double halfX = halfY * aspect;
    view.planeNormals = {right, -right, up, -up};
    view.planeOffsets = {-halfX, -halfX, -halfY, -halfY};
    return view;
  }
  const double tanY = std::tan(static_cast<double>(pose.fovY) / 2.0);
  view.pixelsPerUnit = pose.height / (2.0 * tanY);
  const double wideY = kFrustumSlack * tanY;
  const double wideX = wideY * aspect;
  view.planeNormals = {
      glm::normalize(wideX * view.forward + right),
      glm::normalize(wideX * view.forward - right),
      glm::normalize(wideY * view.forward + up),
      glm::normalize(wideY * view.forward - up)};
  return view;
}

Facing facingOf(const View& view, const SplitBounds& bounds, const SplitCone& cone) {
  if (cone.cos <= -1.0F) return Facing::kStraddling;
  const glm::dvec3 axis(cone.axis);
  // Of the half-angle θ, and of the angle φ by which directions to the eye differ.
  const double cosCone = std::min(1.0, static_cast<double>(cone.cos));
  const double sinCone = std::sqrt(1.0 - cosCone * cosCone);
  double sinSpread = 0.0;
  glm::dvec3 toEye = -view.forward;
  if (!view.orthographic) {
    const glm::dvec3 offset = view.eye - glm::dvec3(bounds.center);
    const double distance = glm::length(offset);
    const double spread = bounds.radius + view.eyeRadius;
    if (distance <= spread) return Facing::kStraddling;
    toEye = offset / distance;
    // Directions to the eye from within the sphere differ by up to this from that of its centre.
    sinSpread = spread / distance;
  }
  const double cosSpread = std::sqrt(1.0 - sinSpread * sinSpread);
  // θ + φ reaches a right angle.
  if (cosCone * cosSpread <= sinCone * sinSpread) return Facing::kStraddling;
  // Compared by sines: |cos(angle)| > sin(θ + φ) is |angle − 90°| > θ + φ.
  const double cosAngle = glm::dot(axis, toEye);
  const double sinBoth = sinCone * cosSpread + cosCone * sinSpread;
  if (cosAngle > sinBoth) return Facing::kFront;
  if (cosAngle < -sinBoth) return Facing::kBack;
  return Facing::kStraddling;
}

bool sameView(const protocol::Pose& a, const protocol::Pose& b) {
  return a.eye == b.eye && a.forward == b.forward && a.up == b.up && a.fovY == b.fovY &&
         a.orthoHeight == b.orthoHeight && a.width == b.width && a.height == b.height &&
         a.errorPx == b.errorPx && a.silhouette == b.silhouette;
}

}  // namespace limn
