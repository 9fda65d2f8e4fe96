// SPDX-License-Identifier: Apache-2.0
#include "tests/corpus/torus_knots.h"

#include "shared/core/rng.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace limn::corpus {
namespace {

constexpr double kTube = 0.35;

glm::dvec3 curve(double t) {
  const double r = 2.0 + std::cos(3.0 * t);
  return {r * std::cos(2.0 * t), r * std::sin(2.0 * t), std::sin(3.0 * t)};
}

}  // namespace

TriangleMesh torusKnot(const KnotOptions& options) {
  Rng rng(options.seed);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < options.segments; ++i) {
    const double t = 2.0 * std::numbers::pi * i / options.segments;
    const glm::dvec3 center = curve(t);
    const glm::dvec3 tangent = glm::normalize(curve(t + 1e-4) - curve(t - 1e-4));
    const glm::dvec3 side = glm::normalize(glm::cross(tangent, center));
    const glm::dvec3 out = glm::cross(side, tangent);
    for (int j = 0; j < options.sides; ++j) {
      const double a = 2.0 * std::numbers::pi * j / options.sides;
      const double radius = kTube * (1.0 + options.roughness * (2.0 * rng.uniform() - 1.0));
      points.push_back(center + radius * (std::cos(a) * out - std::sin(a) * side));
    }
  }
  TriangleMesh mesh;
  glm::dvec3 low = points[0];
  glm::dvec3 high = points[0];
  for (const glm::dvec3& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec3 extent = high - low;
  mesh.grid.origin = low;
  mesh.grid.bits = options.gridBits;
  mesh.grid.step = std::max({extent.x, extent.y, extent.z}) / ((1 << options.gridBits) - 1);
  for (const glm::dvec3& p : points)
    mesh.positions.emplace_back(glm::round(mesh.grid.fromModel(p)));
  const auto at = [&](int i, int j) {
    return static_cast<std::uint32_t>((i % options.segments) * options.sides + j % options.sides);
  };
  for (int i = 0; i < options.segments; ++i) {
    for (int j = 0; j < options.sides; ++j) {
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return mesh;
}

}  // namespace limn::corpus
