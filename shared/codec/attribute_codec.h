// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/adaptive_bins.h"
#include "shared/codec/neighbourhood.h"
#include "shared/core/ids.h"
#include "shared/core/result.h"
#include "shared/progressive/active_mesh.h"
#include "shared/progressive/split_forest.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Codes the attributes (colours, normals, seams: those that the forest has) of the splits that a
/// run of encodeSplits() or encodeLevelRun() carries, in its order: a stream of its own beside the
/// run, without state and without tables, that decodes wherever the run does. Empty where the
/// forest has none. Threads: reentrant. Cost: about 0.3 µs a split.
[[nodiscard]] std::vector<std::uint8_t> encodeAttributes(
    const SplitForest& forest,
    std::span<const VertexId> ids);

/// The same for begin … end − 1.
[[nodiscard]] std::vector<std::uint8_t>
encodeAttributes(const SplitForest& forest, VertexId begin, VertexId end);

/// What splits' attributes hold by kind, in bits (−Σ log₂ p).
struct AttributeBits {
  double colors = 0.0;
  double normals = 0.0;
  double seams = 0.0;

  AttributeBits& operator+=(const AttributeBits& other) {
    colors += other.colors;
    normals += other.normals;
    seams += other.seams;
    return *this;
  }

  [[nodiscard]] double total() const { return colors + normals + seams; }
};

/// What encodeAttributes(forest, begin, end) spends its bytes on: total() / 8 of them, and at most
/// 4 more for the coder's end.
[[nodiscard]] AttributeBits
measureAttributes(const SplitForest& forest, VertexId begin, VertexId end);

/// Reads such a stream, split by split, while the run beside it is decoded.
class AttributeReader {
 public:
  /// kinds: AttributeKind bits of the model.
  AttributeReader(std::uint8_t kinds, std::span<const std::uint8_t> bytes);
  AttributeReader(const AttributeReader&) = delete;
  AttributeReader& operator=(const AttributeReader&) = delete;

  /// Completes a split whose shape is known and which `mesh` does not hold yet. ring: slots of the
  /// canonical ring that `n` and `cut` are about.
  void read(
      const ActiveMesh& mesh,
      std::span<const Slot> ring,
      const split_syntax::Neighbourhood& n,
      const RingCut& cut,
      VertexSplit& split);

  /// False when the bytes cannot be a stream.
  [[nodiscard]] bool isValid() const { return kinds_ == 0 || bins_.isValid(); }

  /// True when every byte has been used.
  [[nodiscard]] bool isFinished() const { return kinds_ == 0 ? isEmpty_ : bins_.isFinished(); }

 private:
  std::uint8_t kinds_;
  bool isEmpty_;
  AdaptiveContexts contexts_;
  AdaptiveBinReader bins_;
};

}  // namespace limn
