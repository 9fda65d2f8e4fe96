// SPDX-License-Identifier: Apache-2.0
//
// limn-contour-bench MESH...: what a server does for an exact contour of edges, and papers/003's
// table 2: one line of JSON a mesh, means over 101 views from 1.5 to 6 radii. Processor
// milliseconds of one thread.
//   forest_paper, forest: papers/003's, by the paper's cost of a node and by ours; tree_scalar,
//   tree: the client's cones without and with vector code; brute_scalar: both planes of every edge,
//   as the paper has it; brute_portable, brute: each face once, without and with vector code. Of
//   each: planes tested, nodes or clusters visited, milliseconds to build, bytes.
// find, code and decode: what an answer costs, the rest of it.
#include "server/contour/anchored_forest.h"
#include "server/contour/contour_extractor.h"
#include "server/preprocess/import/import.h"
#include "server/preprocess/repair/repair.h"
#include "tests/bench/measure.h"

#include "protocol/limits.h"
#include "protocol/messages.h"

#include "shared/codec/contour_codec.h"
#include "shared/core/rng.h"

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr int kViews = 101;
constexpr double kNodeCostOfPaper = 4.0 / 3.0;

std::vector<SilhouetteView> viewsOf(const TriangleMesh& mesh) {
  const BoundingSphere sphere = boundingSphere(mesh.grid, mesh.positions);
  Rng rng(3);
  std::vector<SilhouetteView> views(kViews);
  for (int i = 0; i < kViews; ++i) {
    const double azimuth = rng.below(3600) / 10.0;
    const double elevation = rng.below(1600) / 10.0 - 80.0;
    const Camera camera = orbitCamera(sphere, azimuth, elevation, 1.5 + 4.5 * i / kViews);
    views[static_cast<std::size_t>(i)] = {mesh.grid.fromModel(camera.eye), camera.forward(), false};
  }
  return views;
}

/// Means over the views of one way to search.
struct Search {
  double ms = 0.0;
  double edges = 0.0;
  double tested = 0.0;
  double visited = 0.0;
};

/// Each view once unmeasured, for working memory and caches alike, and then the best of three.
template <class Detector>
Search measure(Detector& detector, const std::vector<SilhouetteView>& views) {
  Search sum;
  for (const SilhouetteView& view : views) {
    double best = 1e300;
    for (int round = 0; round < 4; ++round) {
      const double begin = threadCpuMs();
      static_cast<void>(detector.detect(view));
      if (round > 0) best = std::min(best, threadCpuMs() - begin);
    }
    const DetectionStats& stats = detector.detect(view).stats;
    sum.ms += best / kViews;
    sum.edges += stats.segments / static_cast<double>(kViews);
    sum.tested += stats.sitesTested / static_cast<double>(kViews);
    sum.visited += stats.clustersTested / static_cast<double>(kViews);
  }
  return sum;
}

/// The paper's brute force: the planes of both faces of every edge.
class EdgeByEdge {
 public:
  explicit EdgeByEdge(const SilhouetteField& field) : field_(field) {
    for (HalfEdgeId h = 0; h < field.mesh().origins.size(); ++h) {
      if (field.mesh().twin(h) != kNone && h < field.mesh().twin(h))
        edges_.emplace_back(h, field.mesh().twin(h));
    }
  }

  const SilhouetteResult& detect(const SilhouetteView& view) {
    const glm::vec4 eye = field_.eyeOf(view);
    result_.edges.clear();
    for (const auto& [half, twin] : edges_) {
      const bool front = field_.isFront(HalfEdgeMesh::face(half), eye);
      if (front != field_.isFront(HalfEdgeMesh::face(twin), eye))
        result_.edges.push_back(front ? half : twin);
    }
    result_.stats.sitesTested = static_cast<std::uint32_t>(2 * edges_.size());
    result_.stats.segments = static_cast<std::uint32_t>(result_.edges.size());
    return result_;
  }

 private:
  const SilhouetteField& field_;
  std::vector<std::pair<HalfEdgeId, HalfEdgeId>> edges_;
  SilhouetteResult result_;
};

void printSearch(const char* name, const Search& search, double buildMs, std::size_t bytes) {
  std::printf(
      ", \"%s\": {\"ms\": %.4f, \"planes\": %.0f, \"nodes\": %.0f, \"build_ms\": %.1f, \"bytes\": "
      "%zu}",
      name,
      search.ms,
      search.tested,
      search.visited,
      buildMs,
      bytes);
}

