// SPDX-License-Identifier: Apache-2.0
//
// The split codec on one core: bits a split in whole levels and in packets of a view, splits
// decoded and applied a second, faces trained on and encoded a second, and what coding packets
// costs a split: anew (encodeSplits), the first time (PacketEncoder), and from then on; and what
// attributes cost, where a model has them. One line of JSON a mesh and grid.
//   limn-codec-bench BITS MODEL-FILE...
// Or the universal split model (shared/codec/default_model.h), the mean over meshes and grids:
//   limn-codec-bench table MODEL-FILE...
#include "server/preprocess/forest/build_forest.h"
#include "server/preprocess/import/import.h"
#include "server/preprocess/repair/repair.h"
#include "tests/bench/measure.h"

#include "shared/codec/attribute_codec.h"
#include "shared/codec/draco_codec.h"
#include "shared/codec/packet_encoder.h"
#include "shared/codec/split_codec.h"
#include "shared/codec/split_training.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr std::uint32_t kRunSplits = 4096;  // as prepared assets have them
constexpr std::uint32_t kPacketSplits = 2500;
constexpr int kRounds = 5;

using Runs = std::vector<std::vector<std::uint8_t>>;

ActiveMesh baseOf(const SplitForest& forest) {
  return *ActiveMesh::fromBase(forest.levelBegin, forest.baseMesh(), forest.baseFeatures);
}

std::size_t bytesOf(const Runs& runs) {
  std::size_t sum = 0;
  for (const auto& run : runs)
    sum += run.size();
  return sum;
}

// The fastest of some rounds; negative when something does not decode.
double secondsToDecode(const SplitForest& forest, const SplitModel& model, const Runs& runs) {
  double best = 1e30;
  for (int round = 0; round < kRounds; ++round) {
    ActiveMesh mesh = baseOf(forest);
    SplitDecoder decoder(model);
    const double begin = threadCpuMs();
    for (const auto& run : runs) {
      if (!decoder.decode(run, mesh)) return -1.0;
    }
    best = std::min(best, 1e-3 * (threadCpuMs() - begin));
  }
  return best;
}

// Both faces of each edge that is a contour from far away in one direction, and what they need.
std::vector<VertexId> splitsOfView(const SplitForest& forest) {
  const glm::dvec3 toEye = glm::normalize(glm::dvec3(0.5, 0.26, 0.83));
  const auto full = HalfEdgeMesh::build(forest.vertexCount(), forest.triangles);
  std::vector<bool> front;
  for (const glm::uvec3& t : forest.triangles) {
    const glm::dvec3 a(forest.positions[t.x]);
    const glm::dvec3 normal =
        glm::cross(glm::dvec3(forest.positions[t.y]) - a, glm::dvec3(forest.positions[t.z]) - a);
    front.push_back(glm::dot(normal, toEye) > 0.0);
  }
  const std::uint32_t base = forest.baseVertexCount();
  std::vector<bool> wanted(forest.vertexCount(), false);
  for (HalfEdgeId h = 0; h < full->twins.size(); ++h) {
    const HalfEdgeId twin = full->twins[h];
    if (twin == kNone || front[HalfEdgeMesh::face(h)] == front[HalfEdgeMesh::face(twin)]) continue;
    const glm::uvec3& t = forest.triangles[HalfEdgeMesh::face(h)];
    forest.forEachSplitOfFace(t, [&](VertexId v) { wanted[v] = true; });
  }
  for (VertexId v = forest.vertexCount(); v-- > base;) {
    if (!wanted[v]) continue;
    forest.forEachPrerequisite(v, [&](VertexId w) { wanted[w] = true; });
  }
  std::vector<VertexId> ids;
  for (VertexId v = base; v < forest.vertexCount(); ++v) {
    if (wanted[v]) ids.push_back(v);
  }
  return ids;
}

