// SPDX-License-Identifier: Apache-2.0
#include "shared/ray/self_intersections.h"

#include "shared/ray/triangle_bvh.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace limn {
namespace {

/// One end of the segment in which two faces cross: an edge of the one pierces the other.
struct Piercing {
  FaceId low = kNone;  // the two faces
  FaceId high = kNone;
  std::uint32_t node = 0;
  glm::vec3 point{0.0F};
};

class IntersectionSearch {
 public:
  IntersectionSearch(const HalfEdgeMesh& mesh, std::span<const glm::ivec3> positions)
      : mesh_(mesh),
        positions_(positions),
        bvh_(positions, mesh.triangles()) {}

  std::vector<SurfaceSegment> run() {
    for (HalfEdgeId h = 0; h < mesh_.origins.size(); ++h) {
      if (mesh_.twin(h) == kNone || h < mesh_.twin(h)) pierce(h);
    }
    // Stable: of many ends of one pair the first found come first, whatever the library.
    std::stable_sort(piercings_.begin(), piercings_.end(), [](const auto& a, const auto& b) {
      return std::pair(a.low, a.high) < std::pair(b.low, b.high);
    });
    std::vector<SurfaceSegment> segments;
    for (std::size_t i = 0; i < piercings_.size();) {
      std::size_t past = i + 1;
      while (past < piercings_.size() && piercings_[past].low == piercings_[i].low &&
             piercings_[past].high == piercings_[i].high)
        ++past;
      join(std::span(piercings_).subspan(i, past - i), segments);
      i = past;
    }
    return segments;
  }

 private:
  /// Edges that meet a face in its own corner touch it by being its neighbours (also where one
  /// place has two vertices).
  [[nodiscard]] bool sharesCorner(FaceId face, HalfEdgeId h) const {
    const glm::ivec3& from = positions_[mesh_.origin(h)];
    const glm::ivec3& to = positions_[mesh_.target(h)];
    for (HalfEdgeId k = 3 * face; k < 3 * face + 3; ++k) {
      const glm::ivec3& p = positions_[mesh_.origin(k)];
      if (p == from || p == to) return true;
    }
    return false;
  }

  void pierce(HalfEdgeId h) {
    const glm::dvec3 from(positions_[mesh_.origin(h)]);
    const glm::dvec3 along = glm::dvec3(positions_[mesh_.target(h)]) - from;
    if (along == glm::dvec3(0.0)) return;
    for (const RayHit& hit : bvh_.allHits({from, along, 0.0, 1.0})) {
      if (sharesCorner(hit.face, h)) continue;
      const glm::vec3 point(from + hit.t * along);
      const HalfEdgeId twin = mesh_.twin(h);
      add(HalfEdgeMesh::face(h), hit.face, point);
      if (twin != kNone) add(HalfEdgeMesh::face(twin), hit.face, point);
      ++nodes_;
    }
  }

  void add(FaceId a, FaceId b, const glm::vec3& point) {
    piercings_.push_back({std::min(a, b), std::max(a, b), nodes_, point});
  }

  /// The ends of one pair's segment: two, or more where an edge passes through an edge.
  static void join(std::span<const Piercing> ends, std::vector<SurfaceSegment>& segments) {
    std::size_t first = 0;
    std::size_t second = 0;
    float farthest = 0.0F;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      for (std::size_t j = i + 1; j < ends.size(); ++j) {
        const float apart = glm::distance(ends[i].point, ends[j].point);
        if (!(apart > farthest)) continue;
        farthest = apart;
        first = i;
        second = j;
      }
    }
    if (!(farthest > 0.0F)) return;
    segments.push_back(
        {ends[first].low,
         {{{ends[first].node, ends[first].point, 1.0F},
           {ends[second].node, ends[second].point, 1.0F}}}});
  }

  const HalfEdgeMesh& mesh_;
  std::span<const glm::ivec3> positions_;
  TriangleBvh bvh_;
  std::uint32_t nodes_ = 0;
  std::vector<Piercing> piercings_;
};

}  // namespace

std::vector<SurfaceSegment> findSelfIntersections(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions) {
  return IntersectionSearch(mesh, positions).run();
}

}  // namespace limn
