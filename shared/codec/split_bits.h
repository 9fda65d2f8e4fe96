// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/front_classes.h"
#include "shared/codec/split_model.h"
#include "shared/core/ids.h"
#include "shared/progressive/split_forest.h"

namespace limn {

/// What splits hold by kind of symbol, in bits (−Σ log₂ p).
struct SplitBits {
  double names = 0.0;  // which splits, and their parents
  double cuts = 0.0;   // where the parents' rings open
  double features = 0.0;
  double positions = 0.0;
  double moves = 0.0;  // where the parents go

  SplitBits& operator+=(const SplitBits& other) {
    names += other.names;
    cuts += other.cuts;
    features += other.features;
    positions += other.positions;
    moves += other.moves;
    return *this;
  }

  [[nodiscard]] double total() const { return names + cuts + features + positions + moves; }
};

/// What encodeLevelRun(forest, model, fronts, begin, end) spends its bytes on: the run has
/// total() / 8 of them, and at most 12 more for its head and the coder's end.
[[nodiscard]] SplitBits measureLevelRun(
    const SplitForest& forest,
    const SplitModel& model,
    const LevelFronts& fronts,
    VertexId begin,
    VertexId end);

}  // namespace limn