// Codes ids in packets.
template <class Encode>
double secondsToEncode(std::span<const VertexId> ids, Runs& packets, const Encode& encode) {
  packets.clear();
  const double begin = threadCpuMs();
  for (; !ids.empty(); ids = ids.subspan(std::min<std::size_t>(kPacketSplits, ids.size())))
    packets.push_back(encode(ids.first(std::min<std::size_t>(kPacketSplits, ids.size()))));
  return 1e-3 * (threadCpuMs() - begin);
}

std::optional<BuiltForest> prepare(const char* file, int bits) {
  const auto imported = importMesh(file);
  if (!imported) return std::nullopt;
  const auto repaired = repairMesh(*imported, {.quantizationBits = bits});
  if (!repaired) return std::nullopt;
  auto built = buildForest(repaired->mesh, {}, repaired->seams);
  if (!built) return std::nullopt;
  return std::move(*built);
}

// Means of log odds over the meshes where a context occurs, as C++.
bool printTable(std::span<char* const> files) {
  std::vector<double> logOdds(split_syntax::kContexts, 0.0);
  std::vector<double> times(split_syntax::kContexts, 0.0);
  std::array<std::array<double, split_syntax::kTerms>, split_syntax::kWeightClasses> weights{};
  double models = 0.0;
  for (const char* file : files) {
    for (const int bits : {12, 14, 17}) {
      const auto built = prepare(file, bits);
      if (!built) return false;
      const SplitModel model = measureSplitModel(built->forest, frontsOf(built->forest));
      for (std::size_t c = 0; c < logOdds.size(); ++c) {
        const double zero = model.probabilities[c] / 256.0;
        if (model.probabilities[c] == 128) continue;  // never seen, or even
        logOdds[c] += std::log(zero / (1.0 - zero));
        times[c] += 1.0;
      }
      for (std::size_t i = 0; i < weights.size(); ++i) {
        for (std::size_t t = 0; t < split_syntax::kTerms; ++t)
          weights[i][t] += model.weights[i][t];
      }
      models += 1.0;
    }
  }
  std::printf("inline constexpr split_syntax::Weights kDefaultWeights = {{\n");
  for (const auto& row : weights) {
    std::printf("    {");
    for (std::size_t t = 0; t < row.size(); ++t)
      std::printf("%s%ld", t == 0 ? "" : ", ", std::lround(row[t] / models));
    std::printf("},\n");
  }
  std::printf("}};\ninline constexpr std::uint8_t kDefaultTable[] = {");
  std::vector<int> table;
  for (std::size_t c = 0; c < logOdds.size(); ++c) {
    const double mean = times[c] == 0.0 ? 0.0 : logOdds[c] / times[c];
    table.push_back(
        std::clamp(static_cast<int>(std::lround(256.0 / (1.0 + std::exp(-mean)))), 1, 255));
  }
  // Runs: 0, the probability, how often.
  std::size_t printed = 0;
  const auto print = [&](int value) {
    std::printf("%s%d,", printed++ % 24 == 0 ? "\n    " : " ", value);
  };
  for (std::size_t c = 0; c < table.size();) {
    std::size_t run = 1;
    while (c + run < table.size() && table[c + run] == table[c] && run < 255)
      ++run;
    if (run > 2) {
      print(0);
      print(table[c]);
      print(static_cast<int>(run));
    } else {
      run = 1;
      print(table[c]);
    }
    c += run;
  }
  std::printf("\n};\n");
  return true;
}

// What colours, normals and seams cost, by level; Draco's are what its file of the whole mesh grows
// by (it has no seams).
void printAttributes(const SplitForest& forest) {
  double bytes = 0.0;
  for (std::uint32_t level = 1; level < forest.levelCount(); ++level) {
    const VertexId end = forest.levelBegin[level + 1];
    for (VertexId v = forest.levelBegin[level]; v < end; v += kRunSplits)
      bytes +=
          static_cast<double>(encodeAttributes(forest, v, std::min(v + kRunSplits, end)).size());
  }
  TriangleMesh mesh{forest.grid, forest.positions, forest.triangles};
  const auto bare = encodeDraco(mesh);
  mesh.attributes = forest.attributes;
  const auto whole = encodeDraco(mesh);
  if (!bare || !whole) return;
  const auto more = static_cast<double>(whole->bytes.size() - bare->bytes.size());
  std::printf(
      "\"attribute_bits_per_split\": %.3f, \"draco_attribute_bits_per_vertex\": %.3f, ",
      8.0 * bytes / forest.splitCount(),
      8.0 * more / forest.vertexCount());
}

