// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/line_scene.h"

#include "shared/ray/triangle_bvh.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Which parts of lines are visible, exact to the mesh and free of any picture's resolution.
struct ResolvedLines {
  /// A part of a segment, all visible or all hidden: from where the one before ends (0: the
  /// segment's start) to `end` (1: its end; affine in space).
  struct Piece {
    float end = 1.0F;
    bool visible = false;
  };

  std::vector<Piece> pieces;
  std::vector<std::uint32_t> begin;  // by point of the PolylineSet, and one past the last
  std::uint32_t rays = 0;            // cast

  /// The pieces of the segment that starts at a point; none for an open line's last.
  [[nodiscard]] std::span<const Piece> piecesOf(std::uint32_t point) const {
    return std::span(pieces).subspan(begin[point], begin[point + 1] - begin[point]);
  }
};

/// Resolves the visibility of lines on one mesh from any view, without a GPU: segments are cut
/// where they pass behind a contour or border edge in the picture and where they pierce a face
/// (nowhere else can a segment's visibility change: its ends, the vertices, are cuts already), and
/// for each piece one ray decides, from its middle to the eye.
///
/// Polygonal lines are exact: rays pass the edge's own two faces, and a concave silhouette edge is
/// hidden by them. A smooth silhouette lies a little beside the mesh's own outline, so its rays
/// start just outside and pass the faces around; where the surface bends towards the eye it hides
/// the line by itself. Where no nearer line is beside it, it is the outline of all that stands out
/// a little farther, too.
///
/// Refers to mesh and positions, which must outlive it unchanged. Threads: reentrant.
class VisibilityResolver {
 public:
  /// Cost: O(faces), some 0.1 µs each.
  VisibilityResolver(const HalfEdgeMesh& mesh, std::span<const glm::ivec3> positions);

  /// lines: on the resolver's mesh, which is also the scene's. isDrawn: one entry a point, or empty
  /// (all): the segments that are drawn, and so may be another smooth silhouette's outline
  /// (LineSpans::isNearest). Cost: O(faces + segments + crossings) and a ray a piece, about a
  /// microsecond each.
  [[nodiscard]] ResolvedLines resolve(
      const PolylineSet& lines,
      const LineScene& scene,
      std::span<const std::uint8_t> isDrawn = {}) const;

 private:
  TriangleBvh bvh_;
  bool isClosed_ = true;
};

/// Per-segment visibility as linesJson() wants it: one entry a point, 1 if the middle of the
/// segment that starts there is visible and in the picture.
[[nodiscard]] std::vector<std::uint8_t>
segmentVisibility(const PolylineSet& lines, const ResolvedLines& resolved, const LineScene& scene);

}  // namespace limn
