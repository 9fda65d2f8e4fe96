// SPDX-License-Identifier: Apache-2.0
// Simplification measured: every collapse cost of ours beside OpenMesh, CGAL and meshoptimizer on
// the same mesh at the same face counts, and what each of ours makes of the stream. Prints one JSON
// object a line. One thread.
#include "server/preprocess/asset_sections.h"
#include "server/preprocess/import/import.h"
#include "server/preprocess/repair/repair.h"
#include "tests/bench/contour_error.h"
#include "tests/bench/measure.h"
#include "tests/bench/mesh_error.h"
#include "tests/bench/reference_simplifiers.h"

#include "shared/codec/draco_codec.h"
#include "shared/codec/front_classes.h"
#include "shared/codec/split_bits.h"
#include "shared/codec/split_codec.h"
#include "shared/codec/split_training.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <string>
#include <vector>

namespace limn::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string file;
  int bits = 12;
  std::uint32_t views = 40;
  std::uint32_t size = 1024;
  std::uint32_t samples = 20000;
  std::uint32_t baseFaces = 800;
  bool references = true;
  bool rates = true;
  std::string cost;                          // only this one; empty: all
  std::string placement;                     // only this one; empty: both
  std::vector<double> shares = {0.1, 0.03};  // of the faces
};

PlainMesh plain(const TriangleMesh& mesh) {
  PlainMesh result;
  result.positions.assign(mesh.positions.begin(), mesh.positions.end());
  result.triangles = mesh.triangles;
  return result;
}

// The mesh of the first `vertices` ids: half-edge collapses only rename corners.
TriangleMesh cutAt(const SplitForest& forest, std::uint32_t vertices) {
  std::vector<VertexId> ancestor(forest.vertexCount());
  for (VertexId v = 0; v < ancestor.size(); ++v)
    ancestor[v] = v < vertices ? v : ancestor[forest.parent(v)];
  TriangleMesh mesh{forest.grid, {}, {}};
  for (VertexId v = 0; v < vertices; ++v)
    mesh.positions.push_back(forest.positionIn(vertices, v));
  for (const glm::uvec3& t : forest.triangles) {
    const glm::uvec3 mapped(ancestor[t.x], ancestor[t.y], ancestor[t.z]);
    if (mapped.x != mapped.y && mapped.y != mapped.z && mapped.z != mapped.x)
      mesh.triangles.push_back(mapped);
  }
  return mesh;
}

std::size_t dracoBytes(const TriangleMesh& mesh) {
  constexpr int kSpeed = 3;  // draco_encoder -cl 7
  const auto coded = encodeDraco(mesh, kSpeed);
  return coded ? coded->bytes.size() : 0;
}

// Bytes until `exact` (edges): both full faces of every silhouette edge, hidden ones included.
class ExactCost {
 public:
  ExactCost(const SplitForest& forest, std::uint32_t views) : forest_(forest) {
    mesh_ = *HalfEdgeMesh::build(forest.vertexCount(), forest.triangles);
    glm::dvec3 low(1e300);
    glm::dvec3 high(-1e300);
    for (const glm::ivec3& p : forest.positions) {
      low = glm::min(low, glm::dvec3(p));
      high = glm::max(high, glm::dvec3(p));
    }
    const glm::dvec3 centre = 0.5 * (low + high);
    double radius = 0.0;
    for (const glm::ivec3& p : forest.positions)
      radius = std::max(radius, glm::distance(centre, glm::dvec3(p)));
    for (std::uint32_t i = 0; i < views; ++i) {
      const double z = 1.0 - (2.0 * i + 1.0) / views;
      const double turn = i * 2.399963229728653;
      const double flat = std::sqrt(1.0 - z * z);
      eyes_.push_back(
          centre + 3.0 * radius * glm::dvec3(flat * std::cos(turn), flat * std::sin(turn), z));
    }
  }

