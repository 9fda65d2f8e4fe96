// SPDX-License-Identifier: Apache-2.0
#include "server/session/dependents.h"

#include <algorithm>

namespace limn {

Dependents::Dependents(const SplitForest& forest) : begin_(forest.vertexCount() + 1U, 0) {
  const std::uint32_t base = forest.baseVertexCount();
  for (VertexId v = base; v < forest.vertexCount(); ++v)
    forest.forEachPrerequisite(v, [&](VertexId w) { ++begin_[w + 1]; });
  for (std::size_t i = 1; i < begin_.size(); ++i)
    begin_[i] += begin_[i - 1];
  splits_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (VertexId v = base; v < forest.vertexCount(); ++v)
    forest.forEachPrerequisite(v, [&](VertexId w) { splits_[next[w]++] = v; });
}

std::vector<VertexId> Dependents::neededOf(const HaveSet& have, std::span<const VertexId> ids)
    const {
  // Dependents have larger ids: from the last one on, all that may need a vertex is decided.
  std::vector<VertexId> kept;  // descending
  std::vector<bool> goes(ids.size(), true);
  for (std::size_t i = ids.size(); i-- > 0;) {
    const auto isNeeded = std::ranges::any_of(of(ids[i]), [&](VertexId split) {
      if (!have.holds(split)) return false;
      const auto at = std::lower_bound(ids.begin(), ids.end(), split);
      return at == ids.end() || *at != split || !goes[static_cast<std::size_t>(at - ids.begin())];
    });
    if (!isNeeded) continue;
    goes[i] = false;
    kept.push_back(ids[i]);
  }
  std::ranges::reverse(kept);
  return kept;
}

}  // namespace limn
