// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/line_scene.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cstdint>
#include <span>

namespace limn {

/// The faces of a scene's mesh as its camera sees them. Everything in grid units; nothing is
/// computed ahead, so that each answer costs O(1). Refers to the scene's mesh and positions.
/// Threads: reentrant.
class SceneFaces {
 public:
  explicit SceneFaces(const LineScene& scene)
      : mesh_(scene.mesh),
        positions_(scene.positions),
        isOrthographic_(scene.camera.orthographic),
        eye_(scene.grid.fromModel(scene.camera.eye)),
        toEyeAtInfinity_(-scene.camera.forward()) {}

  /// Where a half-edge starts.
  [[nodiscard]] glm::dvec3 corner(HalfEdgeId h) const {
    return glm::dvec3(positions_[mesh_.origin(h)]);
  }

  /// Twice the area long; exact.
  [[nodiscard]] glm::dvec3 normal(FaceId face) const {
    const glm::dvec3 a = corner(3 * face);
    return glm::cross(corner(3 * face + 1) - a, corner(3 * face + 2) - a);
  }

  /// From a place to the eye; orthographic: a unit vector towards it.
  [[nodiscard]] glm::dvec3 towardEye(const glm::dvec3& place) const {
    return isOrthographic_ ? toEyeAtInfinity_ : eye_ - place;
  }

  /// Not if it is seen edge on.
  [[nodiscard]] bool isFront(FaceId face) const {
    return glm::dot(normal(face), towardEye(corner(3 * face))) > 0.0;
  }

  /// Whether a smooth silhouette's surface covers it, from → to on a face: where the front side,
  /// which lines run with to their left (normal × along points there), lies farther away than the
  /// line, the surface bends towards the eye.
  [[nodiscard]] bool hidesSmooth(FaceId face, const glm::dvec3& from, const glm::dvec3& to) const {
    const glm::dvec3 left = glm::cross(normal(face), to - from);
    return glm::dot(left, towardEye(0.5 * (from + to))) < 0.0;
  }

  /// The same of the segment that starts at a point of a line; of edges that is not asked.
  [[nodiscard]] bool
  hidesSmooth(const PolylineSet& lines, const PolylineSet::Line& line, std::uint32_t point) const {
    if (lines.halfEdges[point] != kNone || lines.faces[point] == kNone) return false;
    const std::uint32_t next = point + 1 < line.end ? point + 1 : line.begin;
    return hidesSmooth(
        lines.faces[point],
        glm::dvec3(lines.points[point]),
        glm::dvec3(lines.points[next]));
  }

  /// At a place of a smooth silhouette on a face: the unit vector across the view and the line
  /// (along), away from the surface; the zero vector where the line runs along the view.
  [[nodiscard]] glm::dvec3 outward(FaceId face, const glm::dvec3& along, const glm::dvec3& place)
      const {
    const glm::dvec3 out = glm::cross(along, towardEye(place));
    const double length = glm::length(out);
    if (!(length > 0.0)) return glm::dvec3(0.0);
    return (glm::dot(out, normal(face)) < 0.0 ? -1.0 : 1.0) / length * out;
  }

  /// How far the corners of a face stand out beyond a place on it, along a unit vector: there, of a
  /// smooth silhouette and outward(), its mesh's own outline is.
  [[nodiscard]] double standOut(FaceId face, const glm::dvec3& place, const glm::dvec3& out) const {
    double height = 0.0;
    for (HalfEdgeId h = 3 * face; h < 3 * face + 3; ++h)
      height = std::max(height, glm::dot(corner(h) - place, out));
    return height;
  }

 private:
  const HalfEdgeMesh& mesh_;
  std::span<const glm::ivec3> positions_;
  bool isOrthographic_;
  glm::dvec3 eye_;
  glm::dvec3 toEyeAtInfinity_;
};

}  // namespace limn
