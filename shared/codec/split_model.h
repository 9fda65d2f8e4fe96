// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/bin_coder.h"
#include "shared/codec/position_prediction.h"
#include "shared/core/result.h"
#include "shared/progressive/vertex_split.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// What every run of one model starts from: probabilities of the split coder's contexts and weights
/// of the predictions. All are universal but for what the model changes where that pays; the
/// changes are sent once (ModelInfo.split_model). Packets carry no tables and no state: any packet
/// decodes on any client that holds its prerequisites.
struct SplitModel {
  std::vector<Probability> probabilities;  // one a context of split_syntax.h
  split_syntax::Weights weights{};         // of the position's prediction
  Placement placement = Placement::kSubset;
  split_syntax::MoveWeights moveWeights{};  // of the parent's, with Placement::kVolume
};

/// The universal model: the mean over some meshes (default_model.h). Cost: none after the first
/// call.
[[nodiscard]] const SplitModel& defaultSplitModel();

/// As ModelInfo.split_model carries it: what differs from the universal model (SPEC.md).
[[nodiscard]] std::vector<std::uint8_t> serializeSplitModel(const SplitModel& model);

/// The inverse. placement: the model's. Errors: kCorrupt.
[[nodiscard]] Result<SplitModel> parseSplitModel(
    std::span<const std::uint8_t> bytes,
    Placement placement = Placement::kSubset);

}  // namespace limn