bool benchMesh(const char* file, int bits) {
  const auto built = prepare(file, bits);
  if (!built) return false;
  const SplitForest& forest = built->forest;

  const double begin = threadCpuMs();
  const LevelFronts fronts = frontsOf(forest);
  const SplitModel model = trainSplitModel(forest, fronts);
  Runs levels;
  for (std::uint32_t level = 1; level < forest.levelCount(); ++level) {
    const VertexId end = forest.levelBegin[level + 1];
    for (VertexId v = forest.levelBegin[level]; v < end; v += kRunSplits) {
      levels.push_back(encodeLevelRun(forest, model, fronts, v, std::min(v + kRunSplits, end)));
    }
  }
  const double encode = 1e-3 * (threadCpuMs() - begin);
  const std::vector<VertexId> ids = splitsOfView(forest);
  Runs packets;
  const double anew = secondsToEncode(ids, packets, [&](std::span<const VertexId> some) {
    return encodeSplits(forest, model, some);
  });
  PacketEncoder encoder(forest, model);
  Runs same;
  const auto encodeKnown = [&](std::span<const VertexId> some) { return encoder.encode(some); };
  const double first = secondsToEncode(ids, same, encodeKnown);
  if (same != packets) return false;
  double known = 1e30;
  for (int round = 0; round < kRounds; ++round)
    known = std::min(known, secondsToEncode(ids, same, encodeKnown));
  const double splits = forest.splitCount();
  const auto viewed = static_cast<double>(std::max<std::size_t>(ids.size(), 1));
  const double decodeLevels = secondsToDecode(forest, model, levels);
  const double decodePackets = secondsToDecode(forest, model, packets);
  if (decodeLevels < 0.0 || decodePackets < 0.0) return false;
  std::printf("{\"mesh\": \"%s\", ", std::filesystem::path(file).stem().c_str());
  if (forest.attributeKinds() != 0) printAttributes(forest);
  std::printf(
      "\"bits\": %d, \"splits\": %u, \"model_bytes\": %zu, "
      "\"level_bits_per_split\": %.3f, \"view_splits\": %zu, \"view_bits_per_split\": %.3f, "
      "\"encode_faces_per_s\": %.0f, \"packet_ns_per_split\": [%.0f, %.0f, %.0f], "
      "\"decode_splits_per_s\": %.0f, "
      "\"decode_view_splits_per_s\": %.0f}\n",
      bits,
      forest.splitCount(),
      serializeSplitModel(model).size(),
      8.0 * static_cast<double>(bytesOf(levels)) / splits,
      ids.size(),
      8.0 * static_cast<double>(bytesOf(packets)) / viewed,
      static_cast<double>(forest.triangles.size()) / encode,
      1e9 * anew / viewed,
      1e9 * first / viewed,
      1e9 * known / viewed,
      splits / decodeLevels,
      viewed / decodePackets);
  return true;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  if (argc > 2 && std::strcmp(argv[1], "table") == 0) {
    return limn::printTable({argv + 2, argv + argc}) ? 0 : 1;
  }
  const int bits = argc > 2 ? std::atoi(argv[1]) : 0;
  if (bits < 11 || bits > 18) {
    std::fprintf(stderr, "usage: limn-codec-bench BITS MODEL-FILE...   (11 to 18 bits)\n");
    return 2;
  }
  for (int i = 2; i < argc; ++i) {
    if (!limn::benchMesh(argv[i], bits)) {
      std::fprintf(stderr, "limn-codec-bench: %s cannot be prepared and decoded\n", argv[i]);
      return 1;
    }
  }
  return 0;
}
