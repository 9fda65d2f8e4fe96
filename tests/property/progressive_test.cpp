// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/forest/build_forest.h"
#include "tests/property/canonical_mesh.h"
#include "tests/property/forest_shapes.h"
#include "tests/property/legal_order.h"

#include "shared/mesh/feature_edges.h"
#include "shared/mesh/primitives.h"
#include "shared/progressive/active_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace limn {
namespace {

ForestOptions smallBase(Placement placement = Placement::kSubset) {
  ForestOptions options;
  options.baseFaces = 60;
  options.placement = placement;
  return options;
}

std::vector<std::array<VertexId, 3>> fullFaces(const SplitForest& forest) {
  std::vector<VertexId> identity(forest.vertexCount());
  for (VertexId v = 0; v < identity.size(); ++v)
    identity[v] = v;
  return canonicalFaces(forest.triangles, identity);
}

class Progressive : public testing::TestWithParam<ForestCase> {
 protected:
  void SetUp() override {
    shape_ = forestShapes()[std::get<0>(GetParam())];
    placement_ = std::get<1>(GetParam());
    SCOPED_TRACE(shape_.name);
    auto built = buildForest(shape_.mesh, smallBase(placement_));
    ASSERT_TRUE(built) << built.error().message;
    built_ = std::move(*built);
  }

