// SPDX-License-Identifier: Apache-2.0
//
// A run of splits: varint 2·count + contiguous, (contiguous: varint first id), then one binary rANS
// stream with, split by split, name, cut, features, position (split_syntax.h).
#include "shared/codec/split_codec.h"

#include "shared/codec/bin_coder.h"
#include "shared/codec/split_syntax.h"
#include "shared/codec/varint.h"
#include "shared/core/assert.h"

#include <cmath>
#include <string>

namespace limn {
namespace {

using split_syntax::kContexts;
using split_syntax::kMaxRing;
using split_syntax::NameState;
using split_syntax::Neighbourhood;
using split_syntax::Weights;

constexpr std::uint32_t kMaxRunSplits = 1U << 20;

Neighbourhood neighbourhoodOf(const SplitForest& forest, VertexId v) {
  Neighbourhood n;
  const auto ring = forest.ring(v);
  n.parent = forest.positions[forest.parent(v)];
  n.size = static_cast<std::uint32_t>(std::min<std::size_t>(ring.size(), kMaxRing));
  for (std::uint32_t i = 0; i < n.size; ++i)
    n.ring[i] = forest.positions[ring[i]];
  n.isPath = (forest.features[v - forest.baseVertexCount()] & kSplitParentOnBorder) != 0;
  return n;
}

template <class Bins>
void encodeRun(
    Bins& bins,
    const SplitForest& forest,
    const Weights& weights,
    std::span<const VertexId> ids,
    bool contiguous) {
  NameState names;
  if (!ids.empty() && contiguous) names.nextId = ids.front();
  for (const VertexId id : ids) {
    const std::uint32_t s = id - forest.baseVertexCount();
    VertexId vertex = id;
    VertexId parent = forest.parents[s];
    split_syntax::codeName(bins, names, forest.levelBegin, contiguous, vertex, parent);
    const Neighbourhood n = neighbourhoodOf(forest, id);
    RingCut cut = forest.cuts[s];
    split_syntax::codeCut(bins, n, cut);
    split_syntax::codeFeatures(bins, forest.features[s]);
    glm::ivec3 position = forest.positions[id];
    split_syntax::codePosition(bins, n, split_syntax::predict(n, cut), weights, position);
  }
}

// Least squares over all splits of one fan length: which mix of the terms comes closest.
Weights fitWeights(const SplitForest& forest) {
  struct Normal {
    glm::dmat3 matrix{0.0};
    glm::dvec3 right{0.0};
  };

  std::array<Normal, split_syntax::kWeightClasses> systems;
  for (VertexId v = forest.baseVertexCount(); v < forest.vertexCount(); ++v) {
    const Neighbourhood n = neighbourhoodOf(forest, v);
    const auto p = split_syntax::predict(n, forest.cuts[v - forest.baseVertexCount()]);
    const glm::dvec3 wanted =
        16.0 * (glm::dvec3(forest.positions[v]) - glm::dvec3(n.parent)) - glm::dvec3(p.terms[0]);
    const double reach =
        std::exp2(p.scale / 2.0) * 16.0;  // so that large and small splits count alike
    Normal& system = systems[p.weightClass];
    for (int axis = 0; axis < 3; ++axis) {
      const glm::dvec3 row =
          glm::dvec3(p.terms[1][axis], p.terms[2][axis], p.terms[3][axis]) / reach;
      system.matrix += glm::outerProduct(row, row);
      system.right += row * (wanted[axis] / reach);
    }
  }
  Weights weights{};
  for (std::size_t c = 0; c < systems.size(); ++c) {
    glm::dmat3 matrix = systems[c].matrix;
    const double trace = matrix[0][0] + matrix[1][1] + matrix[2][2];
    if (trace <= 0.0) continue;
    for (int i = 0; i < 3; ++i)
      matrix[i][i] += 1e-6 * trace;  // keeps it regular
    const glm::dvec3 solution = glm::inverse(matrix) * systems[c].right;
    for (int i = 0; i < 3; ++i) {
      weights[c][static_cast<std::size_t>(i)] =
          static_cast<std::int16_t>(std::clamp(std::lround(256.0 * solution[i]), -2048L, 2047L));
    }
  }
  return weights;
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
    wanted[forest.parent(v)] = true;
    for (const VertexId w : forest.ring(v))
      wanted[w] = true;
  }
  std::vector<VertexId> ids;
  for (VertexId v = base; v < forest.vertexCount(); ++v) {
    if (wanted[v]) ids.push_back(v);
  }
  return ids;
}

}  // namespace

SplitModel trainSplitModel(const SplitForest& forest) {
  SplitModel model;
  model.weights = fitWeights(forest);
  BinCounter counter(kContexts);
  std::vector<VertexId> all(forest.splitCount());
  for (std::uint32_t s = 0; s < all.size(); ++s)
    all[s] = forest.baseVertexCount() + s;
  encodeRun(counter, forest, model.weights, all, true);
  for (const glm::vec3& toEye : {glm::vec3(0, 0, 1), glm::vec3(0.8F, 0.6F, 0)}) {
    encodeRun(counter, forest, model.weights, splitsOfView(forest, toEye), false);
  }
  model.probabilities = counter.probabilities();
  model.probabilities[split_syntax::kRaw] = 128;
  return model;
}

