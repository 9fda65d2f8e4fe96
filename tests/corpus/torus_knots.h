// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/triangle_mesh.h"

#include <cstdint>

namespace limn::corpus {

struct KnotOptions {
  int segments = 4000;     // along the (2,3) torus knot
  int sides = 125;         // around it; faces: 2 · segments · sides
  int gridBits = 18;       // fine, so that a smooth knot is smooth
  double roughness = 0.0;  // vertices move by up to this share of the tube's radius
  std::uint64_t seed = 1;
};

/// Torus knots larger than any test needs, for benches: a smooth one has few and long silhouettes,
/// a rough one many short ones. Closed, outward. Deterministic up to the platform's sine.
[[nodiscard]] TriangleMesh torusKnot(const KnotOptions& options);

}  // namespace limn::corpus
