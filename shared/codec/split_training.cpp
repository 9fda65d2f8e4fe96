// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/split_training.h"

#include "shared/codec/bin_coder.h"
#include "shared/codec/split_codec.h"
#include "shared/codec/split_run.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace limn {
namespace {

using split_syntax::kContexts;
using split_syntax::Neighbourhood;

// Solves A x = b for a symmetric positive definite A, in place (Cholesky).
template <std::size_t N>
std::array<double, N> solve(std::array<std::array<double, N>, N>& a, std::array<double, N> x) {
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = a[i][j];
      for (std::size_t k = 0; k < j; ++k)
        sum -= a[i][k] * a[j][k];
      a[i][j] = i == j ? std::sqrt(sum) : sum / a[j][j];
    }
  }
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t k = 0; k < i; ++k)
      x[i] -= a[i][k] * x[k];
    x[i] /= a[i][i];
  }
  for (std::size_t i = N; i-- > 0;) {
    for (std::size_t k = i + 1; k < N; ++k)
      x[i] -= a[k][i] * x[k];
    x[i] /= a[i][i];
  }
  return x;
}

// Least squares over all splits of one fan length: which mix of N terms comes closest.
template <std::size_t N>
class WeightFit {
 public:
  /// wanted: offset, in grid units; start, terms: in 16ths.
  void add(
      const split_syntax::Prediction& p,
      const glm::ivec3& wanted,
      const split_syntax::Wide& start,
      const std::array<split_syntax::Wide, N>& terms) {
    // So that large and small splits count alike.
    const double scale = std::exp2(-p.reach8 / 8.0) / 16.0;
    Normal& system = systems_[p.weightClass];
    for (int axis = 0; axis < 3; ++axis) {
      const double missing = (16.0 * wanted[axis] - static_cast<double>(start[axis])) * scale;
      std::array<double, N> row;
      for (std::size_t t = 0; t < N; ++t)
        row[t] = static_cast<double>(terms[t][axis]) * scale;
      for (std::size_t i = 0; i < N; ++i) {
        for (std::size_t j = 0; j <= i; ++j)
          system.matrix[i][j] += row[i] * row[j];
        system.right[i] += row[i] * missing;
      }
    }
  }

  /// By fan length; of use once.
  std::array<std::array<std::int16_t, N>, split_syntax::kWeightClasses> weights() {
    std::array<std::array<std::int16_t, N>, split_syntax::kWeightClasses> weights{};
    for (std::size_t c = 0; c < systems_.size(); ++c) {
      double trace = 0.0;
      for (std::size_t i = 0; i < N; ++i)
        trace += systems_[c].matrix[i][i];
      if (trace <= 0.0) continue;
      for (std::size_t i = 0; i < N; ++i)
        systems_[c].matrix[i][i] += 1e-5 * trace;  // keeps it regular
      const auto solution = solve(systems_[c].matrix, systems_[c].right);
      for (std::size_t i = 0; i < N; ++i) {
        weights[c][i] =
            static_cast<std::int16_t>(std::clamp(std::lround(256.0 * solution[i]), -2048L, 2047L));
      }
    }
    return weights;
  }

 private:
  struct Normal {
    std::array<std::array<double, N>, N> matrix{};
    std::array<double, N> right{};
  };

  std::array<Normal, split_syntax::kWeightClasses> systems_;
};

// The weights that fit a forest; nothing else differs from the universal model.
SplitModel fittedModel(const SplitForest& forest) {
  SplitModel model = defaultSplitModel();
  model.placement = forest.placement();
  WeightFit<split_syntax::kTerms> positions;
  WeightFit<split_syntax::kMoveTerms> moves;
  for (VertexId v = forest.baseVertexCount(); v < forest.vertexCount(); ++v) {
    const VertexSplit split = forest.split(v);
    const Neighbourhood n = split_syntax::neighbourhoodOf(forest, v);
    const auto fan = split_syntax::fanOf(n, forest.cuts[v - forest.baseVertexCount()]);
    const auto p = split_syntax::predict(n, fan);
    positions.add(p, split.position - n.parent, p.fan, p.terms);
    if (split.parentMove == glm::ivec3(0)) continue;
    const auto move = split_syntax::predictMove(n, fan, p, split.position);
    moves.add(p, split.parentMove, split_syntax::Wide(0), move.terms);
  }
  model.weights = positions.weights();
  if (model.placement == Placement::kVolume) model.moveWeights = moves.weights();
  return model;
}

