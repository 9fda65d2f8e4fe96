// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/front_classes.h"
#include "shared/codec/split_model.h"
#include "shared/codec/split_syntax.h"
#include "shared/core/assert.h"
#include "shared/core/result.h"
#include "shared/progressive/split_forest.h"

#include <cstdint>
#include <span>
#include <string>

/// Whole splits and runs of them in the split coder's syntax, for every end of it: encoder, decoder
/// (codeShape), trainer and meter. Not for others; they call split_codec.h.
namespace limn::split_syntax {

/// kCorrupt: what a decoder finds wrong.
inline tl::unexpected<Error> damaged(const char* what) {
  return fail(ErrorCode::kCorrupt, std::string("splits are damaged: ") + what);
}

/// A split as it is coded, its name apart.
struct Shape {
  RingCut cut;
  std::uint8_t features = 0;
  glm::ivec3 position{0};
  glm::ivec3 parentMove{0};
};

/// What follows a split's name. shape: in and out. Errors (kCorrupt): only where the syntax is
/// read.
template <class Bins>
Result<void> codeShape(Bins& bins, const Neighbourhood& n, const SplitModel& model, Shape& shape) {
  if (!codeCut(bins, n, shape.cut)) return damaged("no cut fits");
  shape.features = codeFeatures(bins, shape.features);
  const auto fan = fanOf(n, shape.cut);
  const auto prediction = predict(n, fan);
  codePosition(bins, n, prediction, model.weights, shape.position);
  if (!isOnGrid(shape.position)) return damaged("a position off the grid");
  // Vertices on a border never move.
  if (model.placement == Placement::kSubset || n.isPath) return {};
  if constexpr (requires { bins.beginMove(); }) bins.beginMove();
  codeMove(bins, n, fan, prediction, model.moveWeights, shape.position, shape.parentMove);
  return {};
}

/// What follows the name of split v of a forest.
template <class Bins>
void encodeShape(Bins& bins, const SplitForest& forest, const SplitModel& model, VertexId v) {
  const std::uint32_t s = v - forest.baseVertexCount();
  const VertexSplit split = forest.split(v);
  constexpr std::uint8_t kEdges =
      kSplitEdgeUV | kSplitEdgeUL | kSplitEdgeVL | kSplitEdgeUR | kSplitEdgeVR;
  Shape shape{
      forest.cuts[s],
      static_cast<std::uint8_t>(split.features & kEdges),
      split.position,
      split.parentMove};
  const auto coded = codeShape(bins, neighbourhoodOf(forest, v), model, shape);
  LIMN_ASSERT(coded);
  static_cast<void>(coded);
}

/// The splits `ids`, sorted, with their names.
template <class Bins>
void encodeRun(
    Bins& bins,
    const SplitForest& forest,
    const SplitModel& model,
    std::span<const VertexId> ids) {
  NameState names;
  for (const VertexId id : ids) {
    VertexId vertex = id;
    VertexId parent = forest.parent(id);
    codeName(bins, names, forest.levelBegin, vertex, parent);
    encodeShape(bins, forest, model, id);
  }
}

/// The first vertex that can be the parent of `first` in a level run.
inline VertexId firstParent(const SplitForest& forest, VertexId first) {
  const bool startsLevel = forest.levelBegin[forest.levelOf(first)] == first;
  return startsLevel ? 0 : forest.parent(first - 1) + 1;
}

/// The splits begin … end − 1 of one level. front: of that level (frontsOf()).
template <class Bins>
void encodeLevelRun(
    Bins& bins,
    const SplitForest& forest,
    const SplitModel& model,
    std::span<const std::uint8_t> front,
    VertexId begin,
    VertexId end) {
  VertexId next = firstParent(forest, begin);
  for (VertexId v = begin; v < end; ++v) {
    next = codeParent(bins, front, next, forest.parent(v)) + 1;
    encodeShape(bins, forest, model, v);
  }
}

}  // namespace limn::split_syntax
