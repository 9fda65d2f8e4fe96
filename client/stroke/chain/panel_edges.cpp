// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain/panel_edges.h"

#include "shared/progressive/vertex_split.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

/// A panel is so many times as wide across the edge as the strip beside it.
constexpr double kLeastRatio = 3.0;
constexpr double kLeastTurn = 5.0 / 180.0 * std::numbers::pi;
/// The silhouette of a face as wide as w between normals that differ by an angle a lies up to w a/8
/// inside its outline (the height of an arc over its chord); less than this share of the radius is
/// nothing to look at.
constexpr double kLeastOffset = 0.001;

}  // namespace

std::vector<std::uint8_t> withPanelEdges(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    std::vector<std::uint8_t> features,
    double radius) {
  features.resize(mesh.origins.size(), 0);
  const double leastOffset = kLeastOffset * radius;
  // Of no face that is smaller can the offset be as large.
  const double leastWidth = 8.0 / std::numbers::pi * leastOffset;
  const auto at = [&](HalfEdgeId h) { return positions[mesh.origin(h)]; };
  for (HalfEdgeId panel = 0; panel < mesh.origins.size(); ++panel) {
    const HalfEdgeId strip = mesh.twin(panel);
    if (strip == kNone) continue;
    const glm::ivec3 from = at(panel);
    const glm::ivec3 apex = at(HalfEdgeMesh::prev(panel)) - from;
    if (std::max({std::abs(apex.x), std::abs(apex.y), std::abs(apex.z)}) * std::numbers::sqrt3 <
        leastWidth)
      continue;
    const glm::dvec3 along(at(strip) - from);
    const glm::dvec3 n = glm::cross(along, glm::dvec3(apex));
    const glm::dvec3 beyond(at(HalfEdgeMesh::prev(strip)) - from);
    const glm::dvec3 m = glm::cross(beyond, along);
    // A hollow's silhouette is not seen.
    if (glm::dot(n, beyond) > 0.0) continue;
    const double length = glm::length(along);
    const double width = glm::length(n) / length;
    const double stripWidth = glm::length(m) / length;
    if (!(stripWidth > 0.0) || width < kLeastRatio * stripWidth) continue;
    const double turn = std::atan2(glm::length(glm::cross(n, m)), glm::dot(n, m));
    if (turn < kLeastTurn || width * turn / 8.0 < leastOffset) continue;
    features[panel] |= kFeatureCrease;
  }
  return features;
}

}  // namespace limn
