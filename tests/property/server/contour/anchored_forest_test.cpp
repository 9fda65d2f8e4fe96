// SPDX-License-Identifier: Apache-2.0
#include "server/contour/anchored_forest.h"

#include "tests/corpus/corpus.h"
#include "tests/property/shared/silhouette/views.h"

#include "shared/mesh/primitives.h"
#include "shared/silhouette/detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace limn {
namespace {

constexpr std::size_t kMostFaces = 10000;  // building takes its time

std::vector<HalfEdgeId> sorted(std::vector<HalfEdgeId> edges) {
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// Random views, and some from on the surface and just off it.
std::vector<SilhouetteView> viewsOf(const TriangleMesh& mesh, int count) {
  std::vector<SilhouetteView> views = testing::randomViews(mesh, count, 42);
  const std::size_t step = std::max<std::size_t>(1, mesh.positions.size() / 20);
  for (std::size_t v = 0; v < mesh.positions.size(); v += step) {
    for (const double away : {0.0, 0.25, 3.0, 100.0})
      views.push_back({glm::dvec3(mesh.positions[v]) + away, {}, false});
  }
  return views;
}

void expectBruteForces(const std::string& name, const TriangleMesh& shape, int viewCount) {
  SCOPED_TRACE(name);
  const auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
  ASSERT_TRUE(mesh) << mesh.error().message;
  const SilhouetteField field(*mesh, shape.positions, SilhouetteKind::kEdges);
  AnchoredForest forest(field);
  const auto brute = makeDetector(DetectorMethod::kBrute, field);
  for (const SilhouetteView& view : viewsOf(shape, viewCount))
    ASSERT_EQ(sorted(forest.detect(view).edges), sorted(brute->detect(view).edges));
}

TEST(AnchoredForest, FindsWhatBruteForceFindsOnGeneratedShapes) {
  for (const corpus::Mesh& subject : corpus::generated()) {
    if (subject.mesh.triangles.size() <= kMostFaces)
      expectBruteForces(subject.name, subject.mesh, 200);
  }
}

TEST(AnchoredForest, FindsWhatBruteForceFindsOnSquashedAndCoarseShapes) {
  TriangleMesh flat = primitives::icosphere(3);
  for (glm::ivec3& p : flat.positions)
    p.z = 0;
  expectBruteForces("flat", flat, 100);
  TriangleMesh thin = primitives::torus(40, 20);
  for (glm::ivec3& p : thin.positions)
    p.x /= 1000;
  expectBruteForces("thin", thin, 100);
  TriangleMesh coarse = primitives::torusKnot(2, 3, 150, 12);
  for (glm::ivec3& p : coarse.positions)
    p = p / 256 * 256;
  expectBruteForces("coarse", coarse, 100);
  TriangleMesh point = primitives::icosphere(2);
  for (glm::ivec3& p : point.positions)
    p = {5, 5, 5};
  expectBruteForces("point", point, 20);
}

TEST(AnchoredForest, FindsWhatBruteForceFindsOnModels) {
  if (!corpus::modelsFolder()) GTEST_SKIP() << corpus::kNoModels;
  for (const char* name : {"bunny-low.off", "fandisk.off", "block.off"}) {
    const corpus::Mesh* subject = corpus::model(name);
    if (subject != nullptr) expectBruteForces(name, subject->mesh, 100);
  }
}

TEST(AnchoredForest, TestsAFractionOfASmoothShapesEdges) {
  const TriangleMesh shape = primitives::torus(96, 48);
  const auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
  ASSERT_TRUE(mesh);
  const SilhouetteField field(*mesh, shape.positions, SilhouetteKind::kEdges);
  AnchoredForest forest(field);
  double tested = 0.0;
  double visited = 0.0;
  const auto views = testing::randomViews(shape, 50, 3);
  for (const SilhouetteView& view : views) {
    const DetectionStats& stats = forest.detect(view).stats;
    tested += stats.sitesTested / 2.0;
    visited += stats.clustersTested;
  }
  const double edges = 1.5 * static_cast<double>(shape.triangles.size());
  EXPECT_LT(tested, 0.3 * edges * static_cast<double>(views.size()));
  EXPECT_LT(visited, 0.3 * edges * static_cast<double>(views.size()));
}

}  // namespace
}  // namespace limn
