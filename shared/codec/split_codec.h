// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/bin_coder.h"
#include "shared/codec/split_syntax.h"
#include "shared/core/ids.h"
#include "shared/core/result.h"
#include "shared/progressive/active_mesh.h"
#include "shared/progressive/split_forest.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Probabilities of the split coder's contexts, measured on one model at preparation and sent once
/// (ModelInfo.split_model). Packets carry no tables and no state: any packet decodes on any client
/// that holds its prerequisites.
struct SplitModel {
  std::vector<Probability> probabilities;  // one a context of split_syntax.h
  split_syntax::Weights weights{};         // of the position's prediction
};

/// Measures a model's probabilities. Deterministic. Cost: O(splits).
[[nodiscard]] SplitModel trainSplitModel(const SplitForest& forest);

[[nodiscard]] std::vector<std::uint8_t> serializeSplitModel(const SplitModel& model);
[[nodiscard]] Result<SplitModel> parseSplitModel(std::span<const std::uint8_t> bytes);

/// Codes splits for a client that holds (or gets in this run, before them) their prerequisites.
/// ids: sorted, unique, none of the base. Pure; depends on nothing but its arguments, so equal
/// selections give equal bytes. Cost: about 0.2 µs a split. Threads: reentrant.
[[nodiscard]] std::vector<std::uint8_t>
encodeSplits(const SplitForest& forest, const SplitModel& model, std::span<const VertexId> ids);

/// Decodes a run and applies it split by split. Total over any bytes: on an error (kCorrupt,
/// kNonManifold, kLimitExceeded) the splits before it stay applied, and the mesh is valid.
/// Returns the number of splits applied.
[[nodiscard]] Result<std::uint32_t>
decodeSplits(std::span<const std::uint8_t> bytes, const SplitModel& model, ActiveMesh& mesh);

}  // namespace limn