  // Shares of the splits needed, and bytes beyond the level blocks.
  Json measure(const SplitModel& model, VertexId blockEnd) const {
    double own = 0.0;
    double fan = 0.0;
    double ring = 0.0;
    double bytes = 0.0;
    double beyond = 0.0;
    for (const glm::dvec3& eye : eyes_) {
      std::vector<std::uint8_t> needed = neededSplits(eye);
      own += countOf(needed);
      fan += countOf(closed(needed, false));
      const auto closure = closed(needed, true);
      ring += countOf(closure);
      std::vector<VertexId> ids;
      for (VertexId v = std::max(blockEnd, forest_.baseVertexCount()); v < closure.size(); ++v) {
        if (closure[v] != 0) ids.push_back(v);
      }
      beyond += static_cast<double>(ids.size());
      for (std::size_t begin = 0; begin < ids.size(); begin += 4096) {
        const std::size_t count = std::min<std::size_t>(4096, ids.size() - begin);
        bytes += static_cast<double>(
            encodeSplits(forest_, model, std::span(ids).subspan(begin, count)).size());
      }
    }
    const double views = static_cast<double>(eyes_.size());
    const double splits = forest_.splitCount() * views;
    return {
        {"needed", own / splits},
        {"closure_fan", fan / splits},
        {"closure_ring", ring / splits},
        {"packet_bytes", bytes / views},
        {"bits_per_split", beyond == 0.0 ? 0.0 : 8.0 * bytes / beyond}};
  }

 private:
  double countOf(const std::vector<std::uint8_t>& set) const {
    return static_cast<double>(
        std::count(set.begin() + forest_.baseVertexCount(), set.end(), std::uint8_t{1}));
  }

  std::vector<std::uint8_t> neededSplits(const glm::dvec3& eye) const {
    std::vector<bool> isFront;
    for (const glm::uvec3& t : forest_.triangles) {
      const glm::dvec3 a(forest_.positions[t.x]);
      const glm::dvec3 normal = glm::cross(
          glm::dvec3(forest_.positions[t.y]) - a,
          glm::dvec3(forest_.positions[t.z]) - a);
      isFront.push_back(glm::dot(normal, eye - a) > 0.0);
    }
    std::vector<std::uint8_t> needed(forest_.vertexCount(), 0);
    for (HalfEdgeId h = 0; h < mesh_.twins.size(); ++h) {
      if (mesh_.twins[h] == kNone) continue;
      const FaceId f = HalfEdgeMesh::face(h);
      if (isFront[f] == isFront[HalfEdgeMesh::face(mesh_.twins[h])]) continue;
      forest_.forEachSplitOfFace(forest_.triangles[f], [&](VertexId v) { needed[v] = 1; });
    }
    return needed;
  }

  // wholeRing: prerequisites of rule RING; else u, l and r only, a lower bound.
  std::vector<std::uint8_t> closed(std::vector<std::uint8_t> set, bool wholeRing) const {
    for (VertexId v = forest_.vertexCount(); v-- > forest_.baseVertexCount();) {
      if (set[v] == 0) continue;
      set[forest_.parent(v)] = 1;
      if (wholeRing) {
        forest_.forEachPrerequisite(v, [&](VertexId w) { set[w] = 1; });
      } else {
        const auto ring = forest_.ring(v);
        const RingCut cut = forest_.cuts[v - forest_.baseVertexCount()];
        const std::size_t first = cut.left == RingCut::kNoCut ? 0 : cut.left;
        const std::size_t last = cut.right == RingCut::kNoCut ? ring.size() - 1 : cut.right;
        for (std::size_t i = first;; i = (i + 1) % ring.size()) {
          set[ring[i]] = 1;
          if (i == last) break;
        }
      }
    }
    return set;
  }

  const SplitForest& forest_;
  HalfEdgeMesh mesh_;
  std::vector<glm::dvec3> eyes_;
};

