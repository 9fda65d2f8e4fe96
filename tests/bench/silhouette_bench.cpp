// SPDX-License-Identifier: Apache-2.0
// Detection and chaining, timed against brute force and against the loop that everyone writes
// first, in the same run on the same views. One thread. Prints rows for bench.py.
//   limn-silhouette-bench [--quick | NAME]   NAME: only meshes whose name starts so
#include "client/stroke/chain/chain.h"
#include "server/preprocess/forest/build_forest.h"
#include "tests/bench/measure.h"
#include "tests/corpus/corpus.h"
#include "tests/corpus/torus_knots.h"
#include "tests/property/shared/silhouette/views.h"

#include "shared/progressive/active_mesh.h"
#include "shared/silhouette/cone_forest.h"
#include "shared/silhouette/detector.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace limn {
namespace {

using Views = std::vector<SilhouetteView>;
using Work = std::function<void(const SilhouetteView&)>;

// Median over the views of the best of a few rounds, for each of several kinds of work. Rounds take
// turns, so that what disturbs the machine disturbs all; within a round a kind of work goes through
// all views, as a camera that moves.
std::vector<double> medianMs(const Views& views, int rounds, const std::vector<Work>& works) {
  std::vector<std::vector<double>> best(works.size(), std::vector<double>(views.size(), 1e30));
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t w = 0; w < works.size(); ++w) {
      for (std::size_t v = 0; v < views.size(); ++v) {
        const double start = threadCpuMs();
        works[w](views[v]);
        best[w][v] = std::min(best[w][v], threadCpuMs() - start);
      }
    }
  }
  std::vector<double> medians;
  for (std::vector<double>& times : best) {
    std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
    medians.push_back(times[times.size() / 2]);
  }
  return medians;
}

// Faces, vertices and edges as structs, one at a time: the classic.
class ClassicDetector {
 public:
  explicit ClassicDetector(const SilhouetteField& field) : field_(&field) {
    const HalfEdgeMesh& mesh = field.mesh();
    for (std::uint32_t s = 0; s < field.siteCount(); ++s)
      sites_.push_back({field.plane(s), 0.0F});
    for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
      if (mesh.twins[h] != kNone && h < mesh.twins[h]) {
        edges_.push_back({HalfEdgeMesh::face(h), HalfEdgeMesh::face(mesh.twins[h]), h});
      }
    }
  }

  std::size_t detect(const SilhouetteView& view) {
    const glm::vec4 eye = field_->eyeOf(view);
    for (Site& site : sites_)
      site.value = glm::dot(site.plane, eye);
    found_.clear();
    if (field_->kind() == SilhouetteKind::kEdges) {
      for (const Edge& edge : edges_) {
        if ((sites_[edge.a].value > 0.0F) != (sites_[edge.b].value > 0.0F)) {
          found_.push_back(edge.h);
        }
      }
    } else {
      const auto triangles = field_->mesh().triangles();
      for (FaceId f = 0; f < triangles.size(); ++f) {
        const bool a = sites_[triangles[f].x].value > 0.0F;
        if ((sites_[triangles[f].y].value > 0.0F) != a ||
            (sites_[triangles[f].z].value > 0.0F) != a) {
          found_.push_back(f);
        }
      }
    }
    return found_.size();
  }

 private:
  struct Site {
    glm::vec4 plane;
    float value;
  };

  struct Edge {
    FaceId a;
    FaceId b;
    HalfEdgeId h;
  };

  const SilhouetteField* field_;
  std::vector<Site> sites_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> found_;
};

struct Row {
  std::string what;
  std::string mesh;
  double ours = 0.0;
  double reference = 0.0;  // 0: none
  double target = 0.0;     // upper bound of ours / reference, or of ours; 0: none
  std::string unit;
};

// One JSON object a line; bench.py makes the table.
void print(const Row& row) {
  std::printf(
      R"({"row":"%s","mesh":"%s","ours":%.6g,"reference":%.6g,"target":%.6g,"unit":"%s"})"
      "\n",
      row.what.c_str(),
      row.mesh.c_str(),
      row.ours,
      row.reference,
      row.target,
      row.unit.c_str());
  std::fflush(stdout);
}

// What cones have to beat brute force by, and chained smooth polylines to stay below: 20 ns where
// planes and positions fit a second-level cache of 2 MiB, 45 where they do not.
struct Targets {
  double edges = 0.0;
  double smooth = 0.0;
  double orbit = 0.0;
  double chainedNs = 20.0;
};

