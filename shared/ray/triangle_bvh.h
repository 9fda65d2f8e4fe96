// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace limn {

/// The points origin + t · direction with begin < t < end, in grid units. `direction` is of any
/// length above 0.
struct Ray {
  glm::dvec3 origin{0.0};
  glm::dvec3 direction{0.0, 0.0, 1.0};
  double begin = 0.0;
  double end = std::numeric_limits<double>::infinity();
};

struct RayHit {
  FaceId face = kNone;
  double t = 0.0;
  bool front = false;  // the ray comes from the side that the face's normal points to
};

struct NearestPoint {
  FaceId face = kNone;
  glm::dvec3 point{0.0};
};

/// Rays against the triangles of a mesh on a grid. Two-sided. Nothing slips through between two
/// triangles that share an edge: a ray that meets the edge itself hits both. Triangles without area
/// and triangles that contain the ray's line are never hit.
///
/// A packed tree: triangles in the order of a Hilbert curve, four a leaf, eight children a node,
/// every level full, so that nothing but boxes is stored. Immutable; safe to use from any thread.
/// About 50 bytes a face.
class TriangleBvh {
 public:
  TriangleBvh() = default;

  /// positions: within kMaxGridCoordinate, so that floats hold them exactly; triangles: their
  /// corners' indices. Faces are named by their index. Cost: O(faces), some 0.1 µs each.
  TriangleBvh(std::span<const glm::ivec3> positions, std::span<const glm::uvec3> triangles);

  /// Whether the ray meets any face that is not in `except`. Cost: about O(log faces); the quickest
  /// of the three.
  [[nodiscard]] bool isBlocked(const Ray& ray, std::span<const FaceId> except = {}) const {
    return findBlocker(ray, except, kNone) != kNone;
  }

  /// The same for rays that come one beside another: what is in the way, to be handed to the next
  /// ray as its guess, which is tried first; kNone when nothing is. Says nothing about which face.
  [[nodiscard]] std::uint32_t
  findBlocker(const Ray& ray, std::span<const FaceId> except, std::uint32_t guess) const;

  /// The face met first that is not in `except`; of two at one t, the one with the lower index.
  [[nodiscard]] std::optional<RayHit> firstHit(const Ray& ray, std::span<const FaceId> except = {})
      const;

  /// Every face met, in no particular order.
  [[nodiscard]] std::vector<RayHit> allHits(const Ray& ray) const;

  /// The point of the mesh nearest to `point`; of several faces at one distance any. nullopt: no
  /// faces. Cost: about O(log faces) near the mesh.
  [[nodiscard]] std::optional<NearestPoint> closest(const glm::dvec3& point) const;

  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  static constexpr std::uint32_t kLeafFaces = 4;
  static constexpr std::uint32_t kWidth = 8;

  struct Triangle {
    std::array<glm::vec3, 3> corners;
    FaceId face;
  };

  struct Node {  // boxes of the children; [axis][child]
    float low[3][kWidth];
    float high[3][kWidth];
  };

  void sortFaces(std::span<const glm::ivec3> positions, std::span<const glm::uvec3> triangles);
  void buildLevels(float padding);
  /// Where on the ray (t) the sphere around the mesh begins, not before its begin.
  [[nodiscard]] double approach(const Ray& ray) const;
  template <class OnHit>
  void traverse(const Ray& ray, OnHit onHit) const;

  glm::dvec3 center_{0.0};
  double reach_ = 0.0;                     // radius of a sphere around center_
  std::vector<Triangle> triangles_;        // along the curve
  std::vector<Node> nodes_;                // level by level, leaves' parents first
  std::vector<std::uint32_t> levelBegin_;  // by level: its first node in nodes_
};

}  // namespace limn
