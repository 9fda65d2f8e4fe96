// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/have_set.h"

#include "shared/core/ids.h"
#include "shared/progressive/split_forest.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Prerequisites the other way round: which splits need a vertex. Constant after construction.
class Dependents {
 public:
  /// Cost: O(splits · ring) time, as much memory as the forest's rings.
  explicit Dependents(const SplitForest& forest);

  [[nodiscard]] std::span<const VertexId> of(VertexId v) const {
    return {splits_.data() + begin_[v], begin_[v + 1] - begin_[v]};
  }

  /// Those of `ids` (sorted, held) that must stay so that what is left of `have` is closed: what
  /// held splits outside of `ids` need, and what that needs. Cost: O(ids · dependents).
  [[nodiscard]] std::vector<VertexId> neededOf(const HaveSet& have, std::span<const VertexId> ids)
      const;

  [[nodiscard]] std::size_t bytes() const {
    return (begin_.capacity() + splits_.capacity()) * sizeof(std::uint32_t);
  }

 private:
  std::vector<std::uint32_t> begin_;  // by vertex, and the end
  std::vector<VertexId> splits_;
};

}  // namespace limn