void benchKind(
    const std::string& name,
    const TriangleMesh& shape,
    const HalfEdgeMesh& mesh,
    SilhouetteKind kind,
    const Targets& targets,
    int viewCount) {
  const bool isEdges = kind == SilhouetteKind::kEdges;
  const std::string kindName = isEdges ? "edges" : "smooth";
  const SilhouetteField field(mesh, shape.positions, kind);
  const double start = threadCpuMs();
  DetectorOptions options;
  // One for both: where its pages happen to lie makes a difference of some percent.
  options.cones = std::make_shared<ConeForest>(field);
  const double buildMs = threadCpuMs() - start;
  const auto cones = makeDetector(DetectorMethod::kCones, field, options);
  const auto exact = makeDetector(DetectorMethod::kExact, field, options);
  const auto brute = makeDetector(DetectorMethod::kBrute, field);
  ClassicDetector classic(field);
  SilhouetteChainer chainer;
  const Views random = testing::randomViews(shape, viewCount, 1);
  const Views orbit = testing::orbitViews(shape, viewCount, 0.9);

  std::size_t segments = 0;
  for (const SilhouetteView& view : random) {
    const std::size_t truth = brute->detect(view).stats.segments;
    segments += truth;
    if (cones->detect(view).stats.segments != truth ||
        exact->detect(view).stats.segments != truth) {
      std::fprintf(stderr, "%s: cones, exact and brute force disagree\n", name.c_str());
      std::exit(1);
    }
  }
  const double perView = static_cast<double>(segments) / static_cast<double>(random.size());
  std::size_t sink = 0;
  const auto detect = [&](SilhouetteDetector& detector) {
    return [&](const SilhouetteView& v) { sink += detector.detect(v).stats.segments; };
  };
  const auto chained = [&](const SilhouetteView& v) {
    sink += chainer.chain(field, v, cones->detect(v)).points.size();
  };
  constexpr int kRounds = 7;
  const auto scalar = [&](const SilhouetteView& v) { sink += classic.detect(v); };
  const auto ms = medianMs(random, kRounds, {scalar, detect(*brute), detect(*cones), chained});
  const auto orbitMs = medianMs(orbit, kRounds, {detect(*brute), detect(*cones), detect(*exact)});

  const double edges = 1.5 * mesh.faceCount();
  const auto bound = [](double speedUp) { return speedUp > 0.0 ? 1.0 / speedUp : 0.0; };
  print({"brute, " + kindName + ", an edge", name, ms[1] * 1e6 / edges, 0.0, 1.6, "ns"});
  print({"brute, " + kindName, name, ms[1], ms[0], 0.0, "ms"});
  print(
      {"cones, " + kindName,
       name,
       ms[2],
       ms[1],
       bound(isEdges ? targets.edges : targets.smooth),
       "ms"});
  print(
      {"cones, " + kindName + ", orbit",
       name,
       orbitMs[1],
       orbitMs[0],
       isEdges ? bound(targets.orbit) : 0.0,
       "ms"});
  print({"exact, " + kindName + ", orbit / cones", name, orbitMs[2], orbitMs[1], 1.1, "ms"});
  print(
      {"cones + chain, " + kindName + ", a segment",
       name,
       ms[3] * 1e6 / perView,
       0.0,
       isEdges ? 0.0 : targets.chainedNs,
       "ns"});
  print(
      {"chain, " + kindName + ", a segment",
       name,
       (ms[3] - ms[2]) * 1e6 / perView,
       0.0,
       0.0,
       "ns"});
  print(
      {"cones, " + kindName + ", a face",
       name,
       static_cast<double>(cones->memoryBytes()) / mesh.faceCount(),
       0.0,
       24.0,
       "B"});
  print({"cones, " + kindName + ", build", name, buildMs, 0.0, 0.0, "ms"});
  if (sink == 0) std::fprintf(stderr, "%s: nothing found\n", name.c_str());
}

void benchMesh(
    const std::string& name,
    const TriangleMesh& shape,
    const Targets& targets,
    int viewCount) {
  const auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
  if (!mesh) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), mesh.error().message.c_str());
    return;
  }
  for (const SilhouetteKind kind : {SilhouetteKind::kEdges, SilhouetteKind::kSmooth})
    benchKind(name, shape, *mesh, kind, targets, viewCount);
}

