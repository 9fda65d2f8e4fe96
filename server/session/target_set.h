// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/view.h"

#include "shared/core/ids.h"
#include "shared/progressive/split_forest.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Priority of a split for a view. Lower comes first; kNotNeeded only for a complete mesh.
enum TargetClass : std::uint8_t {
  kNeededAt8 = 0,  // for 8 times the pose's error bound
  kNeededAt4 = 1,
  kNeededAt2 = 2,
  kNeededAt1 = 3,  // these and all before: settled
  kNotNeeded = 255,
};

inline constexpr std::size_t kSettledClasses = 4;

/// The splits that a view needs, closed under prerequisites: a bit mask over vertex ids a class,
/// which has what the classes before it have too; the last is all. Ordered by class, then by id,
/// every prefix is closed: prerequisites have smaller ids and no later class. Constant; shared by
/// sessions and threads.
struct TargetSet {
  std::vector<std::vector<std::uint64_t>> classes;  // words as in HaveSet; at least one

  [[nodiscard]] const std::vector<std::uint64_t>& all() const { return classes.back(); }

  [[nodiscard]] std::size_t bytes() const {
    std::size_t sum = sizeof(TargetSet);
    for (const auto& words : classes)
      sum += sizeof(words) + words.capacity() * sizeof(std::uint64_t);
    return sum;
  }
};

/// One cone a split: the split's own, widened to the full mesh's vertex normals around it. Where a
/// flat face meets a crease, interpolated normals turn within the face although it is flat, and so
/// smooth silhouettes cross it. Cost: O(splits · ring), once a model.
[[nodiscard]] std::vector<SplitCone> smoothConesOf(const SplitForest& forest);

/// What a view needs, before closure: one TargetClass a split. smoothCones: of smoothConesOf(), or
/// empty; used for smooth silhouettes. Cost: O(splits), about 20 ns each.
[[nodiscard]] std::vector<std::uint8_t> classifySplits(
    const SplitForest& forest,
    const View& view,
    std::span<const SplitCone> smoothCones = {});

/// Lowers the class of every prerequisite to that of what needs it. classes: one a split. One
/// backward pass suffices, since prerequisites have smaller ids. Cost: O(splits · ring).
[[nodiscard]] std::vector<std::uint8_t> closeOverPrerequisites(
    const SplitForest& forest,
    std::vector<std::uint8_t> classes);

/// Classes as masks; classCount of them, from 0.
[[nodiscard]] TargetSet targetSetOf(
    const SplitForest& forest,
    std::span<const std::uint8_t> classes,
    std::size_t classCount);

/// The target set of a view's error bound.
[[nodiscard]] TargetSet selectForView(
    const SplitForest& forest,
    const View& view,
    std::span<const SplitCone> smoothCones = {});

/// Whether `have` (words as in HaveSet, base vertices included) holds every prerequisite of what it
/// holds. Cost: O(splits held · ring).
[[nodiscard]] bool isClosed(const SplitForest& forest, std::span<const std::uint64_t> have);

}  // namespace limn
