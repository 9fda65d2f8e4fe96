// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/bench/plain_mesh.h"

#include <cstddef>

/// The simplifiers that ours are compared with, each as its users call it. All: down to `faces`
/// faces or where they stop, one thread.
namespace limn::bench {

/// OpenMesh 9, DecimaterT with ModQuadric [GarlandHeckbert97], half-edge collapses.
[[nodiscard]] PlainMesh simplifyOpenMesh(const PlainMesh& mesh, std::size_t faces);

/// CGAL, edge_collapse with LindstromTurk_cost and LindstromTurk_placement [Lindstrom98].
[[nodiscard]] PlainMesh simplifyLindstromTurk(const PlainMesh& mesh, std::size_t faces);

/// CGAL, edge_collapse with GarlandHeckbert_plane_policies [GarlandHeckbert97].
[[nodiscard]] PlainMesh simplifyGarlandHeckbert(const PlainMesh& mesh, std::size_t faces);

/// meshopt_simplify, target error 1 (no limit).
[[nodiscard]] PlainMesh simplifyMeshopt(const PlainMesh& mesh, std::size_t faces);

}  // namespace limn::bench
