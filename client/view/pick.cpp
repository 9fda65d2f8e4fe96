// SPDX-License-Identifier: Apache-2.0
#include "client/view/pick.h"

#include <limits>

namespace limn {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Where along the ray a triangle is met (Möller and Trumbore 1997), infinity where it is not.
double meet(const PixelRay& ray, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a;
  const glm::dvec3 ac = c - a;
  const glm::dvec3 p = glm::cross(ray.direction, ac);
  const double determinant = glm::dot(ab, p);
  if (determinant == 0.0) return kNever;
  const glm::dvec3 s = ray.origin - a;
  const double u = glm::dot(s, p) / determinant;
  if (u < 0.0 || u > 1.0) return kNever;
  const glm::dvec3 q = glm::cross(s, ab);
  const double v = glm::dot(ray.direction, q) / determinant;
  if (v < 0.0 || u + v > 1.0) return kNever;
  const double t = glm::dot(ac, q) / determinant;
  return t > 0.0 ? t : kNever;
}

}  // namespace

std::optional<glm::dvec3> pick(const MeshSnapshot& snapshot, const PixelRay& ray) {
  const HalfEdgeMesh& mesh = snapshot.mesh.mesh();
  const std::span<const glm::ivec3> positions = snapshot.mesh.positions();
  const Grid& grid = snapshot.model.grid;
  // On the grid: one ray is converted instead of every corner.
  const PixelRay onGrid{
      grid.fromModel(ray.origin),
      grid.fromModel(ray.origin + ray.direction) - grid.fromModel(ray.origin)};
  double nearest = kNever;
  for (std::size_t h = 0; h + 2 < mesh.origins.size(); h += 3) {
    const double t = meet(
        onGrid,
        positions[mesh.origins[h]],
        positions[mesh.origins[h + 1]],
        positions[mesh.origins[h + 2]]);
    if (t < nearest) nearest = t;
  }
  if (nearest == kNever) return std::nullopt;
  return ray.origin + nearest * ray.direction;
}

}  // namespace limn
