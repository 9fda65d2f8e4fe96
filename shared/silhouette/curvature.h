// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

struct CurvatureOptions {
  /// Normals are smoothed first over a bell of this standard deviation, as a share of the mesh's
  /// extent (half its box's diagonal); 0: not at all.
  double smoothing = 0.008;
  /// But by no less than this many mean edge lengths: below that curvature is the triangulation's.
  double smoothingEdges = 1.5;
  /// One byte a half-edge, not 0 on sharp edges (creases), or empty. A surface has no curvature
  /// there, and what is beside them is computed from the faces that do not touch any.
  std::span<const std::uint8_t> sharp = {};
};

/// How a surface bends at each vertex. Lengths are grid units; curvature is positive where the
/// surface is convex. Where nothing is known (beside creases only) everything is 0.
struct SurfaceCurvature {
  std::vector<glm::vec3> normals;  // unit, smoothed, outward
  /// Unit principal directions: of the curvature that is larger in size first; then the other. The
  /// three of a vertex are a right-handed frame: directions1 × directions2 = normals.
  std::vector<glm::vec3> directions1;
  std::vector<glm::vec3> directions2;
  std::vector<glm::vec2> curvatures;  // along directions1 and directions2; |x| ≥ |y|
  /// The derivative of the curvature tensor in that frame, a symmetric 2 × 2 × 2 tensor:
  /// (C111, C112, C122, C222) [Rusinkiewicz04].
  std::vector<glm::vec4> derivatives;
  std::vector<std::uint8_t> isKnown;
  /// The size of the smallest details: what limits of strength are relative to.
  float featureSize = 1.0F;
};

/// Curvature and its derivative per vertex. positions: one a vertex, grid units.
/// Threads: reentrant. Cost: O(faces), some 0.4 µs each, and as much again for smoothing.
[[nodiscard]] SurfaceCurvature curvatureOf(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    const CurvatureOptions& options = {});

}  // namespace limn
