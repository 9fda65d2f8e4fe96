// SPDX-License-Identifier: Apache-2.0
#include "server/session/scheduler.h"

#include <algorithm>
#include <bit>
#include <set>
#include <span>

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

/// The first word from `word` on in which something wanted is missing; wanted.size(): none.
std::size_t nextMissing(
    std::span<const std::uint64_t> wanted,
    std::span<const std::uint64_t> held,
    std::size_t word) {
  // Eight at a time, without a branch, since mostly nothing is.
  constexpr std::size_t kBlock = 8;
  for (; word + kBlock <= wanted.size(); word += kBlock) {
    std::uint64_t any = 0;
    for (std::size_t i = 0; i < kBlock; ++i)
      any |= wanted[word + i] & ~held[word + i];
    if (any != 0) break;
  }
  while (word < wanted.size() && (wanted[word] & ~held[word]) == 0)
    ++word;
  return word;
}

}  // namespace

std::vector<VertexId> nextSplits(
    const TargetSet& target,
    const HaveSet& have,
    std::size_t maxSplits,
    ScheduleCursor& cursor) {
  if (cursor.targetClass >= target.classes.size()) return {};
  const std::span<const std::uint64_t> held = have.words();
  const std::span<const std::uint64_t> all = target.all();
  std::vector<VertexId> ids;
  // Mostly little is missing, and then it comes at once, of whatever class. One more tells.
  std::size_t word = target.classes.size() == 1 ? cursor.word : 0;
  while ((word = nextMissing(all, held, word)) < all.size()) {
    if (appendBits(all[word] & ~held[word], word, maxSplits + 1, ids)) break;
    ++word;
  }
  if (ids.size() <= maxSplits) {
    if (ids.empty()) cursor = {target.classes.size(), 0};
    return ids;
  }
  ids.clear();
  word = cursor.word;
  bool passing = true;  // nothing found yet: the cursor may move along
  bool full = false;
  for (std::size_t c = cursor.targetClass; c < target.classes.size() && !full; ++c, word = 0) {
    const std::vector<std::uint64_t>& wanted = target.classes[c];
    const auto before = static_cast<std::ptrdiff_t>(ids.size());
    for (; word < wanted.size() && !full; ++word) {
      // What classes before have is held, or chosen above.
      const std::uint64_t earlier = c == 0 ? 0 : target.classes[c - 1][word];
      const std::uint64_t missing = wanted[word] & ~earlier & ~held[word];
      if (missing == 0) continue;
      if (passing) cursor = {c, word};
      passing = false;
      full = appendBits(missing, word, maxSplits, ids);
    }
    std::ranges::inplace_merge(ids, ids.begin() + before);
  }
  return ids;
}

std::uint32_t missingOf(const TargetSet& target, const HaveSet& have) {
  const auto held = have.words();
  std::uint32_t count = 0;
  for (std::size_t word = 0; word < held.size(); ++word)
    count += static_cast<std::uint32_t>(std::popcount(target.all()[word] & ~held[word]));
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
