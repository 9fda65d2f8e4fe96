// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/triangle_mesh.h"

namespace limn::primitives {

/// Generated shapes for tests, benches and demos: closed unless said, outward, on a 14-bit grid.
[[nodiscard]] TriangleMesh tetrahedron();
[[nodiscard]] TriangleMesh cube();                       // 12 faces, sharp creases
[[nodiscard]] TriangleMesh icosphere(int subdivisions);  // 20 · 4^n faces
[[nodiscard]] TriangleMesh torus(int rings, int sides);  // 2 · rings · sides faces, genus 1
[[nodiscard]] TriangleMesh torusKnot(int p, int q, int segments, int sides);
[[nodiscard]] TriangleMesh openGrid(int columns, int rows);  // a height field with one border
[[nodiscard]] TriangleMesh bumpySphere(
    int subdivisions,
    std::uint64_t seed);  // many small contour loops

}  // namespace limn::primitives
