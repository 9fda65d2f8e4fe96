// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/forest/build_forest.h"
#include "server/preprocess/seeds/build_seeds.h"
#include "server/preprocess/seeds/viewpoint_grid.h"
#include "tests/corpus/corpus.h"
#include "tests/property/shared/silhouette/views.h"

#include "shared/gl/osmesa_context.h"
#include "shared/mesh/primitives.h"
#include "shared/progressive/active_mesh.h"
#include "shared/silhouette/detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace limn {
namespace {

SplitForest forestOf(const TriangleMesh& mesh) {
  ForestOptions options;
  options.baseFaces = 100;
  auto built = buildForest(mesh, options);
  EXPECT_TRUE(built) << (built ? "" : built.error().message);
  return built ? std::move(built->forest) : SplitForest{};
}

TriangleMesh fullMesh(const SplitForest& forest) {
  return {forest.grid, forest.positions, forest.triangles};
}

Result<SeedTable> seedsOf(const SplitForest& forest, const SeedOptions& options = {}) {
  return buildSeeds(fullMesh(forest), forest.parents, forest.baseVertexCount(), options);
}

// The base and the splits of the coarsest levels, up to `vertices`.
ActiveMesh partOf(const SplitForest& forest, std::uint32_t vertices) {
  auto mesh = ActiveMesh::fromBase(forest.levelBegin, forest.baseMesh(), forest.baseFeatures);
  EXPECT_TRUE(mesh);
  for (VertexId v = forest.baseVertexCount(); v < vertices; ++v) {
    EXPECT_TRUE(mesh->apply(forest.split(v)));
  }
  return std::move(*mesh);
}

struct Recall {
  double mean = 0.0;
  double worst = 1.0;
};

// Recall against brute force; what was found must be silhouettes, each once.
Recall
measure(const ActiveMesh& mesh, const SeedTable& seeds, SilhouetteKind kind, const Grid& grid) {
  const SilhouetteField field(mesh.mesh(), mesh.positions(), kind);
  DetectorOptions options;
  options.seeds = &seeds;
  options.slotOf = [&](VertexId v) { return mesh.holds(v) ? mesh.slotOf(v) : kNone; };
  const auto brute = makeDetector(DetectorMethod::kBrute, field);
  const auto precomputed = makeDetector(DetectorMethod::kPrecomputed, field, options);
  TriangleMesh shape;
  shape.grid = grid;
  shape.positions.assign(mesh.positions().begin(), mesh.positions().end());
  const auto views = testing::randomViews(shape, 40, 3);
  Recall total;
  for (const SilhouetteView& view : views) {
    const SilhouetteResult& truth = brute->detect(view);
    const SilhouetteResult& found = precomputed->detect(view);
    auto wanted = kind == SilhouetteKind::kEdges ? truth.edges : truth.faces;
    auto given = kind == SilhouetteKind::kEdges ? found.edges : found.faces;
    std::sort(wanted.begin(), wanted.end());
    std::sort(given.begin(), given.end());
    EXPECT_EQ(std::adjacent_find(given.begin(), given.end()), given.end());
    EXPECT_TRUE(std::includes(wanted.begin(), wanted.end(), given.begin(), given.end()));
    const double share = recall(found, truth);
    total.mean += share / static_cast<double>(views.size());
    total.worst = std::min(total.worst, share);
  }
  return total;
}

void report(const std::string& name, const char* kind, const Recall& recall) {
  std::printf(
      "recall of precomputed, %s, %s: mean %.1f%%, worst view %.1f%%\n",
      name.c_str(),
      kind,
      100.0 * recall.mean,
      100.0 * recall.worst);
  ::testing::Test::RecordProperty(name + "-" + kind + "-mean", std::to_string(recall.mean));
  ::testing::Test::RecordProperty(name + "-" + kind + "-worst", std::to_string(recall.worst));
}

TEST(Seeds, AreVerticesOfTheMeshWithTheirAncestorsBeforeThem) {
  const SplitForest forest = forestOf(primitives::bumpySphere(4, 7));
  const auto seeds = seedsOf(forest);
  ASSERT_TRUE(seeds) << seeds.error().message;
  // The grid, and up to half as many where the contours change fast.
  EXPECT_GE(seeds->directions.size(), 40U);
  EXPECT_LE(seeds->directions.size(), 60U);
  ASSERT_EQ(seeds->seedBegin.size(), seeds->directions.size() + 1);
  EXPECT_EQ(seeds->seedBegin.front(), 0U);
  EXPECT_EQ(seeds->seedBegin.back(), seeds->seeds.size());
  for (std::size_t v = 0; v < seeds->directions.size(); ++v) {
    EXPECT_NEAR(glm::length(seeds->directions[v]), 1.0F, 1e-5F);
    EXPECT_GT(seeds->seedBegin[v + 1], seeds->seedBegin[v]);
    EXPECT_LE(seeds->seedBegin[v + 1] - seeds->seedBegin[v], SeedOptions{}.seedsPerView);
  }
  for (const std::uint32_t seed : seeds->seeds)
    ASSERT_LT(seed, seeds->nodes.size());
  for (std::size_t i = 0; i < seeds->nodes.size(); ++i) {
    const SeedTable::Node& node = seeds->nodes[i];
    ASSERT_LT(node.vertex, forest.vertexCount());
    if (i > 0) {
      ASSERT_LT(seeds->nodes[i - 1].vertex, node.vertex);
    }
    if (node.vertex < forest.baseVertexCount()) {
      ASSERT_EQ(node.parent, kNone);
    } else {
      ASSERT_LT(node.parent, i);
      ASSERT_EQ(seeds->nodes[node.parent].vertex, forest.parent(node.vertex));
    }
  }
}

TEST(Seeds, AreTheSameEveryTime) {
  const SplitForest forest = forestOf(primitives::torusKnot(2, 3, 120, 12));
  const auto first = seedsOf(forest);
  const auto second = seedsOf(forest);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->seeds, second->seeds);
  EXPECT_EQ(first->seedBegin, second->seedBegin);
  EXPECT_EQ(first->directions, second->directions);
}