// What a view from `toEye` would ask for: splits whose normals can be seen edge-on, and their
// prerequisites. Names of such runs have gaps that whole levels do not have.
std::vector<VertexId> splitsOfView(const SplitForest& forest, const glm::vec3& toEye) {
  const std::uint32_t base = forest.baseVertexCount();
  std::vector<bool> wanted(forest.vertexCount(), false);
  for (VertexId v = forest.vertexCount(); v-- > base;) {
    const SplitBounds& bounds = forest.bounds[v - base];
    const float sine = std::abs(glm::dot(bounds.coneAxis, toEye));
    const float coneSine = std::sqrt(std::max(0.0F, 1.0F - bounds.coneCos * bounds.coneCos));
    if (bounds.coneCos <= 0.0F || sine <= coneSine) wanted[v] = true;
    if (!wanted[v]) continue;
    forest.forEachPrerequisite(v, [&](VertexId w) { wanted[w] = true; });
  }
  std::vector<VertexId> ids;
  for (VertexId v = base; v < forest.vertexCount(); ++v) {
    if (wanted[v]) ids.push_back(v);
  }
  return ids;
}

// Zeros and ones of each context over all levels and two views.
BinCounter
countBits(const SplitForest& forest, const LevelFronts& fronts, const SplitModel& model) {
  BinCounter counter(kContexts);
  for (std::uint32_t level = 1; level < forest.levelCount(); ++level) {
    split_syntax::encodeLevelRun(
        counter,
        forest,
        model,
        fronts[level],
        forest.levelBegin[level],
        forest.levelBegin[level + 1]);
  }
  for (const glm::vec3& toEye : {glm::vec3(0, 0, 1), glm::vec3(0.8F, 0.6F, 0)}) {
    split_syntax::encodeRun(counter, forest, model, splitsOfView(forest, toEye));
  }
  return counter;
}

// Probability of a zero as counted. One of each is assumed seen: a bit that never came on this
// model can still be coded.
Probability probabilityOf(const std::array<std::uint32_t, 2>& counts) {
  const double share = (counts[0] + 0.4) / (static_cast<double>(counts[0]) + counts[1] + 0.8);
  return static_cast<Probability>(std::clamp(std::lround(256.0 * share), 1L, 255L));
}

// Bits lost a bit coded while a context that should start from `own` starts from `other`.
double loss(Probability own, Probability other) {
  const double p = own / 256.0;
  const double q = other / 256.0;
  return p * std::log2(p / q) + (1.0 - p) * std::log2((1.0 - p) / (1.0 - q));
}

}  // namespace

SplitModel measureSplitModel(const SplitForest& forest, const LevelFronts& fronts) {
  SplitModel model = fittedModel(forest);
  const BinCounter counter = countBits(forest, fronts, model);
  for (std::uint32_t c = 0; c < kContexts; ++c)
    model.probabilities[c] = probabilityOf(counter.counts()[c]);
  return model;
}

SplitModel trainSplitModel(const SplitForest& forest, const LevelFronts& fronts) {
  // A run finds a context's probability by itself after some tens of bits, so the universal one is
  // replaced only where runs lose more until then than it takes to say so.
  constexpr double kBitsToLearn = 48.0;
  constexpr double kLeastGain = 64.0;
  SplitModel model = fittedModel(forest);
  const BinCounter counter = countBits(forest, fronts, model);
  const double runs = forest.levelCount() + forest.splitCount() / kLevelRunSplits;
  for (std::uint32_t c = 0; c < kContexts; ++c) {
    const auto& counts = counter.counts()[c];
    const Probability own = probabilityOf(counts);
    const double bits = std::min(static_cast<double>(counts[0]) + counts[1], kBitsToLearn * runs);
    if (bits * loss(own, model.probabilities[c]) > kLeastGain) model.probabilities[c] = own;
  }
  return model;
}

}  // namespace limn
