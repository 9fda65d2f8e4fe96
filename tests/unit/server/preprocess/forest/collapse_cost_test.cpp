// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/forest/collapse_cost.h"

#include "shared/core/rng.h"
#include "shared/mesh/feature_edges.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace limn {
namespace {

constexpr std::array<CollapseCost, 3> kCosts = {
    CollapseCost::kVolume,
    CollapseCost::kQuadric,
    CollapseCost::kMemoryless};

CollapseMesh collapsible(const TriangleMesh& mesh, double creaseAngle = 40.0) {
  auto halfEdges =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  return *CollapseMesh::build(mesh, findCreases(*halfEdges, mesh.positions, creaseAngle));
}

double tetrahedronVolume(
    const glm::dvec3& a,
    const glm::dvec3& b,
    const glm::dvec3& c,
    const glm::dvec3& d) {
  return glm::dot(glm::cross(b - a, c - a), d - a) / 6.0;
}

TEST(Quadric, IsTheWeightedSumOfSquaredDistances) {
  Rng rng(1);
  const auto random = [&] {
    return glm::dvec3(rng.uniform(), rng.uniform(), rng.uniform()) * 100.0 - 50.0;
  };
  Quadric quadric;
  std::vector<std::array<glm::dvec3, 2>> planes;
  for (int i = 0; i < 8; ++i) {
    planes.push_back({glm::normalize(random()), random()});
    quadric.addPlane(planes.back()[0], planes.back()[1], 1.0 + i);
  }
  for (int i = 0; i < 20; ++i) {
    const glm::dvec3 p = random();
    double expected = 0.0;
    for (std::size_t k = 0; k < planes.size(); ++k) {
      const double d = glm::dot(planes[k][0], p - planes[k][1]);
      expected += (1.0 + static_cast<double>(k)) * d * d;
    }
    EXPECT_NEAR(quadric.at(p), expected, 1e-9 * expected);
  }
}

// papers/002: λ · (sum of squared volumes) · (degree sum), on a closed mesh, spelled out.
TEST(CollapseCostTest, VolumeCostIsTheFormulaOfThePaper) {
  const TriangleMesh mesh = primitives::bumpySphere(3, 2);
  const CollapseMesh work = collapsible(mesh, 179.0);
  const CostModel model(CollapseCost::kVolume, work);
  std::vector<std::uint32_t> ring;
  std::vector<std::uint32_t> ringU;
  for (std::uint32_t v = 0; v < mesh.positions.size(); v += 7) {
    work.mesh().ring(v, ring);
    for (const std::uint32_t u : ring) {
      work.mesh().ring(u, ringU);
      const glm::dvec3 to(mesh.positions[u]);
      double volumes = 0.0;
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const double volume = tetrahedronVolume(
            glm::dvec3(mesh.positions[v]),
            glm::dvec3(mesh.positions[ring[i]]),
            glm::dvec3(mesh.positions[ring[(i + 1) % ring.size()]]),
            to);
        volumes += volume * volume;
      }
      const double expected = 0.5 * volumes * static_cast<double>(ring.size() + ringU.size());
      const double length = glm::distance(to, glm::dvec3(mesh.positions[v]));
      const double tieBreaker = 1e-4 * std::pow(length, 6.0);
      const VertexCost vertexCost = model.around(work, v);
      const double cost = model.cost(work, vertexCost, u) / vertexCost.weight;
      EXPECT_GE(cost, expected * (1.0 - 1e-9));
      EXPECT_LE(cost, expected * (1.0 + 1e-9) + tieBreaker);
    }
  }
}

double volumeOf(const CollapseMesh& work) {
  double sum = 0.0;
  for (FaceId f = 0; f < work.mesh().faceCount(); ++f) {
    if (!work.isAlive(f)) continue;
    const auto at = [&](HalfEdgeId k) {
      return glm::dvec3(work.positions()[work.mesh().origin(3 * f + k)]);
    };
    sum += glm::dot(at(0), glm::cross(at(1), at(2))) / 6.0;
  }
  return sum;
}

TEST(CollapseCostTest, PlacedVerticesKeepTheVolume) {
  const TriangleMesh mesh = primitives::bumpySphere(3, 2);
  for (const CollapseCost kind : kCosts) {
    const CollapseMesh work = collapsible(mesh, 179.0);
    const CostModel model(kind, work);
    const double before = volumeOf(work);
    std::vector<std::uint32_t> ring;
    int placedOnes = 0;
    double off = 0.0;
    double offUnplaced = 0.0;
    for (std::uint32_t v = 0; v < mesh.positions.size(); v += 11) {
      work.mesh().ring(v, ring);
      const std::uint32_t u = ring.front();
      const auto placed = model.place(work, model.around(work, v), model.formsAround(work, u));
      const auto plain = work.plan(v, u, work.positions()[u], -1.0);
      if (!placed || !plain) continue;
      const auto collapse = work.plan(v, u, placed->position, -1.0);
      ASSERT_TRUE(collapse);
      CollapseMesh moved = work;
      moved.collapse(*collapse);
      CollapseMesh stayed = work;
      stayed.collapse(*plain);
      // Grid positions are not quite in the plane.
      off += std::abs(volumeOf(moved) - before);
      offUnplaced += std::abs(volumeOf(stayed) - before);
      ++placedOnes;
    }
    EXPECT_GT(placedOnes, 20);
    EXPECT_LT(off, 0.1 * offUnplaced);
  }
}

