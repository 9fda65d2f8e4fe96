// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/line_scene.h"
#include "client/stroke/scene_faces.h"
#include "client/stroke/visibility/own_surface.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// What of the surface around an outline lies before a place beside it: a ray from the place to the
/// eye, tried against the faces there and no others. Where it meets one the place is hidden, as a
/// ray through the whole mesh would have it; where it meets none nothing is said. One camera.
/// Threads: one caller at a time.
class CoverSearch {
 public:
  explicit CoverSearch(const LineScene& scene);

  /// What a place lies on, which does not cover it.
  enum class Own : std::uint8_t {
    kFace,    // the face, and the one across `edge` if there is an edge
    kAround,  // those that share a corner with the face, and OwnSurface
  };

  struct Place {
    glm::dvec3 at{0.0};  // grid units
    FaceId face = kNone;
    FaceId other = kNone;  // kFace: the second one, or kNone
    Own own = Own::kFace;
    glm::dvec3 out{0.0};  // kAround: unit vector away from its surface, across the view
  };

  /// Tries the faces of `start`, and those up to kRings edges from them. Cost: O(faces tried), some
  /// ten a face of `start`.
  [[nodiscard]] bool covers(std::span<const FaceId> start, const Place& place);

  /// A place of a smooth silhouette on a face moved to where its mesh's outline is: away from the
  /// surface, across the line and the view, as far as the face's corners stand out. Where the line
  /// (along) runs along the view, the place itself.
  [[nodiscard]] Place outside(FaceId face, const glm::dvec3& along, const glm::dvec3& place) const;

  /// How much of the way from the vertex that half-edge `out` leaves to a place `to`, along the
  /// edge between the faces own and ownOther, the other faces around that vertex cover: a share of
  /// it, in space, from the vertex on. Exact. Cost: O(valence).
  [[nodiscard]] double
  coveredShare(HalfEdgeId out, const glm::dvec3& to, FaceId own, FaceId ownOther) const;

  using Corners = std::array<glm::ivec3, 3>;  // of a face, on the grid

  /// Edges between a face of `start` and the farthest that is tried: the outline of a smooth
  /// silhouette's surface is one or two faces away from it.
  static constexpr std::size_t kRings = 2;

 private:
  [[nodiscard]] double coveredBy(HalfEdgeId corner, const glm::dvec3& apex, const glm::dvec3& along)
      const;

  void begin(std::span<const FaceId> start);
  void addRing();
  [[nodiscard]] bool isOwn(FaceId face, const Place& place) const;
  [[nodiscard]] bool isCoveredAside(const Place& place) const;

  LineScene scene_;
  SceneFaces sceneFaces_;
  OwnSurface ownSurface_;
  // Of the last start: the faces so far, ring by ring, and where their corners are.
  std::vector<FaceId> start_;
  std::vector<FaceId> faces_;
  std::vector<Corners> corners_;
  std::array<std::size_t, kRings + 1> ringEnd_{};
  std::size_t rings_ = 0;
};

}  // namespace limn
