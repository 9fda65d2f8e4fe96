// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's Polygon Mesh Processing as the oracle: it must accept what repair makes, and agree about
// which way is outward. GPL because of it.
#include "server/preprocess/repair/repair.h"

#include "shared/core/rng.h"
#include "shared/mesh/primitives.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

namespace limn {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
namespace pmp = CGAL::Polygon_mesh_processing;

struct Soup {
  std::vector<Kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> faces;
};

Soup soupOf(const TriangleMesh& mesh) {
  Soup soup;
  for (const glm::ivec3& p : mesh.positions)
    soup.points.emplace_back(p.x, p.y, p.z);
  for (const glm::uvec3& t : mesh.triangles)
    soup.faces.push_back({t.x, t.y, t.z});
  return soup;
}

ImportedMesh shuffled(const TriangleMesh& mesh, std::uint64_t seed) {
  Rng rng(seed);
  ImportedMesh input;
  input.format = "obj";
  for (const glm::ivec3& p : mesh.positions)
    input.positions.emplace_back(p);
  for (glm::uvec3 t : mesh.triangles) {
    if (rng.below(3) == 0) std::swap(t.x, t.y);
    for (int k = 0; k < 3; ++k)
      input.corners.push_back(t[k]);
    input.polygonBegin.push_back(static_cast<std::uint32_t>(input.corners.size()));
  }
  return input;
}

TEST(RepairAgainstCgal, ResultsAreOutwardOrientedMeshes) {
  for (const TriangleMesh& shape :
       {primitives::torus(15, 9),
        primitives::bumpySphere(2, 3),
        primitives::torusKnot(2, 3, 60, 8)}) {
    const auto result = repairMesh(shuffled(shape, 17), {});
    ASSERT_TRUE(result.has_value());
    const Soup soup = soupOf(result->mesh);
    ASSERT_TRUE(pmp::is_polygon_soup_a_polygon_mesh(soup.faces));
    Surface surface;
    pmp::polygon_soup_to_polygon_mesh(soup.points, soup.faces, surface);
    EXPECT_TRUE(CGAL::is_closed(surface));
    EXPECT_TRUE(pmp::is_outward_oriented(surface));
  }
}

TEST(RepairAgainstCgal, RandomSoupsBecomePolygonMeshes) {
  Rng rng(23);
  for (int trial = 0; trial < 300; ++trial) {
    ImportedMesh input;
    input.format = "obj";
    for (int v = 0; v < 12; ++v)
      input.positions.emplace_back(rng.below(3), rng.below(3), rng.below(3));
    for (std::uint32_t f = 5 + rng.below(40); f > 0; --f) {
      for (int k = 0; k < 3; ++k)
        input.corners.push_back(rng.below(12));
      input.polygonBegin.push_back(static_cast<std::uint32_t>(input.corners.size()));
    }
    const auto result = repairMesh(input, {.quantizationBits = 11});
    if (!result) continue;
    EXPECT_TRUE(pmp::is_polygon_soup_a_polygon_mesh(soupOf(result->mesh).faces))
        << "trial " << trial;
  }
}

}  // namespace
}  // namespace limn
