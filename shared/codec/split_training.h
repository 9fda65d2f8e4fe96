// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/front_classes.h"
#include "shared/codec/split_model.h"
#include "shared/progressive/split_forest.h"

namespace limn {

/// A model's own probabilities, whatever they cost to send. For default_model.h and studies.
[[nodiscard]] SplitModel measureSplitModel(const SplitForest& forest, const LevelFronts& fronts);

/// The model to send for a forest. fronts: frontsOf(forest). Deterministic. Cost: O(splits).
[[nodiscard]] SplitModel trainSplitModel(const SplitForest& forest, const LevelFronts& fronts);

}  // namespace limn
