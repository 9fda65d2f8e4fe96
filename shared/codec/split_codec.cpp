// SPDX-License-Identifier: Apache-2.0
//
// A run of splits: varint 2·count + (1: a level run), (level run: varint first id), then one rANS
// stream with, split by split, name, cut, features, position, move (split_syntax.h).
#include "shared/codec/split_codec.h"

#include "shared/codec/split_run.h"
#include "shared/codec/varint.h"
#include "shared/core/assert.h"

#include <algorithm>
#include <string>

namespace limn {
namespace {

using split_syntax::damaged;
using split_syntax::kMaxRing;
using split_syntax::NameState;
using split_syntax::Neighbourhood;

}  // namespace

std::vector<std::uint8_t>
encodeSplits(const SplitForest& forest, const SplitModel& model, std::span<const VertexId> ids) {
  LIMN_ASSERT(std::is_sorted(ids.begin(), ids.end()));
  std::vector<std::uint8_t> bytes;
  appendVarint(2 * ids.size(), bytes);
  BinWriter bins(model.probabilities);
  split_syntax::encodeRun(bins, forest, model, ids);
  bins.finish(bytes);
  return bytes;
}

void modelSplit(
    const SplitForest& forest,
    const SplitModel& model,
    VertexId v,
    SplitSymbols& symbols) {
  split_syntax::encodeShape(symbols, forest, model, v);
}

std::vector<std::uint8_t> encodeLevelRun(
    const SplitForest& forest,
    const SplitModel& model,
    const LevelFronts& fronts,
    VertexId begin,
    VertexId end) {
  const std::uint32_t level = forest.levelOf(begin);
  LIMN_ASSERT(begin < end && end <= forest.levelBegin[level + 1]);
  std::vector<std::uint8_t> bytes;
  appendVarint(2 * (end - begin) + 1, bytes);
  appendVarint(begin, bytes);
  BinWriter bins(model.probabilities);
  split_syntax::encodeLevelRun(bins, forest, model, fronts[level], begin, end);
  bins.finish(bytes);
  return bytes;
}

std::optional<LevelRunHead> levelRunHead(std::span<const std::uint8_t> bytes) {
  VarintReader header(bytes);
  const auto counted = header.read();
  if (!counted || *counted % 2 == 0) return std::nullopt;
  const auto begin = header.read();
  if (!begin) return std::nullopt;
  return LevelRunHead{*begin, *counted / 2};
}

Result<std::uint32_t> SplitDecoder::decode(
    std::span<const std::uint8_t> bytes,
    ActiveMesh& mesh,
    std::span<const std::uint8_t> attributes) {
  VarintReader header(bytes);
  const auto counted = header.read();
  if (!counted) return damaged("no count");
  const std::uint32_t count = *counted / 2;
  if (count > kMaxRunSplits) {
    return fail(ErrorCode::kLimitExceeded, "a run claims " + std::to_string(count) + " splits");
  }
  const bool isLevelRun = (*counted & 1) != 0;
  VertexId vertex = 0;      // of a level run: the next split's
  VertexId nextParent = 0;  // of a level run: the first vertex that may be its parent
  VertexId levelEnd = 0;
  if (isLevelRun) {
    const auto first = header.read();
    if (!first || *first < mesh.baseVertexCount() || *first >= mesh.levelBegin().back()) {
      return damaged("no first vertex");
    }
    vertex = *first;
    const std::uint32_t level = mesh.levelOf(vertex);
    levelEnd = mesh.levelBegin()[level + 1];
    if (vertex != mesh.levelBegin()[level]) {
      if (!mesh.holds(vertex - 1)) return damaged("a level run without what comes before");
      nextParent = mesh.parentOf(vertex - 1) + 1;
    }
    if (frontLevel_ != level) {
      frontLevel_ = 0;
      auto front = frontClasses(mesh, level);
      if (!front) return tl::unexpected(front.error());
      front_ = std::move(*front);
      frontLevel_ = level;
    }
  }
  BinReader bins(model_.probabilities, header.rest());
  AttributeReader attributeReader(attributeKinds_, attributes);
  if (!bins.isValid() || !attributeReader.isValid()) return damaged("no coded bits");

  NameState names;
  for (std::uint32_t i = 0; i < count; ++i) {
    VertexSplit split;
    if (isLevelRun) {
      if (vertex >= levelEnd) return damaged("more splits than its level has");
      split.vertex = vertex++;
      split.parent = split_syntax::codeParent(bins, front_, nextParent, kNone);
      if (split.parent == kNone) return damaged("a split without parent");
      nextParent = split.parent + 1;
    } else {
      split_syntax::codeName(bins, names, mesh.levelBegin(), split.vertex, split.parent);
      if (split.vertex < mesh.baseVertexCount() || split.vertex >= mesh.levelBegin().back()) {
        return damaged("a vertex that the model does not have");
      }
    }
    if (auto shaped = decodeShape(bins, attributeReader, mesh, split); !shaped) {
      return tl::unexpected(shaped.error());
    }
    if (auto applied = mesh.apply(split); !applied) return tl::unexpected(applied.error());
  }
  if (!bins.isFinished() || !attributeReader.isFinished())
    return damaged("bytes left over or missing");
  return count;
}

Result<void> SplitDecoder::decodeShape(
    BinReader& bins,
    AttributeReader& attributes,
    const ActiveMesh& mesh,
    VertexSplit& split) {
  const Slot u = mesh.slotOf(split.parent);
  if (u == kNone) return damaged("a parent that is not held");
  const std::uint32_t level = mesh.levelOf(split.vertex);
  const VertexId end = mesh.levelBegin()[level];
  mesh.canonicalRingSlots(u, level, ring_);
  if (ring_.size() > kMaxRing || ring_.size() < 2)
    return damaged("a parent with an impossible ring");
  Neighbourhood n;
  n.size = static_cast<std::uint32_t>(ring_.size());
  n.parent = mesh.positionIn(end, u);
  for (std::uint32_t k = 0; k < n.size; ++k)
    n.ring[k] = mesh.positionIn(end, ring_[k]) - n.parent;
  n.isPath = mesh.mesh().isBorderVertex(u);
  split_syntax::Shape shape;
  if (auto coded = split_syntax::codeShape(bins, n, model_, shape); !coded) return coded;
  const RingCut cut = shape.cut;
  split.left = cut.left == RingCut::kNoCut ? kNone : mesh.ids()[ring_[cut.left]];
  split.right = cut.right == RingCut::kNoCut ? kNone : mesh.ids()[ring_[cut.right]];
  split.features = shape.features;
  split.position = shape.position;
  split.parentMove = shape.parentMove;
  attributes.read(mesh, ring_, n, cut, split);
  return {};
}

}  // namespace limn
