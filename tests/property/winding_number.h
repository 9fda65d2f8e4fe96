// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/triangle_mesh.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

namespace limn {

/// Exact winding numbers of a closed mesh at points of its grid: the crossings of an upward ray are
/// counted, every decision is made in integers. Positions: 22 bits and a sign.
class WindingNumber {
 public:
  explicit WindingNumber(const TriangleMesh& mesh) : mesh_(mesh) {
    low_ = glm::ivec2(INT32_MAX);
    glm::ivec2 high(INT32_MIN);
    for (const glm::ivec3& p : mesh.positions) {
      low_ = glm::min(low_, glm::ivec2(p));
      high = glm::max(high, glm::ivec2(p));
    }
    const std::int64_t side =
        std::max({std::int64_t{high.x} - low_.x, std::int64_t{high.y} - low_.y, std::int64_t{1}});
    cell_ = side / kCells + 1;
    cells_.resize(kCells * kCells);
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
      glm::ivec2 from(INT32_MAX);
      glm::ivec2 to(INT32_MIN);
      for (int k = 0; k < 3; ++k) {
        const glm::ivec2 p(mesh.positions[mesh.triangles[f][k]]);
        from = glm::min(from, p);
        to = glm::max(to, p);
      }
      for (std::int64_t y = cellOf(from.y, low_.y); y <= cellOf(to.y, low_.y); ++y) {
        for (std::int64_t x = cellOf(from.x, low_.x); x <= cellOf(to.x, low_.x); ++x)
          cells_[static_cast<std::size_t>(y * kCells + x)].push_back(f);
      }
    }
  }

  /// nullopt: on the surface.
  [[nodiscard]] std::optional<int> at(const glm::ivec3& p) const {
    const std::int64_t x = cellOf(p.x, low_.x);
    const std::int64_t y = cellOf(p.y, low_.y);
    if (p.x < low_.x || p.y < low_.y || x >= kCells || y >= kCells) return 0;
    int winding = 0;
    for (const std::uint32_t f : cells_[static_cast<std::size_t>(y * kCells + x)]) {
      const glm::uvec3& t = mesh_.triangles[f];
      const glm::ivec3* corners[3] = {
          &mesh_.positions[t.x],
          &mesh_.positions[t.y],
          &mesh_.positions[t.z]};
      // The ray stands at (x + ε, y + ε²), so that it never meets an edge: an edge that p lies on
      // counts for the side that the shifted point is on.
      int turns = 0;
      for (int k = 0; k < 3; ++k)
        turns += turn(*corners[k], *corners[(k + 1) % 3], p);
      const Wide side = volume(*corners[0], *corners[1], *corners[2], p);
      if (side == 0 && touches(corners, p)) return std::nullopt;
      if (turns != 3 && turns != -3) continue;
      // Counter-clockwise from above: the face looks up, and p is inside when it is below.
      if (turns == 3 && side < 0) ++winding;
      if (turns == -3 && side > 0) --winding;
    }
    return winding;
  }

 private:
  __extension__ using Wide = __int128;
  static constexpr std::int64_t kCells = 64;

  [[nodiscard]] std::int64_t cellOf(std::int32_t v, std::int32_t low) const {
    return (std::int64_t{v} - low) / cell_;
  }

  static Wide
  volume(const glm::ivec3& a, const glm::ivec3& b, const glm::ivec3& c, const glm::ivec3& p) {
    const glm::i64vec3 u = glm::i64vec3(b) - glm::i64vec3(a);
    const glm::i64vec3 v = glm::i64vec3(c) - glm::i64vec3(a);
    const glm::i64vec3 w = glm::i64vec3(p) - glm::i64vec3(a);
    return Wide{u.y * v.z - u.z * v.y} * w.x + Wide{u.z * v.x - u.x * v.z} * w.y +
           Wide{u.x * v.y - u.y * v.x} * w.z;
  }

  /// Which side of the line a → b, seen from above, the shifted p is on: 1 left, −1 right, 0 only
  /// when the line is a point.
  static int turn(const glm::ivec3& a, const glm::ivec3& b, const glm::ivec3& p) {
    const std::int64_t dx = std::int64_t{b.x} - a.x;
    const std::int64_t dy = std::int64_t{b.y} - a.y;
    const std::int64_t exact = dx * (std::int64_t{p.y} - a.y) - dy * (std::int64_t{p.x} - a.x);
    if (exact != 0) return exact > 0 ? 1 : -1;
    if (dy != 0) return dy < 0 ? 1 : -1;  // − dy · ε
    return dx > 0 ? 1 : dx < 0 ? -1 : 0;  // dx · ε²
  }

  /// p is on the plane of the triangle (or that has no area): whether it is in it.
  static bool touches(const glm::ivec3* const corners[3], const glm::ivec3& p) {
    for (int axis = 0; axis < 3; ++axis) {
      int least = 1;
      int most = -1;
      for (int k = 0; k < 3; ++k) {
        const glm::ivec3& a = *corners[k];
        const glm::ivec3& b = *corners[(k + 1) % 3];
        const int u = (axis + 1) % 3;
        const int v = (axis + 2) % 3;
        const std::int64_t side = (std::int64_t{b[u]} - a[u]) * (std::int64_t{p[v]} - a[v]) -
                                  (std::int64_t{b[v]} - a[v]) * (std::int64_t{p[u]} - a[u]);
        const int s = side > 0 ? 1 : side < 0 ? -1 : 0;
        least = std::min(least, s);
        most = std::max(most, s);
      }
      if (least < 0 && most > 0) return false;  // outside in this projection
    }
    // Within the slanted box of every projection; for a needle that is its line, so ends count.
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] =
          std::minmax({(*corners[0])[axis], (*corners[1])[axis], (*corners[2])[axis]});
      if (p[axis] < low || p[axis] > high) return false;
    }
    return true;
  }

  const TriangleMesh& mesh_;
  glm::ivec2 low_;
  std::int64_t cell_ = 1;
  std::vector<std::vector<std::uint32_t>> cells_;
};

}  // namespace limn