  ForestShape shape_;
  Placement placement_ = Placement::kSubset;
  BuiltForest built_;
};

TEST_P(Progressive, AnyLegalOrderEndsInTheFullMesh) {
  const SplitForest& forest = built_.forest;
  const auto expected = fullFaces(forest);
  Rng rng(std::get<0>(GetParam()) + 1);
  for (int run = 0; run < 4; ++run) {
    const auto order =
        randomLegalOrder(forest, rng, run % 2 == 0 ? OrderKind::kUniform : OrderKind::kDepthFirst);
    ASSERT_EQ(order.size(), forest.splitCount());
    ActiveMesh active = baseMeshOf(forest);
    std::vector<VertexId> ring;
    for (const VertexId v : order) {
      ASSERT_TRUE(active.canonicalRing(forest.parent(v), forest.levelOf(v), ring));
      const auto stored = forest.ring(v);
      ASSERT_TRUE(std::equal(ring.begin(), ring.end(), stored.begin(), stored.end()))
          << "split " << v << " of level " << forest.levelOf(v) << ": "
          << testing::PrintToString(ring) << " instead of "
          << testing::PrintToString(std::vector<VertexId>(stored.begin(), stored.end()));
      // … and stands where it stood when the level was made, whatever has moved it since.
      const VertexId end = forest.levelBegin[forest.levelOf(v)];
      ring.push_back(forest.parent(v));
      for (const VertexId w : ring)
        ASSERT_EQ(active.positionIn(end, active.slotOf(w)), forest.positionIn(end, w));
      const auto applied = active.apply(forest.split(v));
      ASSERT_TRUE(applied) << applied.error().message;
    }
    EXPECT_TRUE(validate(active.mesh()));
    EXPECT_EQ(canonicalFaces(active.mesh().triangles(), active.ids()), expected);
    for (Slot slot = 0; slot < active.ids().size(); ++slot)
      ASSERT_EQ(active.positions()[slot], forest.positions[active.ids()[slot]]);
  }
}

TEST_P(Progressive, EveryClosedSubsetIsAManifold) {
  const SplitForest& forest = built_.forest;
  Rng rng(99);
  const auto order = randomLegalOrder(forest, rng, OrderKind::kDepthFirst);
  ActiveMesh active = baseMeshOf(forest);
  const std::size_t step = std::max<std::size_t>(1, order.size() / 12);
  for (std::size_t i = 0; i < order.size(); ++i) {
    ASSERT_TRUE(active.apply(forest.split(order[i])));
    if (i % step == 0) {
      const auto valid = validate(active.mesh());
      ASSERT_TRUE(valid) << valid.error().message;
    }
  }
}

// A face of the full mesh is in a client's mesh as soon as its last-numbered corner is, and as it
// is once nothing will move its corners any more: what the server's choice of splits for exact
// silhouettes rests on.
TEST_P(Progressive, AFullFaceIsPresentOnceItsFinestCornerIsAndItsCornersRest) {
  const SplitForest& forest = built_.forest;
  Rng rng(5);
  const auto order = randomLegalOrder(forest, rng, OrderKind::kDepthFirst);
  ActiveMesh active = baseMeshOf(forest);
  for (std::size_t i = 0; i < order.size() / 2; ++i)
    ASSERT_TRUE(active.apply(forest.split(order[i])));
  const auto present = canonicalFaces(active.mesh().triangles(), active.ids());
  for (const auto& face : fullFaces(forest)) {
    if (active.holds(*std::max_element(face.begin(), face.end()))) {
      EXPECT_TRUE(std::binary_search(present.begin(), present.end(), face));
    }
    bool isWhole = true;
    forest.forEachSplitOfFace({face[0], face[1], face[2]}, [&](VertexId v) {
      isWhole = isWhole && active.holds(v);
    });
    for (const VertexId v : face) {
      if (isWhole) {
        EXPECT_EQ(active.positions()[active.slotOf(v)], forest.positions[v]);
      }
    }
  }
}

TEST_P(Progressive, CreasesOfTheFullMeshComeBackInAnyOrder) {
  const SplitForest& forest = built_.forest;
  auto full = HalfEdgeMesh::build(forest.vertexCount(), forest.triangles);
  ASSERT_TRUE(full);
  const auto creases = findCreases(*full, forest.positions, smallBase().creaseAngleDegrees);
  Rng rng(11);
  ActiveMesh active = baseMeshOf(forest);
  for (const VertexId v : randomLegalOrder(forest, rng, OrderKind::kUniform)) {
    ASSERT_TRUE(active.apply(forest.split(v)));
  }
  for (HalfEdgeId h = 0; h < creases.size(); ++h) {
    const HalfEdgeId mine =
        active.mesh().find(active.slotOf(full->origin(h)), active.slotOf(full->target(h)));
    ASSERT_NE(mine, kNone);
    EXPECT_EQ(active.features()[mine], creases[h]);
  }
}

// What a split is chosen by holds every full face that waits for it.
TEST_P(Progressive, BoundsOfASplitHoldTheFullFacesThatNeedIt) {
  const SplitForest& forest = built_.forest;
  for (const glm::uvec3& face : forest.triangles) {
    const std::array<glm::dvec3, 3> at = {
        glm::dvec3(forest.positions[face.x]),
        glm::dvec3(forest.positions[face.y]),
        glm::dvec3(forest.positions[face.z])};
    const glm::dvec3 area = glm::cross(at[1] - at[0], at[2] - at[0]);
    forest.forEachSplitOfFace(face, [&](VertexId v) {
      const SplitBounds& bounds = forest.bounds[v - forest.baseVertexCount()];
      for (const glm::dvec3& corner : at)
        ASSERT_LE(glm::distance(corner, glm::dvec3(bounds.center)), bounds.radius * (1 + 1e-5));
      if (bounds.coneCos > -1.0F && glm::length(area) > 0.0) {
        ASSERT_GE(
            glm::dot(glm::normalize(area), glm::dvec3(bounds.coneAxis)),
            bounds.coneCos - 1e-5);
      }
    });
  }
}

TEST_P(Progressive, ThreadsDoNotChangeTheForest) {
  ForestOptions options = smallBase(placement_);
  options.threads = 1;
  const auto other = buildForest(shape_.mesh, options);
  ASSERT_TRUE(other);
  EXPECT_EQ(serializeForest(other->forest), serializeForest(built_.forest));
  EXPECT_EQ(other->baseDraco, built_.baseDraco);
}

TEST_P(Progressive, TheForestSurvivesSerialisationAndNoTruncationPasses) {
  const auto bytes = serializeForest(built_.forest);
  const auto back = parseForest(bytes);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(serializeForest(*back), bytes);
  const std::size_t step = std::max<std::size_t>(1, bytes.size() / 200);
  for (std::size_t cut = 0; cut < bytes.size(); cut += step) {
    EXPECT_FALSE(parseForest(std::span(bytes).first(cut)));
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Progressive, forestCases(0), nameOfForestCase);

// The levels of a volume forest, as a client sees them, keep the volume; those of the other shrink
// or grow.
TEST(VolumePlacement, KeepsTheVolumeOfClosedMeshes) {
  const auto volumeOf = [](const ActiveMesh& active) {
    double volume = 0.0;
    for (const glm::uvec3& t : active.mesh().triangles()) {
      const auto at = [&](int k) { return glm::dvec3(active.positions()[t[k]]); };
      volume += glm::dot(at(0), glm::cross(at(1), at(2))) / 6.0;
    }
    return volume;
  };
  for (const TriangleMesh& mesh : {primitives::icosphere(4), primitives::torus(60, 24)}) {
    double off[2] = {};
    for (const Placement placement : {Placement::kSubset, Placement::kVolume}) {
      const auto built = buildForest(mesh, smallBase(placement));
      ASSERT_TRUE(built);
      EXPECT_EQ(built->forest.placement(), placement);
      ActiveMesh active = baseMeshOf(built->forest);
      const double base = volumeOf(active);
      for (VertexId v = built->forest.baseVertexCount(); v < built->forest.vertexCount(); ++v)
        ASSERT_TRUE(active.apply(built->forest.split(v)));
      off[placement == Placement::kVolume ? 1 : 0] = std::abs(base / volumeOf(active) - 1.0);
    }
    EXPECT_LT(off[1], 0.3 * off[0]);
  }
}

}  // namespace
}  // namespace limn
