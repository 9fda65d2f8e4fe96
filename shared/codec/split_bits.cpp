// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/split_bits.h"

#include "shared/codec/bin_coder.h"
#include "shared/codec/split_run.h"

#include <cmath>
#include <span>
#include <vector>

namespace limn {
namespace {

/// The end of the syntax that weighs: see bin_coder.h.
class BitMeter {
 public:
  explicit BitMeter(std::span<const Probability> table) : states_(table.begin(), table.end()) {}

  bool code(std::uint32_t context, bool bit) {
    AdaptiveBit& state = states_[context];
    const std::uint32_t zero = state.zero();
    if (context < split_syntax::kResidual) {
      kind_ = kindOf(context);
      ofResiduals_ = &SplitBits::positions;
    } else {
      kind_ = ofResiduals_;
    }
    bits_.*kind_ -= std::log2((bit ? 4096 - zero : zero) / 4096.0);
    state.update(bit);
    return bit;
  }

  /// Raw bits belong to the symbol that a context began.
  std::uint32_t codeRaw(std::uint32_t bits, std::uint32_t value) {
    bits_.*kind_ += bits;
    return value;
  }

  /// What residuals follow are of the parent's move.
  void beginMove() { ofResiduals_ = &SplitBits::moves; }

  [[nodiscard]] const SplitBits& bits() const { return bits_; }

 private:
  static double SplitBits::*kindOf(std::uint32_t context) {
    if (context < split_syntax::kOpenSide) return &SplitBits::names;
    if (context < split_syntax::kFeatures) return &SplitBits::cuts;
    return &SplitBits::features;
  }

  std::vector<AdaptiveBit> states_;
  SplitBits bits_;
  double SplitBits::*kind_ = &SplitBits::names;
  double SplitBits::*ofResiduals_ = &SplitBits::positions;
};

}  // namespace

SplitBits measureLevelRun(
    const SplitForest& forest,
    const SplitModel& model,
    const LevelFronts& fronts,
    VertexId begin,
    VertexId end) {
  BitMeter meter(model.probabilities);
  split_syntax::encodeLevelRun(meter, forest, model, fronts[forest.levelOf(begin)], begin, end);
  return meter.bits();
}

}  // namespace limn