class Bench {
 public:
  Bench(const Options& options, TriangleMesh full)
      : options_(options),
        full_(std::move(full)),
        fullPlain_(plain(full_)),
        diagonal_(diagonal(fullPlain_)),
        volume_(volume(fullPlain_)),
        contours_(fullPlain_, options.views, options.size),
        fullDraco_(dracoBytes(full_)) {}

  void run(const std::vector<std::pair<std::string, ForestOptions>>& ours) {
    bool first = true;
    for (const auto& [name, forestOptions] : ours) {
      const auto counts = measureOurs(name, forestOptions);
      if (first && options_.references) {
        for (const std::size_t faces : counts)
          measureReferences(faces);
      }
      first = false;
    }
  }

 private:
  Json row(const char* kind, const std::string& method) const {
    return {{"kind", kind}, {"mesh", options_.file}, {"method", method}};
  }

  void print(const Json& json) const {
    std::printf("%s\n", json.dump().c_str());
    std::fflush(stdout);
  }

  // Errors of surfaces in 1e-5 of the diagonal, of contours in pixels.
  void addErrors(Json& json, const PlainMesh& mesh) const {
    const SurfaceError surface = surfaceError(fullPlain_, mesh, options_.samples);
    const double unit = 1e5 / diagonal_;
    json["mean"] = surface.mean * unit;
    json["rms"] = surface.rms * unit;
    json["max"] = surface.max * unit;
    json["volume"] = volume_ == 0.0 ? 0.0 : volume(mesh) / volume_ - 1.0;
    const ContourError contour = contours_.compare(mesh);
    json["contour_mean"] = contour.mean;
    json["contour_rms"] = contour.rms;
    json["contour_p95"] = contour.p95;
  }

  std::vector<std::size_t> measureOurs(const std::string& name, const ForestOptions& options) {
    const double start = processCpuMs();
    const auto built = buildForest(full_, options);
    const double build = 1e-3 * (processCpuMs() - start);
    if (!built) {
      std::fprintf(stderr, "%s: %s\n", options_.file.c_str(), built.error().message.c_str());
      std::exit(1);
    }
    const WireSections wire = encodeWireSections(*built, {}, {});
    const double encode = 1e-3 * (processCpuMs() - start) - build;
    const SplitForest& forest = built->forest;
    const auto bytes = std::accumulate(wire.levelBytes.begin(), wire.levelBytes.end(), 0ULL);

    Json whole = row("stream", name);
    whole["faces_per_second"] = static_cast<double>(full_.triangles.size()) / (build + encode);
    whole["build_faces_per_second"] = static_cast<double>(full_.triangles.size()) / build;
    whole["levels"] = forest.levelCount();
    whole["base_faces"] = forest.baseTriangles.size();
    whole["base_vertices"] = forest.baseVertexCount();
    whole["bytes"] = bytes;
    whole["draco_ratio"] = static_cast<double>(bytes) / static_cast<double>(fullDraco_);
    Json levelFaces = Json::array();
    for (const LevelSummary& level : built->levels)
      levelFaces.push_back(level.faces);
    whole["level_faces"] = std::move(levelFaces);
    whole["ring"] = static_cast<double>(forest.rings.size()) / forest.splitCount();
    SplitBits bits;
    const LevelFronts fronts = frontsOf(forest);
    const SplitModel model = trainSplitModel(forest, fronts);
    for (std::uint32_t level = 1; level < forest.levelCount(); ++level) {
      bits += measureLevelRun(
          forest,
          model,
          fronts,
          forest.levelBegin[level],
          forest.levelBegin[level + 1]);
    }
    const auto each = [&](double sum) { return sum / forest.splitCount(); };
    whole["bits"] = {
        {"names", each(bits.names)},
        {"cuts", each(bits.cuts)},
        {"positions", each(bits.positions)},
        {"moves", each(bits.moves)}};
    whole["moved"] = each(
        static_cast<double>(forest.moves.by.size()) -
        static_cast<double>(std::ranges::count(forest.moves.by, glm::ivec3(0))));

    std::uint32_t blockLevels = 0;
    for (std::uint64_t at = 0; at < wireBytes(wire.blocks); ++blockLevels)
      at += wire.levelBytes[blockLevels + 1];
    const ExactCost exact(forest, 20);
    const Json cost = exact.measure(model, forest.levelBegin[blockLevels + 1]);
    whole.update(cost);
    whole["exact_ratio"] = (cost["packet_bytes"].get<double>() +
                            static_cast<double>(wireBytes(wire.base) + wireBytes(wire.blocks))) /
                           static_cast<double>(fullDraco_);
    print(whole);

    // The level nearest to each share of the faces, measured as it stands.
    std::vector<std::size_t> counts;
    for (const double share : options_.shares) {
      const double wanted = share * static_cast<double>(full_.triangles.size());
      std::uint32_t best = 0;
      const auto offBy = [&](std::uint32_t level) {
        return std::abs(std::log(built->levels[level].faces / wanted));
      };
      for (std::uint32_t level = 1; level < forest.levelCount(); ++level) {
        if (offBy(level) < offBy(best)) best = level;
      }
      measureCut(name, forest, wire, best);
      counts.push_back(built->levels[best].faces);
    }
    if (options_.rates) measureRates(name, forest, wire);
    return counts;
  }

