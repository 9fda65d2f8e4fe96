// SPDX-License-Identifier: Apache-2.0
//
// A split model in bytes: the weights' differences from the universal ones as zigzag varints; the
// number of changed probabilities, each as the gap of its context and a byte; of models whose
// parents move, the weights of the moves like those before.
#include "shared/codec/split_model.h"

#include "shared/codec/default_model.h"
#include "shared/codec/split_syntax.h"
#include "shared/codec/varint.h"

#include <array>
#include <cstdlib>
#include <iterator>

namespace limn {
namespace {

using split_syntax::kContexts;

std::uint32_t zigzag(std::int32_t value) {
  return static_cast<std::uint32_t>(value) << 1 ^ static_cast<std::uint32_t>(value >> 31);
}

std::int64_t unzigzag(std::uint32_t value) {
  return (value & 1) != 0 ? -static_cast<std::int64_t>(value >> 1) - 1 : value >> 1;
}

constexpr std::int64_t kMaxWeight = 4096;

template <std::size_t N>
void appendWeights(
    const std::array<std::array<std::int16_t, N>, split_syntax::kWeightClasses>& weights,
    const std::array<std::array<std::int16_t, N>, split_syntax::kWeightClasses>& usual,
    std::vector<std::uint8_t>& bytes) {
  for (std::size_t c = 0; c < weights.size(); ++c) {
    for (std::size_t t = 0; t < N; ++t)
      appendVarint(zigzag(weights[c][t] - usual[c][t]), bytes);
  }
}

// weights: the universal ones, changed by what is read. False: damaged.
template <std::size_t N>
bool readWeights(
    VarintReader& in,
    std::array<std::array<std::int16_t, N>, split_syntax::kWeightClasses>& weights) {
  for (auto& row : weights) {
    for (std::int16_t& weight : row) {
      const auto difference = in.read();
      if (!difference) return false;
      const std::int64_t value = weight + unzigzag(*difference);
      if (std::abs(value) > kMaxWeight) return false;
      weight = static_cast<std::int16_t>(value);
    }
  }
  return true;
}

}  // namespace

const SplitModel& defaultSplitModel() {
  static const SplitModel kModel = [] {
    SplitModel model;
    model.weights = kDefaultWeights;
    model.probabilities.reserve(kContexts);
    for (std::size_t i = 0; i < std::size(kDefaultTable); ++i) {
      // A zero announces a run.
      const bool isRun = kDefaultTable[i] == 0;
      const std::size_t times = isRun ? kDefaultTable[i + 2] : 1;
      model.probabilities.insert(
          model.probabilities.end(),
          times,
          kDefaultTable[isRun ? i + 1 : i]);
      if (isRun) i += 2;
    }
    model.probabilities.resize(kContexts, 128);
    return model;
  }();
  return kModel;
}

std::vector<std::uint8_t> serializeSplitModel(const SplitModel& model) {
  const SplitModel& usual = defaultSplitModel();
  std::vector<std::uint8_t> bytes;
  appendWeights(model.weights, usual.weights, bytes);
  std::vector<std::uint32_t> changed;
  for (std::uint32_t i = 0; i < kContexts; ++i) {
    if (model.probabilities[i] != usual.probabilities[i]) changed.push_back(i);
  }
  appendVarint(changed.size(), bytes);
  std::uint32_t next = 0;
  for (const std::uint32_t i : changed) {
    appendVarint(i - next, bytes);
    bytes.push_back(model.probabilities[i]);
    next = i + 1;
  }
  if (model.placement == Placement::kVolume)
    appendWeights(model.moveWeights, usual.moveWeights, bytes);
  return bytes;
}

Result<SplitModel> parseSplitModel(std::span<const std::uint8_t> bytes, Placement placement) {
  const auto damagedModel = [] { return fail(ErrorCode::kCorrupt, "split model is damaged"); };
  SplitModel model = defaultSplitModel();
  model.placement = placement;
  VarintReader in(bytes);
  if (!readWeights(in, model.weights)) return damagedModel();
  const auto count = in.read();
  if (!count || *count > kContexts) return damagedModel();
  std::uint64_t next = 0;
  bytes = in.rest();
  for (std::uint32_t i = 0; i < *count; ++i) {
    VarintReader entry(bytes);
    const auto gap = entry.read();
    bytes = entry.rest();
    if (!gap || next + *gap >= kContexts || bytes.empty() || bytes.front() == 0)
      return damagedModel();
    model.probabilities[next + *gap] = bytes.front();
    next += *gap + 1;
    bytes = bytes.subspan(1);
  }
  if (placement == Placement::kVolume) {
    VarintReader rest(bytes);
    if (!readWeights(rest, model.moveWeights)) return damagedModel();
    bytes = rest.rest();
  }
  if (!bytes.empty()) return damagedModel();
  return model;
}

}  // namespace limn
