// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/mesh/vertex_attributes.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cstdint>
#include <span>

namespace limn {

/// What an edge is, besides a possible silhouette. Bits, one byte a half-edge, equal on twins.
/// Borders are topological (no twin) and have no bit.
enum EdgeFeature : std::uint8_t {
  kFeatureCrease = 1,  // dihedral angle above the model's threshold
  kFeatureSeam = 2,    // attribute discontinuity
};

/// Where a split cuts its parent's canonical ring: the fan from ring[left] counter-clockwise to
/// ring[right] goes to the new vertex. kNoCut: the fan runs to the border on that side.
struct RingCut {
  static constexpr std::uint8_t kNoCut = 255;
  std::uint8_t left = kNoCut;
  std::uint8_t right = kNoCut;
  friend bool operator==(const RingCut&, const RingCut&) = default;
};

/// One vertex split, the inverse of an edge collapse [Hoppe96], by permanent ids.
struct VertexSplit {
  VertexId vertex = kNone;    // brought in
  VertexId parent = kNone;    // u: the vertex it was collapsed into
  VertexId left = kNone;      // l: start of the fan, kNone on a border
  VertexId right = kNone;     // r: end of the fan, kNone on a border
  glm::ivec3 position{0};     // of `vertex`, on the grid
  glm::ivec3 parentMove{0};   // added to the parent's position; zero: it keeps its place
  std::uint8_t features = 0;  // SplitFeature: which edges are creases
  std::uint8_t seams = 0;     // SplitFeature: which edges are seams
  VertexAttributes attributes{};
};

/// Which edges around a new vertex v are creases, or seams (one bit an edge of the two new faces):
/// u–v, u–l, v–l, u–r, v–r. The fan's other edges keep what they are.
enum SplitFeature : std::uint8_t {
  kSplitEdgeUV = 1,
  kSplitEdgeUL = 2,
  kSplitEdgeVL = 4,
  kSplitEdgeUR = 8,
  kSplitEdgeVR = 16,
  kSplitParentOnBorder = 32,  // the canonical ring is a path; known to a decoder, never coded
};

/// Where the survivor of a collapse stands (--placement).
enum class Placement : std::uint8_t {
  kSubset = 0,  // where it stood
  kVolume = 1,  // where the volume stays the same and the cost is least: splits move their parents
};

/// Level of vertex v, given the first vertex of each level and, last, the number of vertices.
[[nodiscard]] inline std::uint32_t levelOf(std::span<const std::uint32_t> levelBegin, VertexId v) {
  const auto above = std::upper_bound(levelBegin.begin(), levelBegin.end(), v);
  return static_cast<std::uint32_t>(above - levelBegin.begin()) - 1;
}

}  // namespace limn
