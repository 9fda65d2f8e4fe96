// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"

namespace limn {

/// visit(h) for every half-edge that leaves the vertex which `out` leaves: from `out`
/// counter-clockwise, then, at a border, the rest clockwise. Cost: O(valence).
template <class Visit>
void forFan(const HalfEdgeMesh& mesh, HalfEdgeId out, Visit visit) {
  HalfEdgeId h = out;
  do {
    visit(h);
    h = mesh.rotateCcw(h);
  } while (h != kNone && h != out);
  if (h != kNone) return;
  for (h = mesh.rotateCw(out); h != kNone; h = mesh.rotateCw(h))
    visit(h);
}

}  // namespace limn
