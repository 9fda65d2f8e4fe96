// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/mesh/triangle_mesh.h"

#include <cstdint>

namespace limn {

struct HoleOptions {
  /// A border larger than this share of the model's box, diagonal by diagonal, is no hole but how
  /// the model ends.
  double largestHole = 0.2;
};

struct ClosedMesh {
  TriangleMesh mesh;  // the input's vertices first, then those that a fill needed
  std::uint32_t filledHoles = 0;
};

/// Closes the holes of an oriented manifold: triangles between the vertices of each border, of the
/// least area where CGAL finds them [Liepa03]; a fan around a new vertex where those would use an
/// edge twice. Errors: kUnsupported when a border is too large, with what it measures;
/// kNonManifold. Deterministic. Cost: about n³ for a border of n edges, up to a second.
[[nodiscard]] Result<ClosedMesh> closeHoles(const TriangleMesh& mesh, const HoleOptions& options);

}  // namespace limn
