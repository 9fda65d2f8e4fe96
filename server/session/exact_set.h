// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/full_mesh.h"
#include "server/session/target_set.h"
#include "server/session/view.h"

#include <cstdint>
#include <vector>

namespace limn {

/// Faces of the full mesh that must be there as they are for silhouettes to be the full mesh's,
/// edge for edge, hidden ones included, no frustum test: on kEdges both faces of every silhouette
/// edge; on kSmooth all faces around the corners of every face that the silhouette crosses. One
/// byte a face. Cost: O(faces), brute force: about 5 ns each.
[[nodiscard]] std::vector<std::uint8_t> facesOfExact(const FullMesh& full, const View& view);

/// The splits that make those faces present as they are, closed, as a set of one class: coarse
/// first.
[[nodiscard]] TargetSet selectExact(const FullMesh& full, const View& view);

}  // namespace limn
