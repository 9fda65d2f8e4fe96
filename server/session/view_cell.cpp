// SPDX-License-Identifier: Apache-2.0
//
// Based on: H. Hoppe, "View-dependent refinement of progressive meshes", SIGGRAPH 1997 (cells of
// view space share what they need); M. Mohr et al. (2013), viewpoints on a sphere around the model.
#include "server/session/view_cell.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

/// How finely view space is divided.
struct CellSteps {
  int direction = 16;     // along an edge of the cube: 90° / 16
  double distance = 4.0;  // an octave
  double angle = 2.0;     // an octave
};

constexpr CellSteps kMotionSteps{};
constexpr CellSteps kRestSteps{32, 16.0, 8.0};
constexpr double kNearestRestDistance = 1.25;  // radii; nearer, a step aside shows another side
constexpr double kConeSteps = 16.0;            // of half-angles, from 0 to π

/// Index of a direction on a cube map of steps² cells a side, and the middle of that cell.
struct DirectionCell {
  std::uint32_t index = 0;
  glm::dvec3 middle{0.0, 0.0, 1.0};
};

DirectionCell directionCellOf(const glm::dvec3& direction, int steps) {
  const glm::dvec3 size = glm::abs(direction);
  int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const bool negative = direction[axis] < 0.0;
  // Steps equal in angle, not in tangent, so that cells are about the same size.
  const auto step = [&](int other) {
    const double angle = std::atan(direction[other] / size[axis]);  // −π/4 … π/4
    const double t = (angle / (std::atan(1.0) * 2.0) + 0.5) * steps;
    return std::clamp(static_cast<int>(std::floor(t)), 0, steps - 1);
  };
  const auto middle = [steps](int i) {
    return std::tan(((i + 0.5) / steps - 0.5) * std::atan(1.0) * 2.0);
  };
  const int a = step((axis + 1) % 3);
  const int b = step((axis + 2) % 3);
  DirectionCell cell;
  const int side = axis * 2 + (negative ? 1 : 0);
  cell.index = static_cast<std::uint32_t>((side * steps + a) * steps + b);
  cell.middle[axis] = negative ? -1.0 : 1.0;
  cell.middle[(axis + 1) % 3] = middle(a);
  cell.middle[(axis + 2) % 3] = middle(b);
  cell.middle = glm::normalize(cell.middle);
  return cell;
}

/// log2 in steps, as an unsigned number below 2^10.
std::uint32_t logStep(double value, double stepsPerOctave) {
  const double step = std::floor(std::log2(std::max(value, 1e-30)) * stepsPerOctave);
  return static_cast<std::uint32_t>(std::clamp(step + 512.0, 0.0, 1023.0));
}

}  // namespace

