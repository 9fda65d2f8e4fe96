// SPDX-License-Identifier: Apache-2.0
#include "server/session/scheduler.h"

#include <algorithm>
#include <bit>
#include <set>

namespace limn {
namespace {

/// Appends the ids of the bits set in `missing`, word number `word`. True when `ids` is full.
bool appendBits(
    std::uint64_t missing,
    std::size_t word,
    std::size_t maxSplits,
    std::vector<VertexId>& ids) {
  while (missing != 0) {
    if (ids.size() >= maxSplits) return true;
    ids.push_back(
        static_cast<VertexId>(word * 64) + static_cast<VertexId>(std::countr_zero(missing)));
    missing &= missing - 1;
  }
  return false;
}

}  // namespace

std::vector<VertexId> nextSplits(
    const TargetSet& target,
    const HaveSet& have,
    std::size_t maxSplits,
    ScheduleCursor& cursor) {
  std::vector<VertexId> ids;
  ids.reserve(std::min<std::size_t>(maxSplits, 256));
  const auto held = have.words();
  std::size_t word = cursor.word;
  bool passing = true;  // nothing found yet: the cursor may move along
  bool full = false;
  for (std::size_t c = cursor.targetClass; c < target.classes.size() && !full; ++c, word = 0) {
    const auto& wanted = target.classes[c];
    const auto before = static_cast<std::ptrdiff_t>(ids.size());
    for (; word < wanted.size() && !full; ++word) {
      const std::uint64_t missing = wanted[word] & ~held[word];
      if (missing == 0) continue;
      if (passing) cursor = {c, word};
      passing = false;
      full = appendBits(missing, word, maxSplits, ids);
    }
    std::ranges::inplace_merge(ids, ids.begin() + before);
  }
  if (passing) cursor = {target.classes.size(), 0};
  return ids;
}

std::uint32_t missingOf(const TargetSet& target, const HaveSet& have) {
  const auto held = have.words();
  std::uint32_t count = 0;
  for (const auto& wanted : target.classes) {
    for (std::size_t word = 0; word < wanted.size(); ++word)
      count += static_cast<std::uint32_t>(std::popcount(wanted[word] & ~held[word]));
  }
  return count;
}

std::vector<VertexId>
nextSplitsOfAll(const HaveSet& have, std::size_t maxSplits, ScheduleCursor& cursor) {
  std::vector<VertexId> ids;
  const auto held = have.words();
  bool passing = true;
  for (std::size_t word = cursor.word; word < held.size(); ++word) {
    std::uint64_t missing = ~held[word];
    const std::size_t left = have.vertexCount() - word * 64;
    if (left < 64) missing &= (std::uint64_t{1} << left) - 1;
    if (passing && missing == 0) cursor.word = word + 1;
    if (missing != 0) passing = false;
    if (appendBits(missing, word, maxSplits, ids)) break;
  }
  return ids;
}

std::vector<VertexId>
randomSplits(const SplitForest& forest, const HaveSet& have, std::size_t maxSplits, Rng& rng) {
  std::vector<VertexId> missing;
  for (VertexId v = forest.baseVertexCount(); v < forest.vertexCount(); ++v) {
    if (!have.holds(v)) missing.push_back(v);
  }
  std::set<VertexId> chosen;
  std::vector<VertexId> open;
  while (chosen.size() < std::min(maxSplits, missing.size())) {
    open.push_back(missing[rng.below(static_cast<std::uint32_t>(missing.size()))]);
    while (!open.empty()) {
      const VertexId v = open.back();
      open.pop_back();
      if (have.holds(v) || !chosen.insert(v).second) continue;
      forest.forEachPrerequisite(v, [&](VertexId w) { open.push_back(w); });
    }
  }
  return {chosen.begin(), chosen.end()};
}

}  // namespace limn
