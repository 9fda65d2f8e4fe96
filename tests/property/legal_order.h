// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/rng.h"
#include "shared/progressive/split_forest.h"

#include <vector>

namespace limn {

/// All splits in a random order in which each comes after its prerequisites. `lastFirst` takes the
/// split that became possible last (depth first) instead of any.
enum class OrderKind { kUniform, kDepthFirst };

inline std::vector<VertexId> randomLegalOrder(const SplitForest& forest, Rng& rng, OrderKind kind) {
  const std::uint32_t base = forest.baseVertexCount();
  std::vector<std::vector<VertexId>> dependents(forest.vertexCount());
  std::vector<std::uint32_t> missing(forest.splitCount(), 0);
  std::vector<VertexId> ready;
  for (VertexId v = base; v < forest.vertexCount(); ++v) {
    const auto require = [&](VertexId prerequisite) {
      if (prerequisite < base) return;
      dependents[prerequisite].push_back(v);
      ++missing[v - base];
    };
    forest.forEachPrerequisite(v, require);
    if (missing[v - base] == 0) ready.push_back(v);
  }
  std::vector<VertexId> order;
  while (!ready.empty()) {
    const std::size_t pick = kind == OrderKind::kUniform
                                 ? rng.below(static_cast<std::uint32_t>(ready.size()))
                                 : ready.size() - 1;
    const VertexId v = ready[pick];
    ready[pick] = ready.back();
    ready.pop_back();
    order.push_back(v);
    for (const VertexId w : dependents[v]) {
      if (--missing[w - base] == 0) ready.push_back(w);
    }
  }
  return order;
}

}  // namespace limn