// Cones of a mesh half refined, refitted after one of a hundred of its splits more, near one
// another as a client gets them: against building them, and the search against that of new ones.
void benchRefit(const std::string& name, const TriangleMesh& shape, int viewCount) {
  const auto built = buildForest(shape, {.baseFaces = 800, .threads = 1});
  if (!built) return;
  const SplitForest& forest = built->forest;
  const TriangleMesh base = forest.baseMesh();
  auto half = ActiveMesh::fromBase(forest.levelBegin, base, forest.baseFeatures);
  if (!half) return;
  // By levels to the half, then the first hundredth of all splits that open on one side.
  VertexId v = forest.baseVertexCount();
  for (; v < forest.baseVertexCount() + forest.splitCount() / 2; ++v) {
    if (!half->apply(forest.split(v))) return;
  }
  ActiveMesh more = *half;
  std::uint32_t wanted = forest.splitCount() / 100;
  for (; v < forest.vertexCount() && wanted > 0; ++v) {
    if (forest.positions[v].x < base.positions[0].x && more.apply(forest.split(v))) --wanted;
  }
  for (const SilhouetteKind kind : {SilhouetteKind::kEdges, SilhouetteKind::kSmooth}) {
    const std::string kindName = kind == SilhouetteKind::kEdges ? "edges" : "smooth";
    const SilhouetteField before(half->mesh(), half->positions(), kind);
    const SilhouetteField after(more.mesh(), more.positions(), kind);
    const ConeForest old(before);
    double refitMs = 1e30;
    double buildMs = 1e30;
    std::shared_ptr<ConeForest> refitted;
    std::shared_ptr<ConeForest> fresh;
    for (int round = 0; round < 5; ++round) {
      refitted = std::make_shared<ConeForest>(old);
      double start = threadCpuMs();
      refitted->refit(half->mesh(), half->positions(), after);
      refitMs = std::min(refitMs, threadCpuMs() - start);
      start = threadCpuMs();
      fresh = std::make_shared<ConeForest>(after);
      buildMs = std::min(buildMs, threadCpuMs() - start);
    }
    DetectorOptions options;
    options.cones = refitted;
    const auto loose = makeDetector(DetectorMethod::kCones, after, options);
    options.cones = fresh;
    const auto tight = makeDetector(DetectorMethod::kCones, after, options);
    std::size_t sink = 0;
    const auto ms = medianMs(
        testing::randomViews(shape, viewCount, 1),
        7,
        {[&](const SilhouetteView& view) { sink += loose->detect(view).stats.segments; },
         [&](const SilhouetteView& view) { sink += tight->detect(view).stats.segments; }});
    print({"cones, " + kindName + ", refit / build", name, refitMs, buildMs, 0.0, "ms"});
    print({"cones, " + kindName + ", refitted / new", name, ms[0], ms[1], 0.0, "ms"});
    if (sink == 0) std::fprintf(stderr, "%s: nothing found\n", name.c_str());
  }
}

int run(int argc, char** argv) {
  const std::string only = argc > 1 ? argv[1] : "";
  const bool isQuick = only == "--quick";
  const int viewCount = isQuick ? 21 : 101;
  const auto isWanted = [&](const std::string& name) {
    return only.empty() || (isQuick && name.starts_with("bunny")) || name.starts_with(only);
  };
  const std::pair<const char*, Targets> files[] = {
      {"bunny-closed.ply", {4.0, 0.0, 0.0, 20.0}},
      {"turbine-blade.ply", {5.0, 0.0, 0.0, 45.0}},
      {"dragon.ply", {2.0, 0.0, 4.0, 45.0}}};
  for (const auto& [file, targets] : files) {
    if (!isWanted(file)) continue;
    if (const corpus::Mesh* mesh = corpus::model(file)) {
      benchMesh(mesh->name, mesh->mesh, targets, viewCount);
      if (targets.orbit == 0.0) benchRefit(mesh->name, mesh->mesh, viewCount);
    }
  }
  if (isWanted("knot-rough-400k")) {
    const corpus::KnotOptions rough{.segments = 2500, .sides = 80, .roughness = 0.002};
    benchMesh("knot-rough-400k", corpus::torusKnot(rough), {6.0, 0.0, 0.0, 45.0}, viewCount);
  }
  if (isWanted("knot-smooth-1M"))
    benchMesh("knot-smooth-1M", corpus::torusKnot({}), {0.0, 10.0, 0.0, 45.0}, viewCount);
  return 0;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(argc, argv);
}
