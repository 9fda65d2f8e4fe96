// SPDX-License-Identifier: Apache-2.0
//
// A run of splits: varint 2·count + (1: a level run), (level run: varint first id), then one rANS
// stream with, split by split, name, cut, features, position, move (split_syntax.h).
#include "shared/codec/split_codec.h"

#include "shared/codec/bin_coder.h"
#include "shared/codec/default_model.h"
#include "shared/codec/split_syntax.h"
#include "shared/codec/varint.h"
#include "shared/core/assert.h"

#include <cmath>
#include <iterator>
#include <string>

namespace limn {
namespace {

using split_syntax::kContexts;
using split_syntax::kMaxRing;
using split_syntax::NameState;
using split_syntax::Neighbourhood;

constexpr std::uint32_t kMaxRunSplits = 1U << 20;

tl::unexpected<Error> damaged(const char* what) {
  return fail(ErrorCode::kCorrupt, std::string("splits are damaged: ") + what);
}

// A split as it is coded, its name apart.
struct Shape {
  RingCut cut;
  std::uint8_t features = 0;
  glm::ivec3 position{0};
  glm::ivec3 parentMove{0};
};

// What follows a split's name. shape: in and out. Errors: only where the syntax is read.
template <class Bins>
Result<void> codeShape(Bins& bins, const Neighbourhood& n, const SplitModel& model, Shape& shape) {
  if (!split_syntax::codeCut(bins, n, shape.cut)) return damaged("no cut fits");
  shape.features = split_syntax::codeFeatures(bins, shape.features);
  const auto fan = split_syntax::fanOf(n, shape.cut);
  const auto prediction = split_syntax::predict(n, fan);
  split_syntax::codePosition(bins, n, prediction, model.weights, shape.position);
  if (!isOnGrid(shape.position)) return damaged("a position off the grid");
  // Vertices on a border never move.
  if (model.placement == Placement::kSubset || n.isPath) return {};
  if constexpr (requires { bins.beginMove(); }) bins.beginMove();
  split_syntax::codeMove(
      bins,
      n,
      fan,
      prediction,
      model.moveWeights,
      shape.position,
      shape.parentMove);
  return {};
}

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
  const auto coded = codeShape(bins, split_syntax::neighbourhoodOf(forest, v), model, shape);
  LIMN_ASSERT(coded);
  static_cast<void>(coded);
}

template <class Bins>
void encodeAnyRun(
    Bins& bins,
    const SplitForest& forest,
    const SplitModel& model,
    std::span<const VertexId> ids) {
  NameState names;
  for (const VertexId id : ids) {
    VertexId vertex = id;
    VertexId parent = forest.parent(id);
    split_syntax::codeName(bins, names, forest.levelBegin, vertex, parent);
    encodeShape(bins, forest, model, id);
  }
}

// The first vertex that can be the parent of `first` in a level run.
VertexId firstParent(const SplitForest& forest, VertexId first) {
  const bool startsLevel = forest.levelBegin[forest.levelOf(first)] == first;
  return startsLevel ? 0 : forest.parent(first - 1) + 1;
}

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
    next = split_syntax::codeParent(bins, front, next, forest.parent(v)) + 1;
    encodeShape(bins, forest, model, v);
  }
}

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
    encodeLevelRun(
        counter,
        forest,
        model,
        fronts[level],
        forest.levelBegin[level],
        forest.levelBegin[level + 1]);
  }
  for (const glm::vec3& toEye : {glm::vec3(0, 0, 1), glm::vec3(0.8F, 0.6F, 0)}) {
    encodeAnyRun(counter, forest, model, splitsOfView(forest, toEye));
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

std::vector<std::uint8_t>
encodeSplits(const SplitForest& forest, const SplitModel& model, std::span<const VertexId> ids) {
  LIMN_ASSERT(std::is_sorted(ids.begin(), ids.end()));
  std::vector<std::uint8_t> bytes;
  appendVarint(2 * ids.size(), bytes);
  BinWriter bins(model.probabilities);
  encodeAnyRun(bins, forest, model, ids);
  bins.finish(bytes);
  return bytes;
}

void modelSplit(
    const SplitForest& forest,
    const SplitModel& model,
    VertexId v,
    SplitSymbols& symbols) {
  encodeShape(symbols, forest, model, v);
}

std::vector<std::uint8_t> encodeLevelRun(
    const SplitForest& forest,
    const SplitModel& model,
    const LevelFronts& fronts,
    VertexId begin,
    VertexId end) {
  const std::uint32_t level = forest.levelOf(begin);
  LIMN_ASSERT(begin < end && end <= forest.levelBegin[level + 1]);
  std::vector<std::uint8_t> bytes;
  appendVarint(2 * (end - begin) + 1, bytes);
  appendVarint(begin, bytes);
  BinWriter bins(model.probabilities);
  encodeLevelRun(bins, forest, model, fronts[level], begin, end);
  bins.finish(bytes);
  return bytes;
}

std::optional<LevelRunHead> levelRunHead(std::span<const std::uint8_t> bytes) {
  VarintReader header(bytes);
  const auto counted = header.read();
  if (!counted || *counted % 2 == 0) return std::nullopt;
  const auto begin = header.read();
  if (!begin) return std::nullopt;
  return LevelRunHead{*begin, *counted / 2};
}

SplitBits measureLevelRun(
    const SplitForest& forest,
    const SplitModel& model,
    const LevelFronts& fronts,
    VertexId begin,
    VertexId end) {
  BitMeter meter(model.probabilities);
  encodeLevelRun(meter, forest, model, fronts[forest.levelOf(begin)], begin, end);
  return meter.bits();
}

Result<std::uint32_t> SplitDecoder::decode(
    std::span<const std::uint8_t> bytes,
    ActiveMesh& mesh,
    std::span<const std::uint8_t> attributes) {
  VarintReader header(bytes);
  const auto counted = header.read();
  if (!counted) return damaged("no count");
  const std::uint32_t count = *counted / 2;
  if (count > kMaxRunSplits) {
    return fail(ErrorCode::kLimitExceeded, "a run claims " + std::to_string(count) + " splits");
  }
  const bool isLevelRun = (*counted & 1) != 0;
  VertexId vertex = 0;      // of a level run: the next split's
  VertexId nextParent = 0;  // of a level run: the first vertex that may be its parent
  VertexId levelEnd = 0;
  if (isLevelRun) {
    const auto first = header.read();
    if (!first || *first < mesh.baseVertexCount() || *first >= mesh.levelBegin().back()) {
      return damaged("no first vertex");
    }
    vertex = *first;
    const std::uint32_t level = mesh.levelOf(vertex);
    levelEnd = mesh.levelBegin()[level + 1];
    if (vertex != mesh.levelBegin()[level]) {
      if (!mesh.holds(vertex - 1)) return damaged("a level run without what comes before");
      nextParent = mesh.parentOf(vertex - 1) + 1;
    }
    if (frontLevel_ != level) {
      frontLevel_ = 0;
      auto front = frontClasses(mesh, level);
      if (!front) return tl::unexpected(front.error());
      front_ = std::move(*front);
      frontLevel_ = level;
    }
  }
  BinReader bins(model_.probabilities, header.rest());
  AttributeReader attributeReader(attributeKinds_, attributes);
  if (!bins.isValid() || !attributeReader.isValid()) return damaged("no coded bits");

  NameState names;
  for (std::uint32_t i = 0; i < count; ++i) {
    VertexSplit split;
    if (isLevelRun) {
      if (vertex >= levelEnd) return damaged("more splits than its level has");
      split.vertex = vertex++;
      split.parent = split_syntax::codeParent(bins, front_, nextParent, kNone);
      if (split.parent == kNone) return damaged("a split without parent");
      nextParent = split.parent + 1;
    } else {
      split_syntax::codeName(bins, names, mesh.levelBegin(), split.vertex, split.parent);
      if (split.vertex < mesh.baseVertexCount() || split.vertex >= mesh.levelBegin().back()) {
        return damaged("a vertex that the model does not have");
      }
    }
    if (auto shaped = decodeShape(bins, attributeReader, mesh, split); !shaped) {
      return tl::unexpected(shaped.error());
    }
    if (auto applied = mesh.apply(split); !applied) return tl::unexpected(applied.error());
  }
  if (!bins.isFinished() || !attributeReader.isFinished())
    return damaged("bytes left over or missing");
  return count;
}

Result<void> SplitDecoder::decodeShape(
    BinReader& bins,
    AttributeReader& attributes,
    const ActiveMesh& mesh,
    VertexSplit& split) {
  const Slot u = mesh.slotOf(split.parent);
  if (u == kNone) return damaged("a parent that is not held");
  const std::uint32_t level = mesh.levelOf(split.vertex);
  const VertexId end = mesh.levelBegin()[level];
  mesh.canonicalRingSlots(u, level, ring_);
  if (ring_.size() > kMaxRing || ring_.size() < 2)
    return damaged("a parent with an impossible ring");
  Neighbourhood n;
  n.size = static_cast<std::uint32_t>(ring_.size());
  n.parent = mesh.positionIn(end, u);
  for (std::uint32_t k = 0; k < n.size; ++k)
    n.ring[k] = mesh.positionIn(end, ring_[k]) - n.parent;
  n.isPath = mesh.mesh().isBorderVertex(u);
  Shape shape;
  if (auto coded = codeShape(bins, n, model_, shape); !coded) return coded;
  const RingCut cut = shape.cut;
  split.left = cut.left == RingCut::kNoCut ? kNone : mesh.ids()[ring_[cut.left]];
  split.right = cut.right == RingCut::kNoCut ? kNone : mesh.ids()[ring_[cut.right]];
  split.features = shape.features;
  split.position = shape.position;
  split.parentMove = shape.parentMove;
  attributes.read(mesh, ring_, n, cut, split);
  return {};
}

}  // namespace limn
