// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/field.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

/// What ConesDetector searches. Internal to shared/silhouette.
namespace limn::silhouette {

/// Planes of a leaf, and the most edges or faces that a leaf lists.
inline constexpr std::size_t kLeafSites = 32;
inline constexpr std::size_t kLeafEdges = 43;
inline constexpr std::size_t kLeafFaces = 48;

/// Planes are kept in 16 bits: value(eye) / (|n| |eye − c|) = n/|n| · u + (D / r) (r / |eye − c|),
/// with c the leaf's centre, u the unit vector from it to the eye, D the plane's value at c over
/// |n| and r the leaf's radius, at least |D|. Each of the two factors of each product is rounded to
/// 1 / kPlaneScale. The sum then differs from the real one by at most kPlaneError / kPlaneScale²
/// where the eye is at least 2 r away: rounding moves each product by half of either factor, and
/// the factors' absolute values add up to √3, √3, 1 and ½; the rest is for the rounding of u.
/// Where that leaves a side in doubt, the field's own plane decides.
inline constexpr float kPlaneScale = 32767.0F;
inline constexpr float kPlaneError = 2.6F * kPlaneScale;
/// The planes' share of it: √3 and ½ times half, and some more for the rest.
inline constexpr float kPlaneOwnError = 1.2F * kPlaneScale;
inline constexpr float kNearest = 0.5F;  // of r / |eye − c|

/// Edges (2 sites each) or faces (3 corners each) that lie together, with the planes they need,
/// each once. Fixed size, so that a test has no loop bounds to wait for.
template <std::size_t kSites, std::size_t kItems>
struct alignas(32) LeafOf {
  static constexpr std::size_t kSitesPerItem = kSites;
  static constexpr std::size_t kMaxItems = kItems;

  /// Local sites of item i: corner k's at [k][i], in the low five bits. An edge has its
  /// half-edge's face in [0], its twin's in [1], and above, which of the face's three it is.
  std::array<std::array<std::uint8_t, kItems>, kSites> sites;
  std::uint8_t siteCount;
  std::uint8_t itemCount;
  std::uint32_t itemBegin;  // its first item (ConeTree::faces)
  /// Planes as pairs (n.x, n.y) and (n.z, D / radius); local site i's at [2 · slotOf(i)]. Unused
  /// slots repeat one of the leaf's planes.
  alignas(32) std::array<std::int16_t, 2 * kLeafSites> xy, zd;

  /// Where the plane of local site i is: the order in which packing eight-lane comparisons to bytes
  /// leaves them.
  [[nodiscard]] static constexpr std::size_t slotOf(std::size_t i) {
    const std::size_t half = i / 16;
    return i % 16 / 4 * 8 + half * 4 + i % 4;
  }
};

using EdgeLeaf = LeafOf<2, kLeafEdges>;
using FaceLeaf = LeafOf<3, kLeafFaces>;
static_assert(sizeof(EdgeLeaf) == 352 && sizeof(FaceLeaf) == 416);

/// Anchored pyramids (shared/view) of eight children (leaves, or nodes of the level below), one
/// array a field: five cache lines.
struct alignas(64) Node {
  std::array<float, 8> centerX, centerY, centerZ;
  std::array<float, 8> front, back;
  std::array<std::array<std::int16_t, 8>, 3> axis, side1, side2;  // x, y, z
  /// Of leaves: bound of the planes' distance from the centre, the upper half of a float.
  std::array<std::uint16_t, 8> radius;

  [[nodiscard]] static float radiusFrom(std::uint16_t upperHalf) {
    return std::bit_cast<float>(std::uint32_t{upperHalf} << 16);
  }
};

static_assert(sizeof(Node) == 320);

/// The leaves in the order of their nodes, and the levels of nodes above them: child i of node n
/// is entry 8n + i of the level below; levels[0] is above the leaves. A leaf's centre is its
/// pyramids'.
struct ConeTree {
  // By kind, one of the two.
  std::vector<EdgeLeaf> edgeLeaves;
  std::vector<FaceLeaf> faceLeaves;
  std::vector<FaceId> siteFaces;  // kEdges: the face of site i of leaf l at [kLeafSites · l + i]
  std::vector<FaceId> faces;      // kSmooth: the face of each item
  std::vector<std::vector<Node>> levels;
  glm::ivec3 origin{0};  // grid units: cones and planes are about it (the field's centre then)
  float extent = 0.0F;   // bound of |d|/|n| over the planes and of cone centres
  std::size_t items = 0;

  [[nodiscard]] std::size_t leafCount() const { return edgeLeaves.size() + faceLeaves.size(); }

  /// Children of the nodes of a level.
  [[nodiscard]] std::size_t childrenOf(std::size_t level) const {
    return level == 0 ? leafCount() : levels[level - 1].size();
  }

  [[nodiscard]] std::size_t memoryBytes() const;
};

/// Clusters items of a field (ItemSource) and bounds the clusters. Cost: O(items log items).
[[nodiscard]] ConeTree
buildConeTree(const SilhouetteField& field, std::vector<std::uint32_t> items, double tangentScale);

}  // namespace limn::silhouette
