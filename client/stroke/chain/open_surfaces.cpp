// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain/open_surfaces.h"

#include <algorithm>
#include <utility>

namespace limn {
namespace {

/// Faces on either side of a crack, each pair both ways round, sorted.
std::vector<std::pair<FaceId, FaceId>> pairsAcross(const Cracks& cracks) {
  std::vector<std::pair<FaceId, FaceId>> pairs;
  const auto add = [&](FaceId a, FaceId b) {
    pairs.emplace_back(a, b);
    pairs.emplace_back(b, a);
  };
  for (const CrackPart& part : cracks.parts)
    add(HalfEdgeMesh::face(part.here), HalfEdgeMesh::face(part.there));
  for (HalfEdgeId h = 0; h < cracks.across.size(); ++h) {
    if (cracks.across[h] != kNone) add(HalfEdgeMesh::face(h), cracks.across[h]);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

OpenSurfaces::OpenSurfaces(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    const Cracks& cracks) {
  if (std::find(mesh.twins.begin(), mesh.twins.end(), HalfEdgeId{kNone}) == mesh.twins.end())
    return;
  partOf_.assign(mesh.faceCount(), kNone);
  const std::vector<std::pair<FaceId, FaceId>> pairs = pairsAcross(cracks);
  std::vector<FaceId> waiting;
  const auto reach = [&](FaceId face) {
    if (partOf_[face] != kNone) return;
    partOf_[face] = static_cast<std::uint32_t>(parts_.size() - 1);
    waiting.push_back(face);
  };
  for (HalfEdgeId border = 0; border < mesh.twins.size(); ++border) {
    if (mesh.twin(border) != kNone) continue;
    if (partOf_[HalfEdgeMesh::face(border)] != kNone) continue;
    parts_.emplace_back();
    Part& part = parts_.back();
    reach(HalfEdgeMesh::face(border));
    while (!waiting.empty()) {
      const FaceId face = waiting.back();
      waiting.pop_back();
      const glm::dvec3 a(positions[mesh.origin(3 * face)]);
      const glm::dvec3 b(positions[mesh.origin(3 * face + 1)]);
      const glm::dvec3 c(positions[mesh.origin(3 * face + 2)]);
      const glm::dvec3 normal = 0.5 * glm::cross(b - a, c - a);
      const double area = glm::length(normal);
      part.vectorArea += normal;
      part.area += area;
      part.centre += area / 3.0 * (a + b + c);
      for (HalfEdgeId h = 3 * face; h < 3 * face + 3; ++h) {
        if (mesh.twin(h) != kNone) reach(HalfEdgeMesh::face(mesh.twin(h)));
      }
      const auto across = std::lower_bound(pairs.begin(), pairs.end(), std::pair(face, FaceId{0}));
      for (auto pair = across; pair != pairs.end() && pair->first == face; ++pair)
        reach(pair->second);
    }
    if (part.area > 0.0) part.centre /= part.area;
  }
}

PolylineSet::Back OpenSurfaces::backOf(FaceId face, const SilhouetteView& view) const {
  if (face >= partOf_.size() || partOf_[face] == kNone) return PolylineSet::Back::kNeverSeen;
  const Part& part = parts_[partOf_[face]];
  const glm::dvec3 towardEye = view.orthographic ? -view.forward : view.eye - part.centre;
  const double least = kLeastShare * part.area * glm::length(towardEye);
  return glm::dot(part.vectorArea, towardEye) < -least ? PolylineSet::Back::kSeen
                                                       : PolylineSet::Back::kMayBeSeen;
}

void OpenSurfaces::markBacks(const SilhouetteView& view, PolylineSet& lines) const {
  if (parts_.empty()) return;
  for (PolylineSet::Line& line : lines.lines) {
    for (std::uint32_t point = line.begin; point < line.begin + line.segmentCount(); ++point)
      line.back = std::max(line.back, backOf(lines.faces[point], view));
  }
}

}  // namespace limn