TEST(CollapseCostTest, VerticesOnBordersAndCreasesAreNotPlaced) {
  const CollapseMesh cube = collapsible(primitives::cube());
  const CollapseMesh sheet = collapsible(primitives::openGrid(3, 3));
  for (const CollapseMesh* work : {&cube, &sheet}) {
    const CostModel model(CollapseCost::kMemoryless, *work);
    std::vector<std::uint32_t> ring;
    for (std::uint32_t v = 0; v < work->positions().size(); ++v) {
      work->mesh().ring(v, ring);
      for (const std::uint32_t u : ring) {
        const VertexCost forms = model.formsAround(*work, u);
        const auto placed = model.place(*work, model.around(*work, v), forms);
        EXPECT_FALSE(placed && (forms.isOnLine || work->mesh().isBorderVertex(u)));
      }
    }
  }
}

TEST(CollapseCostTest, LeavingACreaseOrBorderCostsMoreThanFollowingIt) {
  for (const CollapseCost kind : kCosts) {
    // On a flat sheet only the border can tell collapses apart.
    TriangleMesh sheet = primitives::openGrid(8, 8);
    for (glm::ivec3& p : sheet.positions)
      p.z = 0;
    const CollapseMesh work = collapsible(sheet);
    const CostModel model(kind, work);
    std::uint32_t checked = 0;
    std::vector<std::uint32_t> ring;
    for (std::uint32_t v = 0; v < sheet.positions.size(); ++v) {
      if (!work.mesh().isBorderVertex(v)) continue;
      work.mesh().ring(v, ring);
      if (ring.size() != 4) continue;  // corners, and where the diagonal leads to one
      const double along = model.cost(work, model.around(work, v), ring.front());
      for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
        EXPECT_GT(model.cost(work, model.around(work, v), ring[i]), 10.0 * along)
            << static_cast<int>(kind);
        ++checked;
      }
    }
    EXPECT_GT(checked, 20U);
  }
}

TEST(CollapseCostTest, CostsDoNotDependOnWhereTheMeshLies) {
  for (const CollapseCost kind : kCosts) {
    TriangleMesh mesh = primitives::bumpySphere(2, 5);
    const CollapseMesh here = collapsible(mesh);
    for (glm::ivec3& p : mesh.positions)
      p += glm::ivec3(7000, -3000, 12345);
    const CollapseMesh there = collapsible(mesh);
    const CostModel modelHere(kind, here);
    const CostModel modelThere(kind, there);
    std::vector<std::uint32_t> ring;
    for (std::uint32_t v = 0; v < mesh.positions.size(); v += 5) {
      here.mesh().ring(v, ring);
      for (const std::uint32_t u : ring) {
        const double cost = modelHere.cost(here, modelHere.around(here, v), u);
        EXPECT_NEAR(
            modelThere.cost(there, modelThere.around(there, v), u),
            cost,
            1e-6 * cost + 1e-3);
      }
      EXPECT_EQ(modelHere.around(here, v).weight, modelThere.around(there, v).weight);
    }
  }
}

// Memoryless: the sum over v's planes, spelled out.
TEST(CollapseCostTest, MemorylessCostIsTheQuadricOfTheFacesAround) {
  const TriangleMesh mesh = primitives::bumpySphere(3, 2);
  const CollapseMesh work = collapsible(mesh, 179.0);
  const CostModel model(CollapseCost::kMemoryless, work);
  std::vector<std::uint32_t> ring;
  for (std::uint32_t v = 0; v < mesh.positions.size(); v += 7) {
    work.mesh().ring(v, ring);
    for (const std::uint32_t u : ring) {
      Quadric quadric;
      work.forEachFace(v, [&](HalfEdgeId, std::uint32_t a, std::uint32_t b) {
        const glm::dvec3 normal = work.areaNormal(v, a, b);
        const double length = glm::length(normal);
        quadric.addPlane(normal / length, glm::dvec3(mesh.positions[v]), length / 6.0);
      });
      const double expected = quadric.at(glm::dvec3(mesh.positions[u]));
      const VertexCost vertexCost = model.around(work, v);
      const double cost = model.cost(work, vertexCost, u) / vertexCost.weight;
      const double length =
          glm::distance(glm::dvec3(mesh.positions[u]), glm::dvec3(mesh.positions[v]));
      EXPECT_NEAR(cost, expected, 2e-3 * std::pow(length, 4.0) + 1e-6 * expected);
    }
  }
}

TEST(CollapseCostTest, RegionsThatManyViewsSeeAsSilhouetteWeighMore) {
  const CollapseMesh cube = collapsible(primitives::cube());
  const CostModel cubeModel(CollapseCost::kVolume, cube);
  TriangleMesh sheet = primitives::openGrid(4, 4);
  for (glm::ivec3& p : sheet.positions)
    p.z = 0;
  const CollapseMesh flat = collapsible(sheet);
  const double least = CostModel(CollapseCost::kVolume, flat).around(flat, 5).weight;
  EXPECT_GT(least, 0.0);
  for (std::uint32_t v = 0; v < cube.positions().size(); ++v)
    EXPECT_GT(cubeModel.around(cube, v).weight, least + 0.5);
}

}  // namespace
}  // namespace limn
