// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/line_scene.h"

#include <cstddef>
#include <cstdint>

namespace limn {

/// Asks for the mesh's memory of faces that come up soon, so that it is near by then: a line's
/// faces lie anywhere in a mesh that no near cache holds. faceAt(i): the i-th of `count` faces to
/// come, or kNone; call once for each i. Cost: O(1), some nanoseconds.
/// Always inline: GCC takes a function that does nothing else for one without effects, and leaves
/// out its calls.
template <class FaceAt>
inline __attribute__((always_inline)) void
prefetchFaces(const LineScene& scene, std::size_t i, std::size_t count, FaceAt faceAt) {
  constexpr std::size_t kFarAhead = 32;
  constexpr std::size_t kNearAhead = 12;
  const HalfEdgeMesh& mesh = scene.mesh;
  // First for the corners, then for where those are.
  if (i + kFarAhead < count) {
    const FaceId face = faceAt(i + kFarAhead);
    if (face < mesh.faceCount()) __builtin_prefetch(&mesh.origins[3 * face]);
  }
  if (i + kNearAhead < count) {
    const FaceId face = faceAt(i + kNearAhead);
    if (face >= mesh.faceCount()) return;
    for (HalfEdgeId h = 3 * face; h < 3 * face + 3; ++h)
      __builtin_prefetch(&scene.positions[mesh.origin(h)]);
  }
}

}  // namespace limn