ViewCell viewCellOf(const protocol::Pose& pose, const protocol::ModelInfo& model) {
  const double radius = std::max(model.radius, model.gridStep);
  const glm::dvec3 center = (model.center - model.gridOrigin) / model.gridStep;
  const glm::dvec3 fromCenter = pose.eye - model.center;
  const double distance = std::max(glm::length(fromCenter), 1e-9 * radius);
  const glm::dvec3 forward = glm::normalize(pose.forward);
  const bool orthographic = pose.orthoHeight > 0.0;
  constexpr CellSteps kSteps = kMotionSteps;
  const DirectionCell direction = directionCellOf(
      orthographic                    ? -forward
      : glm::length(fromCenter) > 0.0 ? fromCenter
                                      : -forward,
      kSteps.direction);

  ViewCell cell;
  View& view = cell.view;
  view.silhouette = pose.silhouette;
  view.orthographic = orthographic;
  view.errorPx = 1.0;
  // The error bound as a length a unit of distance (an angle), or as a length.
  const double tanY = std::tan(static_cast<double>(pose.fovY) / 2.0);
  const double bound = orthographic ? pose.errorPx * pose.orthoHeight / pose.height / radius
                                    : pose.errorPx * 2.0 * tanY / pose.height;
  const std::uint32_t boundStep = logStep(bound, kSteps.angle);
  const double roundedBound = std::exp2((boundStep - 512.0) / kSteps.angle);
  const std::uint32_t distanceStep = orthographic ? 0 : logStep(distance / radius, kSteps.distance);
  const double middleDistance =
      orthographic ? 4.0 : std::exp2((distanceStep - 512.0 + 0.5) / kSteps.distance);
  const double gridRadius = radius / model.gridStep;
  view.pixelsPerUnit = orthographic ? 1.0 / (roundedBound * gridRadius) : 1.0 / roundedBound;
  view.eye = center + direction.middle * middleDistance * gridRadius;
  view.forward = -direction.middle;

  // The frustum as a cone, if the model sticks out of it. An orthographic cell takes all of it:
  // what is seen is the resting pose's own set.
  std::uint32_t coneStep = 0;
  std::uint32_t forwardIndex = 0;
  if (!orthographic) {
    const double aspect = static_cast<double>(pose.width) / pose.height;
    const double narrow = std::atan(tanY * std::min(1.0, aspect));
    const double wide = std::atan(tanY * std::hypot(1.0, aspect));
    const double toCenter =
        std::acos(std::clamp(glm::dot(-fromCenter / distance, forward), -1.0, 1.0));
    const bool inside = distance <= radius;
    if (inside || toCenter + std::asin(radius / distance) > narrow) {
      const DirectionCell look = directionCellOf(forward, kSteps.direction);
      forwardIndex = look.index + 1;
      // Two steps of slack: half a cell of looking, half a cell of standing, rounded up.
      coneStep = static_cast<std::uint32_t>(std::ceil(wide / std::acos(-1.0) * kConeSteps)) + 1;
      view.clip = View::Clip::kCone;
      view.forward = look.middle;
      view.coneHalfAngle = std::min(coneStep / kConeSteps, 1.0) * std::acos(-1.0);
    }
  }
  cell.key = direction.index;                           // 11 bits
  cell.key = cell.key << 10 | distanceStep;             // 10
  cell.key = cell.key << 10 | boundStep;                // 10
  cell.key = cell.key << 11 | forwardIndex;             // 11
  cell.key = cell.key << 5 | coneStep;                  // 5
  cell.key = cell.key << 1 | (orthographic ? 1U : 0U);  // 1
  cell.key = cell.key << 2 | static_cast<std::uint32_t>(pose.silhouette);
  return cell;
}

std::optional<ViewCell> restCellOf(const protocol::Pose& pose, const protocol::ModelInfo& model) {
  constexpr CellSteps kSteps = kRestSteps;
  const double radius = std::max(model.radius, model.gridStep);
  const glm::dvec3 fromCenter = pose.eye - model.center;
  const double distance = glm::length(fromCenter);
  if (pose.orthoHeight > 0.0 || distance < kNearestRestDistance * radius) return std::nullopt;
  const double tanY = std::tan(static_cast<double>(pose.fovY) / 2.0);
  const double narrow =
      std::atan(tanY * std::min(1.0, static_cast<double>(pose.width) / pose.height));
  const double cosToCenter = glm::dot(-fromCenter / distance, glm::normalize(pose.forward));
  const double toCenter = std::acos(std::clamp(cosToCenter, -1.0, 1.0));
  if (toCenter + std::asin(radius / distance) > narrow) return std::nullopt;

  const DirectionCell direction = directionCellOf(fromCenter, kSteps.direction);
  const std::uint32_t distanceStep = logStep(distance / radius, kSteps.distance);
  const double bound = pose.errorPx * 2.0 * tanY / pose.height;
  const std::uint32_t boundStep = logStep(bound, kSteps.angle);
  const double gridRadius = radius / model.gridStep;
  const auto octaves = [](double step, double steps) { return std::exp2((step - 512.0) / steps); };
  const double farthest = octaves(distanceStep + 1.0, kSteps.distance) * gridRadius;
  const double middle = octaves(distanceStep + 0.5, kSteps.distance) * gridRadius;
  // From the middle to a corner of the cell, and to its far side.
  const double aside = std::numbers::sqrt2 * std::numbers::pi / 4.0 / kSteps.direction;
  ViewCell cell;
  View& view = cell.view;
  view.silhouette = pose.silhouette;
  view.errorPx = 1.0;
  view.pixelsPerUnit = 1.0 / octaves(boundStep, kSteps.angle);
  view.eye = (model.center - model.gridOrigin) / model.gridStep + direction.middle * middle;
  view.eyeRadius =
      std::hypot(farthest - middle, 2.0 * std::sqrt(farthest * middle) * std::sin(aside / 2.0));
  view.forward = -direction.middle;
  cell.key = 1;  // no key of viewCellOf() reaches so far up
  cell.key = cell.key << 15 | direction.index;
  cell.key = cell.key << 10 | distanceStep;
  cell.key = cell.key << 10 | boundStep;
  cell.key = cell.key << 17;
  cell.key = cell.key << 2 | static_cast<std::uint32_t>(pose.silhouette);
  return cell;
}

}  // namespace limn