TEST(Seeds, LeadToSilhouettesAtEveryStateOfRefinement) {
  for (const corpus::Mesh& subject : corpus::generated()) {
    if (subject.mesh.triangles.size() < 1000) continue;
    SCOPED_TRACE(subject.name);
    const SplitForest forest = forestOf(subject.mesh);
    const auto seeds = seedsOf(forest);
    ASSERT_TRUE(seeds) << seeds.error().message;
    const std::uint32_t full = forest.vertexCount();
    for (const std::uint32_t vertices : {forest.baseVertexCount(), full / 3, full}) {
      const ActiveMesh mesh = partOf(forest, std::max(vertices, forest.baseVertexCount()));
      const Recall edges = measure(mesh, *seeds, SilhouetteKind::kEdges, forest.grid);
      const Recall smooth = measure(mesh, *seeds, SilhouetteKind::kSmooth, forest.grid);
      const std::string name = subject.name + "-" + std::to_string(vertices);
      report(name, "edges", edges);
      report(name, "smooth", smooth);
      EXPECT_GT(edges.mean, 0.4);
      EXPECT_GT(smooth.mean, 0.5);
    }
  }
}

TEST(Seeds, MoreViewpointsStandWhereTheGridsSeedsLeadToLeast) {
  const SplitForest forest = forestOf(primitives::bumpySphere(5, 7));
  SeedOptions plain;
  plain.extraViewpoints = 0.0;
  const auto grid = seedsOf(forest, plain);
  const auto denser = seedsOf(forest);
  ASSERT_TRUE(grid && denser);
  EXPECT_EQ(grid->directions.size(), 40U);
  EXPECT_GT(denser->directions.size(), 40U);
  const ActiveMesh mesh = partOf(forest, forest.vertexCount());
  const TriangleMesh shape = fullMesh(forest);
  const BoundingSphere sphere = boundingSphere(shape.grid, shape.positions);
  double without = 0.0;
  double with = 0.0;
  for (const SilhouetteKind kind : {SilhouetteKind::kEdges, SilhouetteKind::kSmooth}) {
    const SilhouetteField field(mesh.mesh(), mesh.positions(), kind);
    const auto brute = makeDetector(DetectorMethod::kBrute, field);
    const auto recallAt = [&](const SeedTable& seeds, const SilhouetteView& view) {
      DetectorOptions options;
      options.seeds = &seeds;
      options.slotOf = [&](VertexId v) { return mesh.slotOf(v); };
      const auto detector = makeDetector(DetectorMethod::kPrecomputed, field, options);
      return recall(detector->detect(view), brute->detect(view));
    };
    for (std::size_t v = 40; v < denser->directions.size(); ++v) {
      SilhouetteView view;
      view.eye = shape.grid.fromModel(
          sphere.center + 3.0 * sphere.radius * glm::dvec3(denser->directions[v]));
      without += recallAt(*grid, view);
      with += recallAt(*denser, view);
    }
  }
  EXPECT_GT(with, without);
}

