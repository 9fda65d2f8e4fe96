// SPDX-License-Identifier: Apache-2.0
//
// Based on: H. Hoppe, "View-dependent refinement of progressive meshes", SIGGRAPH 1997 (cells of
// view space share what they need); M. Mohr et al. (2013), viewpoints on a sphere around the model.
#include "server/session/view_cell.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

constexpr double kPi = std::numbers::pi;

/// How finely view space is divided.
struct CellSteps {
  int direction;    // along an edge of the cube: 90° / 16
  double distance;  // an octave
  double angle;     // an octave
};

constexpr CellSteps kMotionSteps{16, 4.0, 2.0};
constexpr CellSteps kRestSteps{32, 16.0, 8.0};
constexpr double kNearestRestDistance = 1.25;  // radii; nearer, a step aside shows another side
constexpr double kConeSteps = 16.0;            // of half-angles, from 0 to π
constexpr double kOrthographicDistance = 4.0;  // radii; any will do

// What a cell's number is made of, from its lowest bit on.
constexpr int kSilhouetteBits = 2;
constexpr int kLogBits = 10;
// Of viewCellOf().
constexpr int kOrthographicBits = 1;
constexpr int kConeBits = 5;
constexpr int kDirectionBits = 11;
// Of restCellOf(); the last bit is one that no number of viewCellOf() has.
constexpr int kRestDirectionBits = 15;
constexpr int kRestBit = 54;
constexpr int kRestGap = kRestBit - kSilhouetteBits - 2 * kLogBits - kRestDirectionBits;

/// The tangent at step i of an edge of the cube: steps are equal in angle, not in tangent, so that
/// cells are about the same size.
double tangentAt(double i, int steps) {
  return std::tan((i / steps - 0.5) * kPi / 2.0);
}

/// Tangents of where the steps after the first begin.
template <int Steps>
const std::array<double, Steps - 1>& stepBegins() {
  static const auto begins = [] {
    std::array<double, Steps - 1> tangents{};
    for (int i = 1; i < Steps; ++i)
      tangents[static_cast<std::size_t>(i) - 1] = tangentAt(i, Steps);
    return tangents;
  }();
  return begins;
}

/// Index of a direction on a cube map of Steps² cells a side.
template <int Steps>
std::uint32_t directionIndexOf(const glm::dvec3& direction) {
  const glm::dvec3 size = glm::abs(direction);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto& begins = stepBegins<Steps>();
  const auto step = [&](int other) {
    const double tangent = direction[other] / size[axis];  // −1 … 1
    return static_cast<int>(std::ranges::upper_bound(begins, tangent) - begins.begin());
  };
  const int a = step((axis + 1) % 3);
  const int b = step((axis + 2) % 3);
  const int side = axis * 2 + (direction[axis] < 0.0 ? 1 : 0);
  return static_cast<std::uint32_t>((side * Steps + a) * Steps + b);
}

/// The middle of a cell of the cube map.
glm::dvec3 directionOf(std::uint32_t index, int steps) {
  const int cell = static_cast<int>(index);
  const int b = cell % steps;
  const int a = cell / steps % steps;
  const int side = cell / (steps * steps);
  const int axis = side / 2;
  glm::dvec3 middle;
  middle[axis] = side % 2 == 1 ? -1.0 : 1.0;
  middle[(axis + 1) % 3] = tangentAt(a + 0.5, steps);
  middle[(axis + 2) % 3] = tangentAt(b + 0.5, steps);
  return glm::normalize(middle);
}

/// log2 in steps, as an unsigned number below 2^10.
std::uint32_t logStep(double value, double stepsPerOctave) {
  const double step = std::floor(std::log2(std::max(value, 1e-30)) * stepsPerOctave);
  return static_cast<std::uint32_t>(std::clamp(step + 512.0, 0.0, 1023.0));
}

double octaves(double step, double stepsPerOctave) {
  return std::exp2((step - 512.0) / stepsPerOctave);
}

/// Takes a number's fields apart, from the lowest bit on.
class Fields {
 public:
  explicit Fields(ViewCell cell) : rest_(cell) {}

  std::uint32_t take(int bits) {
    const auto field = static_cast<std::uint32_t>(rest_ & ((ViewCell{1} << bits) - 1));
    rest_ >>= bits;
    return field;
  }

 private:
  ViewCell rest_;
};

glm::dvec3 centerOnGrid(const protocol::ModelInfo& model) {
  return (model.center - model.gridOrigin) / model.gridStep;
}

View viewOfRestCell(Fields fields, const protocol::ModelInfo& model) {
  constexpr CellSteps kSteps = kRestSteps;
  View view;
  view.silhouette = static_cast<protocol::Silhouette>(fields.take(kSilhouetteBits));
  static_cast<void>(fields.take(kRestGap));
  const std::uint32_t boundStep = fields.take(kLogBits);
  const std::uint32_t distanceStep = fields.take(kLogBits);
  const glm::dvec3 direction = directionOf(fields.take(kRestDirectionBits), kSteps.direction);
  const double gridRadius = std::max(model.radius, model.gridStep) / model.gridStep;
  const double farthest = octaves(distanceStep + 1.0, kSteps.distance) * gridRadius;
  const double middle = octaves(distanceStep + 0.5, kSteps.distance) * gridRadius;
  // From the middle to a corner of the cell, and to its far side.
  const double aside = std::numbers::sqrt2 * kPi / 4.0 / kSteps.direction;
  view.errorPx = 1.0;
  view.pixelsPerUnit = 1.0 / octaves(boundStep, kSteps.angle);
  view.eye = centerOnGrid(model) + direction * middle;
  view.eyeRadius =
      std::hypot(farthest - middle, 2.0 * std::sqrt(farthest * middle) * std::sin(aside / 2.0));
  view.forward = -direction;
  return view;
}

}  // namespace

