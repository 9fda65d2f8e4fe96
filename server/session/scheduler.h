// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/have_set.h"
#include "server/session/target_set.h"

#include "shared/core/ids.h"
#include "shared/core/rng.h"
#include "shared/progressive/split_forest.h"

#include <cstdint>
#include <vector>

namespace limn {

/// Where the search for missing splits goes on. Everything before it is held, as long as the
/// have-set only grows and the target stays.
struct ScheduleCursor {
  std::size_t targetClass = 0;
  std::size_t word = 0;
};

/// The next splits of a target set that a client lacks, by class, then id; at most maxSplits,
/// returned sorted by id. Legal as one packet: prerequisites are held or among them. Moves the
/// cursor past what is held. Cost: O(words passed + splits returned).
[[nodiscard]] std::vector<VertexId> nextSplits(
    const TargetSet& target,
    const HaveSet& have,
    std::size_t maxSplits,
    ScheduleCursor& cursor);

/// How many splits of a target set a client lacks. Cost: O(words).
[[nodiscard]] std::uint32_t missingOf(const TargetSet& target, const HaveSet& have);

/// The next splits in order of id, of all. cursor.word alone is used.
[[nodiscard]] std::vector<VertexId>
nextSplitsOfAll(const HaveSet& have, std::size_t maxSplits, ScheduleCursor& cursor);

/// For tests: at most about maxSplits (at least one, if one is missing) of those missing, in an
/// order that is random but legal: each drawn at random with its missing prerequisites, sorted by
/// id.
[[nodiscard]] std::vector<VertexId>
randomSplits(const SplitForest& forest, const HaveSet& have, std::size_t maxSplits, Rng& rng);

}  // namespace limn