  // Contour error at shares of Draco's bytes for the whole mesh, between levels as lines in
  // logarithms of both.
  void measureRates(const std::string& name, const SplitForest& forest, const WireSections& wire) {
    constexpr std::array<double, 4> kShares = {0.06, 0.12, 0.25, 0.5};
    Json json = row("rates", name);
    std::size_t next = 0;
    double bytes = 0.0;
    double bytesBefore = 0.0;
    double errorBefore = 0.0;
    for (std::uint32_t level = 0; level + 1 < forest.levelCount() && next < kShares.size();
         ++level) {
      bytes += static_cast<double>(wire.levelBytes[level]);
      const double share = bytes / static_cast<double>(fullDraco_);
      const double share1 =
          share + static_cast<double>(wire.levelBytes[level + 1]) / static_cast<double>(fullDraco_);
      if (share1 < kShares[0]) continue;
      const double error =
          contours_.compare(plain(cutAt(forest, forest.levelBegin[level + 1]))).mean;
      for (; next < kShares.size() && share >= kShares[next]; ++next) {
        const double wanted = std::log(kShares[next]);
        const double along = bytesBefore == 0.0 ? 1.0
                                                : (wanted - std::log(bytesBefore)) /
                                                      (std::log(share) - std::log(bytesBefore));
        json["contour_at_" + std::to_string(std::lround(100.0 * kShares[next]))] =
            bytesBefore == 0.0 ? error
                               : std::exp(std::lerp(std::log(errorBefore), std::log(error), along));
      }
      bytesBefore = share;
      errorBefore = error;
    }
    print(json);
  }

  void measureCut(
      const std::string& name,
      const SplitForest& forest,
      const WireSections& wire,
      std::uint32_t level) {
    const TriangleMesh cut = cutAt(forest, forest.levelBegin[level + 1]);
    Json json = row("errors", name);
    json["faces"] = cut.triangles.size();
    const auto bytes = std::accumulate(
        wire.levelBytes.begin(),
        wire.levelBytes.begin() + static_cast<std::ptrdiff_t>(level) + 1,
        0ULL);
    json["bytes"] = bytes;
    json["draco_ratio"] = static_cast<double>(bytes) / static_cast<double>(dracoBytes(cut));
    addErrors(json, plain(cut));
    print(json);
  }

