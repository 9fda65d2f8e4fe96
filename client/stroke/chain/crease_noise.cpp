// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain/crease_noise.h"

#include "client/stroke/chain/crack_places.h"

#include "shared/core/disjoint_sets.h"
#include "shared/progressive/vertex_split.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

/// Connected creases shorter together than this share of the mesh's extent are noise.
constexpr double kShortest = 0.02;
/// From this length on they are none, whatever is beside them.
constexpr double kLongest = 0.25;
/// How far around a crease its sides are looked at, as a share of the extent.
constexpr double kReach = 0.02;
/// Sides that face within this angle of one another, there, are one surface (its cosine: 24°).
constexpr double kSameSide = 0.9135;
/// Creases of a connected piece that are looked at, and faces on each of their sides.
constexpr std::size_t kMostEdges = 8;
constexpr std::size_t kMostFaces = 512;

/// Sorts the creases of one mesh.
class NoiseFinder {
 public:
  NoiseFinder(
      const HalfEdgeMesh& mesh,
      std::span<const glm::ivec3> positions,
      std::span<const std::uint8_t> features,
      std::span<const Crack> cracks)
      : mesh_(mesh),
        positions_(positions),
        connected_(mesh.vertexCount()),
        isCrease_(features.size(), 0),
        seen_(mesh.faceCount(), 0) {
    glm::ivec3 low = positions[0];
    glm::ivec3 high = low;
    for (const glm::ivec3& p : positions) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    extent_ = glm::distance(glm::dvec3(low), glm::dvec3(high));
    CrackPlaces places(mesh, positions);
    for (HalfEdgeId h = 0; h < features.size(); ++h) {
      const HalfEdgeId twin = mesh.twins[h];
      if (twin == kNone) {
        if (cracks.empty() || cracks[h] != Crack::kCrease) continue;
        edges_.push_back(h);
      } else {
        if (((features[h] | features[twin]) & kFeatureCrease) == 0) continue;
        isCrease_[h] = 1;
        if (h < twin) edges_.push_back(h);
      }
      connected_.join(mesh.origin(h), mesh.target(h));
      if (cracks.empty()) continue;
      for (const std::uint32_t v : {mesh.origin(h), mesh.target(h)})
        connected_.join(v, places.placeOf(v));
    }
  }

  /// Takes the mark of a crease from noise.
  void clear(std::vector<std::uint8_t>& features) {
    std::vector<std::uint8_t> ends(mesh_.vertexCount(), 0);  // creases at a vertex, up to 2
    for (const HalfEdgeId h : edges_) {
      for (const std::uint32_t v : {mesh_.origin(h), mesh_.target(h)})
        ends[v] = static_cast<std::uint8_t>(std::min(ends[v] + 1, 2));
    }
    // Connected creases one after another.
    std::stable_sort(edges_.begin(), edges_.end(), [this](HalfEdgeId a, HalfEdgeId b) {
      return connected_.rootOf(mesh_.origin(a)) < connected_.rootOf(mesh_.origin(b));
    });
    for (std::size_t first = 0; first < edges_.size();) {
      const std::uint32_t root = connected_.rootOf(mesh_.origin(edges_[first]));
      std::size_t past = first;
      double length = 0.0;
      bool hasLooseEnds = false;
      for (; past < edges_.size() && connected_.rootOf(mesh_.origin(edges_[past])) == root;
           ++past) {
        const HalfEdgeId h = edges_[past];
        length += glm::distance(place(mesh_.origin(h)), place(mesh_.target(h)));
        hasLooseEnds = hasLooseEnds || isLoose(ends, h);
      }
      const std::span<const HalfEdgeId> piece(&edges_[first], past - first);
      first = past;
      if (length >= kLongest * extent_) continue;
      if (length >= kShortest * extent_ && (!hasLooseEnds || divides(piece))) continue;
      for (const HalfEdgeId h : piece) {
        if (mesh_.twins[h] == kNone) continue;
        for (const HalfEdgeId side : {h, mesh_.twins[h]})
          features[side] = static_cast<std::uint8_t>(features[side] & ~kFeatureCrease);
      }
    }
  }

 private:
  [[nodiscard]] glm::dvec3 place(std::uint32_t v) const { return glm::dvec3(positions_[v]); }

  [[nodiscard]] bool isLoose(std::span<const std::uint8_t> ends, HalfEdgeId h) const {
    const auto isEnd = [&](std::uint32_t v) { return ends[v] == 1 && !mesh_.isBorderVertex(v); };
    return isEnd(mesh_.origin(h)) || isEnd(mesh_.target(h));
  }

  /// Whether the sides of most of a piece face differently, each with what goes on from it.
  bool divides(std::span<const HalfEdgeId> piece) {
    const std::size_t step = (piece.size() + kMostEdges - 1) / kMostEdges;
    std::size_t asked = 0;
    std::size_t different = 0;
    for (std::size_t i = step / 2; i < piece.size(); i += step) {
      if (mesh_.twins[piece[i]] == kNone) continue;
      ++asked;
      if (glm::dot(side(piece[i]), side(mesh_.twins[piece[i]])) < kSameSide) ++different;
    }
    return 2 * different >= asked;
  }

  /// Where the surface faces on a half-edge's side: the mean over its face and those that are
  /// reached from it across no crease, within reach of the edge's middle. Around a loose end that
  /// is near it is the other side as well: so curved surfaces need no other measure than flat ones.
  glm::dvec3 side(HalfEdgeId h) {
    const glm::dvec3 middle = 0.5 * (place(mesh_.origin(h)) + place(mesh_.target(h)));
    const double reach = kReach * extent_;
    ++pass_;
    glm::dvec3 sum(0.0);
    queue_.assign(1, HalfEdgeMesh::face(h));
    seen_[queue_.front()] = pass_;
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      const FaceId face = queue_[i];
      const glm::dvec3 a = place(mesh_.origin(3 * face));
      sum +=
          glm::cross(place(mesh_.origin(3 * face + 1)) - a, place(mesh_.origin(3 * face + 2)) - a);
      for (HalfEdgeId k = 3 * face; k < 3 * face + 3 && queue_.size() < kMostFaces; ++k) {
        const HalfEdgeId twin = mesh_.twins[k];
        if (twin == kNone || isCrease_[k] != 0) continue;
        const FaceId next = HalfEdgeMesh::face(twin);
        if (seen_[next] == pass_) continue;
        const std::uint32_t tip = mesh_.target(HalfEdgeMesh::next(twin));
        if (glm::distance(place(tip), middle) > reach) continue;
        seen_[next] = pass_;
        queue_.push_back(next);
      }
    }
    const double size = glm::length(sum);
    return size > 0.0 ? sum / size : glm::dvec3(0.0);
  }

  const HalfEdgeMesh& mesh_;
  std::span<const glm::ivec3> positions_;
  DisjointSets connected_;              // vertices joined by creases
  std::vector<std::uint8_t> isCrease_;  // by half-edge
  std::vector<HalfEdgeId> edges_;       // one of each crease's half-edges; cracks that are creases
  double extent_ = 0.0;
  std::vector<std::uint32_t> seen_;  // by face: the pass that has met it
  std::uint32_t pass_ = 0;
  std::vector<FaceId> queue_;
};

}  // namespace

std::vector<std::uint8_t> withoutNoise(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    std::span<const std::uint8_t> features,
    std::span<const Crack> cracks) {
  std::vector<std::uint8_t> kept(features.begin(), features.end());
  if (features.size() == mesh.origins.size() && !positions.empty())
    NoiseFinder(mesh, positions, features, cracks).clear(kept);
  return kept;
}

}  // namespace limn
