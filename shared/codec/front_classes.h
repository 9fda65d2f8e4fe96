// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/progressive/active_mesh.h"
#include "shared/progressive/split_forest.h"

#include <cstdint>
#include <vector>

namespace limn {

/// How likely each vertex coarser than `level` is to be the parent of a split of that level, as
/// classes 0 to 31 in steps of half a power of two of the odds, by vertex id: from its faces, their
/// area beside that around its neighbours, and the levels since it came. It is what a name costs
/// least with where a receiver knows all of the front.
/// `mesh` holds every vertex coarser than `level`; what else it holds makes no difference.
/// Errors: kCorrupt when a coarser vertex is missing. Cost: O(vertices of the mesh).
[[nodiscard]] Result<std::vector<std::uint8_t>> frontClasses(
    const ActiveMesh& mesh,
    std::uint32_t level);

/// frontClasses of every level: [level][vertex], empty for the base. Cost: O(splits), memory about
/// four bytes a vertex.
using LevelFronts = std::vector<std::vector<std::uint8_t>>;
[[nodiscard]] LevelFronts frontsOf(const SplitForest& forest);

}  // namespace limn
