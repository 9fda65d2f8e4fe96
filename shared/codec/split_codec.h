// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/attribute_codec.h"
#include "shared/codec/bin_coder.h"
#include "shared/codec/front_classes.h"
#include "shared/codec/split_model.h"
#include "shared/codec/split_symbols.h"
#include "shared/core/ids.h"
#include "shared/core/result.h"
#include "shared/progressive/active_mesh.h"
#include "shared/progressive/split_forest.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace limn {

/// Of one run, at most.
inline constexpr std::uint32_t kMaxRunSplits = 1U << 20;

/// Codes splits for a client that holds (or gets in this run, before them) their prerequisites.
/// ids: sorted, unique, none of the base. Pure; depends on nothing but its arguments, so equal
/// selections give equal bytes. Cost: about 1 µs a split; PacketEncoder is faster. Threads:
/// reentrant.
[[nodiscard]] std::vector<std::uint8_t>
encodeSplits(const SplitForest& forest, const SplitModel& model, std::span<const VertexId> ids);

/// What encodeSplits() codes for split v, its name apart. `symbols`: empty.
void modelSplit(
    const SplitForest& forest,
    const SplitModel& model,
    VertexId v,
    SplitSymbols& symbols);

/// Splits of a level run, at most, as preparation makes them: some 8 KB, so that progress shows.
inline constexpr std::uint32_t kLevelRunSplits = 4096;

/// Codes the splits begin … end − 1 of one level for a client that holds every vertex of coarser
/// levels and, of this one, the vertex before `begin`: their names cost a third of what they cost
/// in encodeSplits. fronts: frontsOf(forest).
[[nodiscard]] std::vector<std::uint8_t> encodeLevelRun(
    const SplitForest& forest,
    const SplitModel& model,
    const LevelFronts& fronts,
    VertexId begin,
    VertexId end);

/// What the head of a run that encodeLevelRun made says.
struct LevelRunHead {
  VertexId begin = 0;
  std::uint32_t count = 0;
};

/// Nothing for any other bytes. Says nothing about what follows the head.
[[nodiscard]] std::optional<LevelRunHead> levelRunHead(std::span<const std::uint8_t> bytes);

/// Decodes runs of one model.
class SplitDecoder {
 public:
  SplitDecoder() = default;

  /// attributeKinds: what the model carries besides positions, AttributeKind bits.
  explicit SplitDecoder(SplitModel model, std::uint8_t attributeKinds = 0)
      : model_(std::move(model)),
        attributeKinds_(attributeKinds) {}

  /// Decodes a run and applies it split by split to the client's mesh of the model. Total over any
  /// bytes: on an error (kCorrupt, kNonManifold, kLimitExceeded) the splits before it stay applied,
  /// and the mesh is valid. attributes: of encodeAttributes(), empty where the model has none.
  /// Returns the number of splits applied. Threads: one.
  [[nodiscard]] Result<std::uint32_t> decode(
      std::span<const std::uint8_t> bytes,
      ActiveMesh& mesh,
      std::span<const std::uint8_t> attributes = {});

 private:
  [[nodiscard]] Result<void> decodeShape(
      BinReader& bins,
      AttributeReader& attributes,
      const ActiveMesh& mesh,
      VertexSplit& split);

  SplitModel model_;
  std::uint8_t attributeKinds_ = 0;
  // Of the level that the last level run belonged to, since several runs make a level; 0: none.
  std::uint32_t frontLevel_ = 0;
  std::vector<std::uint8_t> front_;
  std::vector<Slot> ring_;  // scratch
};

}  // namespace limn
