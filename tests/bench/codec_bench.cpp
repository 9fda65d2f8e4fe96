// SPDX-License-Identifier: Apache-2.0
//
// The split codec on one core: bits a split in whole levels and in packets of a view, splits
// decoded and applied a second, faces trained on and encoded a second. One line of JSON a mesh and
// grid.
//   limn-codec-bench BITS MODEL-FILE...
#include "server/preprocess/build_forest.h"
#include "server/preprocess/import.h"
#include "server/preprocess/repair.h"

#include "shared/codec/split_codec.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <span>
#include <vector>

namespace limn {
namespace {

constexpr std::uint32_t kRunSplits = 4096;  // as prepared assets have them
constexpr std::uint32_t kPacketSplits = 2500;
constexpr int kRounds = 5;

// Of this thread: other work on the machine does not count.
double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

using Runs = std::vector<std::vector<std::uint8_t>>;

ActiveMesh baseOf(const SplitForest& forest) {
  TriangleMesh base{forest.grid, {}, forest.baseTriangles};
  base.positions.assign(
      forest.positions.begin(),
      forest.positions.begin() + forest.baseVertexCount());
  return *ActiveMesh::fromBase(forest.levelBegin, base, forest.baseFeatures);
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
    const double begin = cpuSeconds();
    for (const auto& run : runs) {
      if (!decoder.decode(run, mesh)) return -1.0;
    }
    best = std::min(best, cpuSeconds() - begin);
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
    wanted[std::max({t.x, t.y, t.z})] = true;
  }
  for (VertexId v = forest.vertexCount(); v-- > base;) {
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

bool benchMesh(const char* file, int bits) {
  const auto imported = importMesh(file);
  if (!imported) return false;
  const auto repaired = repairMesh(*imported, {.quantizationBits = bits});
  if (!repaired) return false;
  const auto built = buildForest(repaired->mesh, {});
  if (!built) return false;
  const SplitForest& forest = built->forest;

  const double begin = cpuSeconds();
  const LevelFronts fronts = frontsOf(forest);
  const SplitModel model = trainSplitModel(forest, fronts);
  Runs levels;
  for (std::uint32_t level = 1; level < forest.levelCount(); ++level) {
    const VertexId end = forest.levelBegin[level + 1];
    for (VertexId v = forest.levelBegin[level]; v < end; v += kRunSplits) {
      levels.push_back(encodeLevelRun(forest, model, fronts, v, std::min(v + kRunSplits, end)));
    }
  }
  const double encode = cpuSeconds() - begin;
  Runs packets;
  const std::vector<VertexId> ids = splitsOfView(forest);
  const std::span<const VertexId> view(ids);
  for (std::size_t i = 0; i < view.size(); i += kPacketSplits)
    packets.push_back(encodeSplits(
        forest,
        model,
        view.subspan(i, std::min<std::size_t>(kPacketSplits, view.size() - i))));
  const double splits = forest.splitCount();
  const auto viewed = static_cast<double>(std::max<std::size_t>(ids.size(), 1));
  const double decodeLevels = secondsToDecode(forest, model, levels);
  const double decodePackets = secondsToDecode(forest, model, packets);
  if (decodeLevels < 0.0 || decodePackets < 0.0) return false;
  std::printf(
      "{\"mesh\": \"%s\", \"bits\": %d, \"splits\": %u, \"model_bytes\": %zu, "
      "\"level_bits_per_split\": %.3f, \"view_splits\": %zu, \"view_bits_per_split\": %.3f, "
      "\"encode_faces_per_s\": %.0f, \"decode_splits_per_s\": %.0f, "
      "\"decode_view_splits_per_s\": %.0f}\n",
      std::filesystem::path(file).stem().c_str(),
      bits,
      forest.splitCount(),
      serializeSplitModel(model).size(),
      8.0 * static_cast<double>(bytesOf(levels)) / splits,
      ids.size(),
      8.0 * static_cast<double>(bytesOf(packets)) / viewed,
      static_cast<double>(forest.triangles.size()) / encode,
      splits / decodeLevels,
      viewed / decodePackets);
  return true;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
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