  void measureReferences(std::size_t faces) {
    const std::pair<const char*, PlainMesh (*)(const PlainMesh&, std::size_t)> references[] = {
        {"openmesh-modquadric", simplifyOpenMesh},
        {"cgal-lindstrom-turk", simplifyLindstromTurk},
        {"cgal-garland-heckbert", simplifyGarlandHeckbert},
        {"meshopt-simplify", simplifyMeshopt}};
    for (const auto& [name, simplify] : references) {
      const double start = processCpuMs();
      const PlainMesh mesh = simplify(fullPlain_, faces);
      const double seconds = 1e-3 * (processCpuMs() - start);
      Json json = row("errors", name);
      json["faces"] = mesh.triangles.size();
      json["faces_per_second"] = static_cast<double>(full_.triangles.size()) / seconds;
      addErrors(json, mesh);
      print(json);
    }
  }

  Options options_;
  TriangleMesh full_;
  PlainMesh fullPlain_;
  double diagonal_;
  double volume_;
  ContourReference contours_;
  std::size_t fullDraco_;
};

int run(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const auto number = [&]() { return i + 1 < argc ? std::atoi(argv[++i]) : 0; };
    if (std::strcmp(argv[i], "--bits") == 0) {
      options.bits = number();
    } else if (std::strcmp(argv[i], "--views") == 0) {
      options.views = static_cast<std::uint32_t>(number());
    } else if (std::strcmp(argv[i], "--size") == 0) {
      options.size = static_cast<std::uint32_t>(number());
    } else if (std::strcmp(argv[i], "--base-faces") == 0) {
      options.baseFaces = static_cast<std::uint32_t>(number());
    } else if (std::strcmp(argv[i], "--samples") == 0) {
      options.samples = static_cast<std::uint32_t>(number());
    } else if (std::strcmp(argv[i], "--shares") == 0 && i + 1 < argc) {
      options.shares.clear();
      for (char* at = argv[++i]; *at != '\0'; at += *at == ',')
        options.shares.push_back(std::strtod(at, &at));
    } else if (std::strcmp(argv[i], "--cost") == 0 && i + 1 < argc) {
      options.cost = argv[++i];
    } else if (std::strcmp(argv[i], "--placement") == 0 && i + 1 < argc) {
      options.placement = argv[++i];
    } else if (std::strcmp(argv[i], "--no-rates") == 0) {
      options.rates = false;
    } else if (std::strcmp(argv[i], "--no-references") == 0) {
      options.references = false;
    } else {
      options.file = argv[i];
    }
  }
  const auto imported = importMesh(std::filesystem::path(options.file));
  if (!imported) {
    std::fprintf(stderr, "%s\n", imported.error().message.c_str());
    return 1;
  }
  auto repaired = repairMesh(*imported, {.quantizationBits = options.bits});
  if (!repaired) {
    std::fprintf(stderr, "%s\n", repaired.error().message.c_str());
    return 1;
  }
  options.file = std::filesystem::path(options.file).stem();
  Bench bench(options, std::move(repaired->mesh));
  std::vector<std::pair<std::string, ForestOptions>> ours;
  for (const auto& [name, cost] :
       {std::pair{
            "memoryless",
            CollapseCost::kMemoryless},  // the default first: references match it
        {"volume", CollapseCost::kVolume},
        {"quadric", CollapseCost::kQuadric}}) {
    for (const auto& [placed, placement] :
         {std::pair{"subset", Placement::kSubset}, {"volume", Placement::kVolume}}) {
      if ((!options.cost.empty() && options.cost != name) ||
          (!options.placement.empty() && options.placement != placed)) {
        continue;
      }
      ours.push_back(
          {placement == Placement::kSubset ? name : std::string(name) + ", placed",
           {.baseFaces = options.baseFaces, .cost = cost, .placement = placement, .threads = 1}});
    }
  }
  bench.run(ours);
  return 0;
}

}  // namespace
}  // namespace limn::bench

int main(int argc, char** argv) {
  return limn::bench::run(argc, argv);
}