TEST(ViewpointGrid, IsMadeDenserInItsWorstCellsOnly) {
  // All is lost around azimuth 100, elevation 20, nothing elsewhere.
  const auto lossAt = [](const Viewpoint& at) {
    return std::max(0.0, 1.0 - 0.02 * std::hypot(at.azimuth - 100.0, at.elevation - 20.0));
  };
  std::vector<Viewpoint> added;
  densify(8, 5, {.most = 10}, lossAt, [&](const Viewpoint& at) { added.push_back(at); });
  ASSERT_EQ(added.size(), 10U);
  for (const Viewpoint& at : added)
    EXPECT_GT(lossAt(at), 0.0);
  added.clear();
  densify(
      8,
      5,
      {.most = 10},
      [](const Viewpoint&) { return 0.0; },
      [&](const Viewpoint& at) { added.push_back(at); });
  EXPECT_TRUE(added.empty());
  EXPECT_EQ(viewpointGrid(8, 5).size(), 40U);
}

TEST(Seeds, RecallOnARealScanIsReported) {
  const corpus::Mesh* scan = corpus::model("bunny-low.off");
  if (scan == nullptr) GTEST_SKIP() << corpus::kNoModels;
  const SplitForest forest = forestOf(scan->mesh);
  const auto seeds = seedsOf(forest);
  ASSERT_TRUE(seeds) << seeds.error().message;
  const ActiveMesh mesh = partOf(forest, forest.vertexCount());
  const Recall smooth = measure(mesh, *seeds, SilhouetteKind::kSmooth, forest.grid);
  report(scan->name, "edges", measure(mesh, *seeds, SilhouetteKind::kEdges, forest.grid));
  report(scan->name, "smooth", smooth);
  EXPECT_GT(smooth.mean, 0.5);
}

TEST(Seeds, WithoutOsmesaThereIsAnErrorThatSaysWhatToInstall) {
  const auto context = createOsmesaContext("libNoSuchOSMesa.so.0");
  ASSERT_FALSE(context);
  EXPECT_EQ(context.error().code, ErrorCode::kUnavailable);
  EXPECT_NE(context.error().message.find("libosmesa6"), std::string::npos);
}

TEST(Seeds, RefusesArgumentsThatDisagree) {
  const TriangleMesh cube = primitives::cube();
  SeedOptions none;
  none.azimuths = 0;
  EXPECT_FALSE(buildSeeds(cube, {}, 8, none));
  EXPECT_FALSE(buildSeeds(cube, {}, 7));
  EXPECT_FALSE(buildSeeds(cube, {}, 9));
  const VertexId later[] = {7};
  EXPECT_FALSE(buildSeeds(cube, later, 7));
}

TEST(Seeds, ExactStartsFromThemAndFindsEverything) {
  const SplitForest forest = forestOf(primitives::bumpySphere(4, 7));
  const auto seeds = seedsOf(forest);
  ASSERT_TRUE(seeds);
  const ActiveMesh mesh = partOf(forest, forest.vertexCount() / 2);
  DetectorOptions options;
  options.seeds = &*seeds;
  options.slotOf = [&](VertexId v) { return mesh.holds(v) ? mesh.slotOf(v) : kNone; };
  TriangleMesh shape{forest.grid, {}, {}};
  shape.positions.assign(mesh.positions().begin(), mesh.positions().end());
  for (const SilhouetteKind kind : {SilhouetteKind::kEdges, SilhouetteKind::kSmooth}) {
    const SilhouetteField field(mesh.mesh(), mesh.positions(), kind);
    const auto brute = makeDetector(DetectorMethod::kBrute, field);
    const auto exact = makeDetector(DetectorMethod::kExact, field, options);
    bool isFirst = true;
    for (const SilhouetteView& view : testing::randomViews(shape, 10, 3)) {
      const SilhouetteResult& found = exact->detect(view);
      EXPECT_EQ(found.stats.seedsTried > 0, isFirst);
      EXPECT_EQ(recall(found, brute->detect(view)), 1.0);
      EXPECT_EQ(found.stats.segments, brute->detect(view).stats.segments);
      isFirst = false;
    }
  }
}

TEST(Seeds, PrecomputedWithoutSeedsFindsNothing) {
  const TriangleMesh shape = primitives::icosphere(2);
  const auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
  ASSERT_TRUE(mesh);
  const SilhouetteField field(*mesh, shape.positions, SilhouetteKind::kEdges);
  const auto detector = makeDetector(DetectorMethod::kPrecomputed, field);
  EXPECT_EQ(detector->detect(testing::randomViews(shape, 1, 1)[0]).stats.segments, 0U);
  // Nor does a damaged table do harm.
  SeedTable damaged;
  damaged.directions = {{0, 0, 1}, {0, 1, 0}};
  damaged.seedBegin = {0, 5, 2};
  damaged.seeds = {9, 0, 1};
  damaged.nodes = {{4000000000U, 7}, {5, 1}};
  DetectorOptions options;
  options.seeds = &damaged;
  const auto guarded = makeDetector(DetectorMethod::kPrecomputed, field, options);
  EXPECT_LE(guarded->detect(testing::randomViews(shape, 1, 1)[0]).stats.seedsTried, 2U);
}

}  // namespace
}  // namespace limn