std::vector<std::uint8_t> serializeSplitModel(const SplitModel& model) {
  std::vector<std::uint8_t> bytes;
  for (const auto& row : model.weights) {
    for (const std::int16_t weight : row) {
      bytes.push_back(static_cast<std::uint8_t>(weight & 0xFF));
      bytes.push_back(static_cast<std::uint8_t>(weight >> 8 & 0xFF));
    }
  }
  // Runs of equal probabilities, since most contexts never occur on a given model.
  for (std::size_t i = 0; i < model.probabilities.size();) {
    std::size_t run = 1;
    while (i + run < model.probabilities.size() &&
           model.probabilities[i + run] == model.probabilities[i])
      ++run;
    bytes.push_back(model.probabilities[i]);
    if (run > 1) {
      // No probability is 0: a zero announces a run.
      bytes.back() = 0;
      bytes.push_back(model.probabilities[i]);
      appendVarint(run, bytes);
    }
    i += run;
  }
  return bytes;
}

Result<SplitModel> parseSplitModel(std::span<const std::uint8_t> bytes) {
  SplitModel model;
  const auto damaged = [] { return fail(ErrorCode::kCorrupt, "split model is damaged"); };
  constexpr std::size_t kWeightBytes = 2 * 3 * split_syntax::kWeightClasses;
  if (bytes.size() < kWeightBytes) return damaged();
  for (std::size_t i = 0; i < kWeightBytes / 2; ++i) {
    model.weights[i / 3][i % 3] = static_cast<std::int16_t>(bytes[2 * i] | bytes[2 * i + 1] << 8);
  }
  bytes = bytes.subspan(kWeightBytes);
  while (!bytes.empty()) {
    std::uint32_t run = 1;
    std::uint8_t probability = bytes.front();
    bytes = bytes.subspan(1);
    if (probability == 0) {
      if (bytes.empty()) return damaged();
      probability = bytes.front();
      VarintReader in(bytes.subspan(1));
      const auto count = in.read();
      if (!count || probability == 0) return damaged();
      run = *count;
      bytes = in.rest();
    }
    if (run > kContexts - model.probabilities.size()) return damaged();
    model.probabilities.insert(model.probabilities.end(), run, probability);
  }
  if (model.probabilities.size() != kContexts) return damaged();
  return model;
}

std::vector<std::uint8_t>
encodeSplits(const SplitForest& forest, const SplitModel& model, std::span<const VertexId> ids) {
  LIMN_ASSERT(std::is_sorted(ids.begin(), ids.end()));
  const bool contiguous = !ids.empty() && ids.back() - ids.front() + 1 == ids.size();
  std::vector<std::uint8_t> bytes;
  appendVarint(2 * ids.size() + (contiguous ? 1 : 0), bytes);
  if (contiguous) appendVarint(ids.front(), bytes);
  BinWriter bins(model.probabilities);
  encodeRun(bins, forest, model.weights, ids, contiguous);
  bins.finish(bytes);
  return bytes;
}

Result<std::uint32_t>
decodeSplits(std::span<const std::uint8_t> bytes, const SplitModel& model, ActiveMesh& mesh) {
  const auto damaged = [](const char* what) {
    return fail(ErrorCode::kCorrupt, std::string("splits are damaged: ") + what);
  };
  VarintReader header(bytes);
  const auto counted = header.read();
  if (!counted) return damaged("no count");
  const std::uint32_t count = *counted / 2;
  const bool contiguous = (*counted & 1) != 0;
  if (count > kMaxRunSplits) {
    return fail(ErrorCode::kLimitExceeded, "a run claims " + std::to_string(count) + " splits");
  }
  NameState names;
  if (contiguous) {
    const auto first = header.read();
    if (!first) return damaged("no first vertex");
    names.nextId = *first;
  }
  BinReader bins(model.probabilities, header.rest());
  if (!bins.isValid()) return damaged("no coded bits");

  std::vector<VertexId> ring;
  for (std::uint32_t i = 0; i < count; ++i) {
    VertexSplit split;
    split_syntax::codeName(bins, names, mesh.levelBegin(), contiguous, split.vertex, split.parent);
    if (split.vertex < mesh.baseVertexCount() || split.vertex >= mesh.levelBegin().back()) {
      return damaged("a vertex that the model does not have");
    }
    if (auto found = mesh.canonicalRing(split.parent, mesh.levelOf(split.vertex), ring); !found) {
      return tl::unexpected(found.error());
    }
    if (ring.size() > kMaxRing || ring.size() < 2)
      return damaged("a parent with an impossible ring");
    Neighbourhood n;
    n.size = static_cast<std::uint32_t>(ring.size());
    n.parent = mesh.positions()[mesh.slotOf(split.parent)];
    for (std::uint32_t k = 0; k < n.size; ++k)
      n.ring[k] = mesh.positions()[mesh.slotOf(ring[k])];
    n.isPath = mesh.mesh().isBorderVertex(mesh.slotOf(split.parent));
    RingCut cut;
    if (!split_syntax::codeCut(bins, n, cut)) return damaged("no cut fits");
    split.left = cut.left == RingCut::kNoCut ? kNone : ring[cut.left];
    split.right = cut.right == RingCut::kNoCut ? kNone : ring[cut.right];
    split.features = split_syntax::codeFeatures(bins, 0);
    split_syntax::codePosition(
        bins,
        n,
        split_syntax::predict(n, cut),
        model.weights,
        split.position);
    if (!isOnGrid(split.position)) return damaged("a position off the grid");
    if (auto applied = mesh.apply(split); !applied) return tl::unexpected(applied.error());
  }
  if (!bins.isFinished()) return damaged("bytes left over or missing");
  return count;
}

}  // namespace limn