ViewCell viewCellOf(const protocol::Pose& pose, const protocol::ModelInfo& model) {
  constexpr CellSteps kSteps = kMotionSteps;
  const double radius = std::max(model.radius, model.gridStep);
  const glm::dvec3 fromCenter = pose.eye - model.center;
  const double distance = std::max(glm::length(fromCenter), 1e-9 * radius);
  const glm::dvec3 forward = glm::normalize(pose.forward);
  const bool orthographic = pose.orthoHeight > 0.0;
  const std::uint32_t direction = directionIndexOf<kSteps.direction>(
      orthographic || fromCenter == glm::dvec3(0.0) ? -forward : fromCenter);
  // The error bound as a length a unit of distance (an angle), or as a length.
  const double tanY = std::tan(static_cast<double>(pose.fovY) / 2.0);
  const double bound = orthographic ? pose.errorPx * pose.orthoHeight / pose.height / radius
                                    : pose.errorPx * 2.0 * tanY / pose.height;
  const std::uint32_t boundStep = logStep(bound, kSteps.angle);
  const std::uint32_t distanceStep = orthographic ? 0 : logStep(distance / radius, kSteps.distance);

  // The frustum as a cone, if the model sticks out of it. An orthographic cell takes all of it:
  // what is seen is the resting pose's own set.
  std::uint32_t coneStep = 0;
  std::uint32_t look = 0;
  if (!orthographic) {
    const double aspect = static_cast<double>(pose.width) / pose.height;
    const double narrow = std::atan(tanY * std::min(1.0, aspect));
    const double toCenter =
        std::acos(std::clamp(glm::dot(-fromCenter / distance, forward), -1.0, 1.0));
    const bool inside = distance <= radius;
    if (inside || toCenter + std::asin(radius / distance) > narrow) {
      look = directionIndexOf<kSteps.direction>(forward) + 1;
      // Two steps of slack: half a cell of looking, half a cell of standing, rounded up.
      const double wide = std::atan(tanY * std::hypot(1.0, aspect));
      coneStep = static_cast<std::uint32_t>(std::ceil(wide / kPi * kConeSteps)) + 1;
    }
  }
  ViewCell cell = direction;
  cell = cell << kLogBits | distanceStep;
  cell = cell << kLogBits | boundStep;
  cell = cell << kDirectionBits | look;
  cell = cell << kConeBits | coneStep;
  cell = cell << kOrthographicBits | (orthographic ? 1U : 0U);
  return cell << kSilhouetteBits | static_cast<std::uint32_t>(pose.silhouette);
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

  const double bound = pose.errorPx * 2.0 * tanY / pose.height;
  ViewCell cell =
      ViewCell{1} << kRestDirectionBits | directionIndexOf<kSteps.direction>(fromCenter);
  cell = cell << kLogBits | logStep(distance / radius, kSteps.distance);
  cell = cell << kLogBits | logStep(bound, kSteps.angle);
  cell = cell << (kRestGap + kSilhouetteBits);
  return cell | static_cast<std::uint32_t>(pose.silhouette);
}

bool endsPiece(ViewCell cell) {
  // Of neighbours one has an odd sum of steps: in the directions to stand and to look, and
  // distance.
  constexpr int kLook = kSilhouetteBits + kOrthographicBits + kConeBits;
  constexpr int kDistance = kLook + kDirectionBits + kLogBits;
  constexpr int kDirection = kDistance + kLogBits;
  static_assert(kMotionSteps.direction == 16);
  const auto bit = [cell](int place) { return cell >> place & 1; };
  return (bit(kLook) ^ bit(kLook + 4) ^ bit(kDistance) ^ bit(kDirection) ^ bit(kDirection + 4)) ==
         0;
}

View viewOfCell(ViewCell cell, const protocol::ModelInfo& model) {
  Fields fields(cell);
  if ((cell >> kRestBit & 1) != 0) return viewOfRestCell(fields, model);
  constexpr CellSteps kSteps = kMotionSteps;
  View view;
  view.silhouette = static_cast<protocol::Silhouette>(fields.take(kSilhouetteBits));
  view.orthographic = fields.take(kOrthographicBits) != 0;
  const std::uint32_t coneStep = fields.take(kConeBits);
  const std::uint32_t look = fields.take(kDirectionBits);
  const std::uint32_t boundStep = fields.take(kLogBits);
  const std::uint32_t distanceStep = fields.take(kLogBits);
  const glm::dvec3 direction = directionOf(fields.take(kDirectionBits), kSteps.direction);
  const double gridRadius = std::max(model.radius, model.gridStep) / model.gridStep;
  const double bound = octaves(boundStep, kSteps.angle);
  const double distance =
      view.orthographic ? kOrthographicDistance : octaves(distanceStep + 0.5, kSteps.distance);
  view.errorPx = 1.0;
  view.pixelsPerUnit = 1.0 / (view.orthographic ? bound * gridRadius : bound);
  view.eye = centerOnGrid(model) + direction * distance * gridRadius;
  view.forward = -direction;
  if (look != 0) {
    view.clip = View::Clip::kCone;
    view.forward = directionOf(look - 1, kSteps.direction);
    view.coneHalfAngle = std::min(coneStep / kConeSteps, 1.0) * kPi;
  }
  return view;
}

}  // namespace limn