/// papers/003, table 2.
bool benchSearch(const SilhouetteField& field, const std::vector<SilhouetteView>& views) {
  double begin = 0.0;
  Search byForest;
  for (const auto& [name, cost] :
       {std::pair{"forest_paper", ForestCost{kNodeCostOfPaper}}, {"forest", ForestCost{}}}) {
    begin = threadCpuMs();
    AnchoredForest forest(field, cost);
    const double forestMs = threadCpuMs() - begin;
    byForest = measure(forest, views);
    printSearch(name, byForest, forestMs, forest.memoryBytes());
  }
  DetectorOptions options;
  for (const VectorCode code : {VectorCode::kPortable, VectorCode::kAvx512}) {
    options.vectorCode = code;
    const bool portable = code == VectorCode::kPortable;
    begin = threadCpuMs();
    const auto tree = makeDetector(DetectorMethod::kCones, field, options);
    const double treeMs = threadCpuMs() - begin;
    const Search byTree = measure(*tree, views);
    printSearch(portable ? "tree_scalar" : "tree", byTree, treeMs, tree->memoryBytes());
    if (byTree.edges != byForest.edges) return false;
    const auto brute = makeDetector(DetectorMethod::kBrute, field, options);
    printSearch(portable ? "brute_portable" : "brute", measure(*brute, views), 0.0, 0);
  }
  EdgeByEdge all(field);
  const Search byEdges = measure(all, views);
  printSearch("brute_scalar", byEdges, 0.0, 0);
  return byEdges.edges == byForest.edges;
}

/// What an answer costs the server and the client.
bool benchAnswer(const SilhouetteField& field, const std::vector<SilhouetteView>& views) {
  const ContourExtractor extractor(field);
  double find = 0.0;
  double code = 0.0;
  double decode = 0.0;
  double bytes = 0.0;
  double points = 0.0;
  for (const SilhouetteView& view : views) {
    static_cast<void>(extractor.extract(view));  // working memory
    double begin = threadCpuMs();
    const ContourLines lines = extractor.extract(view);
    find += threadCpuMs() - begin;
    begin = threadCpuMs();
    const auto coded = encodeContour(lines);
    const auto message = protocol::encodeMessage(protocol::Contour{0, 1, coded});
    code += threadCpuMs() - begin;
    begin = threadCpuMs();
    if (!decodeContour(coded, limits::kMaxContourPoints)) return false;
    decode += threadCpuMs() - begin;
    bytes += static_cast<double>(message.size());
    points += static_cast<double>(lines.points.size());
  }
  std::printf(
      ", \"points\": %.0f, \"find_ms\": %.4f, \"code_ms\": %.4f, \"decode_ms\": %.4f, "
      "\"answers_a_second\": %.0f, \"bytes_a_point\": %.3f",
      points / kViews,
      find / kViews,
      code / kViews,
      decode / kViews,
      1000.0 * kViews / (find + code),
      bytes / points);
  return true;
}

int bench(const char* path) {
  const auto imported = importMesh(path);
  const auto repaired = imported ? repairMesh(*imported, {14}) : tl::unexpected(imported.error());
  const auto links = repaired ? HalfEdgeMesh::build(
                                    static_cast<std::uint32_t>(repaired->mesh.positions.size()),
                                    repaired->mesh.triangles)
                              : tl::unexpected(repaired.error());
  if (!links) {
    std::fprintf(stderr, "limn-contour-bench: %s: %s\n", path, links.error().message.c_str());
    return 1;
  }
  const TriangleMesh& mesh = repaired->mesh;
  const SilhouetteField field(*links, mesh.positions, SilhouetteKind::kEdges);
  const std::vector<SilhouetteView> views = viewsOf(mesh);
  EdgeByEdge all(field);
  const Search edges = measure(all, views);
  std::printf(
      "{\"faces\": %zu, \"edges\": %.0f, \"silhouette_edges\": %.0f",
      mesh.triangles.size(),
      edges.tested / 2.0,
      edges.edges);
  const bool ok = benchSearch(field, views) && benchAnswer(field, views);
  std::printf("}\n");
  if (!ok) std::fprintf(stderr, "limn-contour-bench: %s: searches differ\n", path);
  return ok ? 0 : 1;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: limn-contour-bench MESH...\n");
    return 2;
  }
  int status = 0;
  for (int i = 1; i < argc; ++i)
    status |= limn::bench(argv[i]);
  return status;
}
