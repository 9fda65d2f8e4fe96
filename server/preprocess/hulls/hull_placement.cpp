// SPDX-License-Identifier: Apache-2.0
// Based on: P. Sander, X. Gu, S. Gortler, H. Hoppe, J. Snyder, "Silhouette Clipping", SIGGRAPH
// 2000, section 3.
#include "server/preprocess/hulls/hull_placement.h"

#include "server/preprocess/hulls/hull_predicates.h"

#include "shared/progressive/progressive_hull.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace limn {
namespace {

/// How far a regularised linear program reaches (LinearGoal), in sizes of the neighbourhood: flat
/// parts slide by less than they gain, and nothing else is affected.
constexpr double kReach = 1e5;
/// Coordinates whose differences stay below this make triple products that fit 64 bits.
constexpr std::int64_t kSmall = 1 << 19;

bool inRange(const glm::dvec3& p) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(std::abs(p[axis]) < kMaxHullCoordinate - 1)) return false;
  }
  return true;
}

std::int64_t largest(const glm::i64vec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// normal · (p − point), exact.
Int128 height(const glm::i64vec3& normal, const glm::ivec3& point, const glm::ivec3& p) {
  const glm::i64vec3 d = glm::i64vec3(p) - glm::i64vec3(point);
  // The common case without wide multiplications.
  if (largest(d) < kSmall && largest(normal) < 2 * kSmall * kSmall)
    return normal.x * d.x + normal.y * d.y + normal.z * d.z;
  return dotExact(normal, d);
}

}  // namespace

void HullPlacement::gather(const HullMesh& mesh, HalfEdgeId h) {
  const HalfEdgeMesh& links = mesh.links();
  const std::uint32_t a = links.origin(h);
  const std::uint32_t b = links.target(h);
  mesh.facesAround(h, around_);
  center_ = 0.5 * (glm::dvec3(mesh.positions()[a]) + glm::dvec3(mesh.positions()[b]));
  faces_.clear();
  double reach2 = 0.0;
  for (const FaceId f : around_) {
    Face& face = faces_.emplace_back();
    const glm::ivec3 corners[3] = {mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = links.origins[3 * f + k];
      if (v == a || v == b) {
        face.second = corners[(k + 1) % 3];
        face.third = corners[(k + 2) % 3];
      }
      const glm::dvec3 d = glm::dvec3(corners[k]) - center_;
      reach2 = std::max(reach2, glm::dot(d, d));
    }
    face.point = corners[0];
    face.normal = hull::areaNormal(corners[0], corners[1], corners[2]);
    face.length = glm::length(glm::dvec3(face.normal));
  }
  scale_ = std::sqrt(reach2);
}

std::optional<glm::dvec3> HullPlacement::solve(double margin) {
  constraints_.clear();
  glm::dvec3 gradient(0.0);
  double area = 0.0;
  for (const Face& face : faces_) {
    if (face.length <= 0.0) continue;
    const glm::dvec3 normal = glm::dvec3(face.normal) / face.length;
    // Rounding to the grid moves a point by half a step an axis.
    const double half = 0.5 * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
    const double offset = glm::dot(normal, glm::dvec3(face.point) - center_) + margin * half;
    constraints_.push_back({normal, offset / scale_});
    gradient += glm::dvec3(face.normal);
    area += face.length;
  }
  if (constraints_.empty()) return center_;
  const auto found = solveLinearProgram(constraints_, {gradient / area, kReach}, order_);
  if (!found) return std::nullopt;
  const glm::dvec3 p = center_ + scale_ * *found;
  return inRange(p) ? std::optional(p) : std::nullopt;
}

void HullPlacement::addCandidate(const glm::ivec3& p) {
  Int128 sum = 0;
  for (const Face& face : faces_) {
    const Int128 volume = height(face.normal, face.point, p);
    if (volume < 0) return;
    sum += volume;
  }
  candidates_.push_back({p, static_cast<double>(sum)});
}

bool HullPlacement::turnsTooFar(const glm::ivec3& p, double minNormalDot) const {
  for (std::size_t i = 2; i < faces_.size(); ++i) {
    const Face& face = faces_[i];
    if (face.length <= 0.0) continue;
    const glm::dvec3 turned(hull::areaNormal(p, face.second, face.third));
    const double length = glm::length(turned);
    if (length <= 0.0 ||
        glm::dot(turned, glm::dvec3(face.normal)) < minNormalDot * length * face.length) {
      return true;
    }
  }
  return false;
}

std::optional<HullPlacement::Place>
HullPlacement::place(const HullMesh& mesh, HalfEdgeId h, const PlacementRules& rules) {
  if (!mesh.canCollapse(h)) return std::nullopt;
  gather(mesh, h);
  // Faces around the edge less two are the neighbours of both ends, the ends aside.
  if (faces_.size() - 2 > rules.maxValence) return std::nullopt;
  const auto best = solve(0.0);
  if (!best) return std::nullopt;
  candidates_.clear();
  const glm::ivec3 floor(glm::floor(*best));
  for (int i = 0; i < 8; ++i)
    addCandidate(floor + glm::ivec3(i & 1, i >> 1 & 1, i >> 2 & 1));
  // On flat faces staying where a vertex is costs nothing, while the grid around the optimum need
  // not meet their plane.
  addCandidate(mesh.positions()[mesh.links().origin(h)]);
  addCandidate(mesh.positions()[mesh.links().target(h)]);
  if (candidates_.empty()) {
    if (const auto inside = solve(1.0)) addCandidate(glm::ivec3(glm::round(*inside)));
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Place& x, const Place& y) {
    return x.volume6 < y.volume6;
  });
  for (const Place& candidate : candidates_) {
    if (!turnsTooFar(candidate.position, rules.minNormalDot)) return candidate;
  }
  return std::nullopt;
}

}  // namespace limn
