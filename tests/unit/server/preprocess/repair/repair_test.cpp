// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/repair/repair.h"

#include "server/preprocess/repair/repair_steps.h"
#include "tests/unit/server/preprocess/import/mesh_files.h"

#include "shared/core/integer_vectors.h"
#include "shared/core/rng.h"
#include "shared/mesh/half_edge.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace limn {
namespace {

using Polygons = std::vector<std::vector<std::uint32_t>>;

ImportedMesh made(std::vector<glm::dvec3> positions, const Polygons& polygons) {
  ImportedMesh mesh;
  mesh.format = "obj";
  mesh.positions = std::move(positions);
  for (const auto& polygon : polygons) {
    mesh.corners.insert(mesh.corners.end(), polygon.begin(), polygon.end());
    mesh.polygonBegin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  return mesh;
}

ImportedMesh made(const TriangleMesh& mesh) {
  std::vector<glm::dvec3> positions;
  for (const glm::ivec3& p : mesh.positions)
    positions.push_back(mesh.grid.toModel(p));
  Polygons polygons;
  for (const glm::uvec3& t : mesh.triangles)
    polygons.push_back({t.x, t.y, t.z});
  return made(std::move(positions), polygons);
}

/// Both in one: `b`'s vertices after `a`'s.
ImportedMesh joined(ImportedMesh a, const ImportedMesh& b) {
  const auto offset = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  const auto corners = static_cast<std::uint32_t>(a.corners.size());
  for (const std::uint32_t corner : b.corners)
    a.corners.push_back(corner + offset);
  for (std::size_t p = 1; p < b.polygonBegin.size(); ++p)
    a.polygonBegin.push_back(corners + b.polygonBegin[p]);
  return a;
}

ImportedMesh scaled(ImportedMesh mesh, double scale, glm::dvec3 offset = glm::dvec3(0)) {
  for (glm::dvec3& p : mesh.positions)
    p = p * scale + offset;
  return mesh;
}

ImportedMesh insideOut(ImportedMesh mesh) {
  for (std::size_t p = 0; p + 1 < mesh.polygonBegin.size(); ++p) {
    std::reverse(
        mesh.corners.begin() + mesh.polygonBegin[p],
        mesh.corners.begin() + mesh.polygonBegin[p + 1]);
  }
  return mesh;
}

/// A unit cube of 12 triangles about the origin.
ImportedMesh cube() {
  ImportedMesh mesh = made(primitives::cube());
  glm::dvec3 low(1e9);
  glm::dvec3 high(-1e9);
  for (const glm::dvec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  for (glm::dvec3& p : mesh.positions)
    p = (p - 0.5 * (low + high)) / (high.x - low.x);
  return mesh;
}

std::uint64_t count(const RepairedMesh& mesh, const char* kind) {
  const auto found = mesh.repairs.find(kind);
  return found == mesh.repairs.end() ? 0 : found->second;
}

/// Repairs and checks what every result must be.
RepairedMesh repaired(const ImportedMesh& input, int bits = 14) {
  auto result = repairMesh(input, {.quantizationBits = bits});
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().message);
  if (!result) return {};
  const auto linked = HalfEdgeMesh::build(
      static_cast<std::uint32_t>(result->mesh.positions.size()),
      result->mesh.triangles);
  EXPECT_TRUE(linked.has_value()) << (linked ? "" : linked.error().message);
  if (!linked) return {};
  EXPECT_TRUE(validate(*linked).has_value());
  EXPECT_EQ(std::count(linked->outgoing.begin(), linked->outgoing.end(), kNone), 0)
      << "isolated vertices";
  EXPECT_EQ(result->closed, std::count(linked->twins.begin(), linked->twins.end(), kNone) == 0);
  EXPECT_EQ(
      result->mesh.positions.size(),
      result->inputVertices - count(*result, "dropped_vertices") -
          count(*result, "merged_vertices") + count(*result, "split_vertices"));
  return *result;
}

double volume(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const auto at = [&](int k) { return mesh.grid.toModel(mesh.positions[t[k]]); };
    sum += glm::dot(at(0), glm::cross(at(1), at(2))) / 6.0;
  }
  return sum;
}

TEST(Repair, LeavesAGoodMeshAsItIs) {
  for (const TriangleMesh& shape :
       {primitives::torus(20, 9), primitives::bumpySphere(3, 7), primitives::openGrid(9, 7)}) {
    const RepairedMesh result = repaired(made(shape));
    EXPECT_TRUE(result.repairs.empty());
    EXPECT_EQ(result.mesh.triangles, shape.triangles);
    EXPECT_EQ(result.inputVertices, shape.positions.size());
    EXPECT_EQ(result.inputFaces, shape.triangles.size());
    EXPECT_EQ(result.inputComponents, 1U);
    EXPECT_EQ(result.inputClosed, result.closed);
  }
}

TEST(Repair, QuantisesToTheNearestGridPoint) {
  for (const int bits : {11, 14, 18}) {
    const ImportedMesh input =
        scaled(made(primitives::icosphere(2)), 0.37, glm::dvec3(1e5, -3, 0.1));
    const RepairedMesh result = repaired(input, bits);
    const Grid& grid = result.mesh.grid;
    EXPECT_EQ(grid.bits, bits);
    glm::ivec3 high(0);
    ASSERT_EQ(result.mesh.positions.size(), input.positions.size());
    for (std::size_t v = 0; v < input.positions.size(); ++v) {
      const glm::dvec3 off =
          glm::abs(grid.fromModel(input.positions[v]) - glm::dvec3(result.mesh.positions[v]));
      EXPECT_LE(std::max({off.x, off.y, off.z}), 0.5 + 1e-6);
      EXPECT_GE(
          std::min(
              {result.mesh.positions[v].x, result.mesh.positions[v].y, result.mesh.positions[v].z}),
          0);
      high = glm::max(high, result.mesh.positions[v]);
    }
    EXPECT_EQ(std::max({high.x, high.y, high.z}), (1 << bits) - 1);
  }
  EXPECT_EQ(repairMesh(cube(), {.quantizationBits = 19}).error().code, ErrorCode::kInvalidArgument);
}

TEST(Repair, MergesSoup) {
  const TriangleMesh shape = primitives::torus(11, 8);
  ImportedMesh soup;
  soup.format = "stl";
  for (const glm::uvec3& t : shape.triangles) {
    for (int k = 0; k < 3; ++k) {
      soup.corners.push_back(static_cast<std::uint32_t>(soup.positions.size()));
      soup.positions.push_back(shape.grid.toModel(shape.positions[t[k]]));
    }
    soup.polygonBegin.push_back(static_cast<std::uint32_t>(soup.corners.size()));
  }
  const RepairedMesh result = repaired(soup);
  EXPECT_EQ(testing::oriented(result.mesh), testing::oriented(shape));
  EXPECT_EQ(count(result, "merged_vertices"), soup.positions.size() - shape.positions.size());
  EXPECT_TRUE(result.inputClosed);  // STL stores each corner anew
  EXPECT_EQ(result.inputComponents, 1U);
}

TEST(Repair, DropsNonFiniteCornersAndUnreferencedVertices) {
  ImportedMesh mesh = cube();
  mesh.positions.emplace_back(1e9, 1e9, 1e9);  // must not stretch the grid
  mesh.positions.emplace_back(std::nan(""), 0, 0);
  mesh.positions.emplace_back(0, std::numeric_limits<double>::infinity(), 0);
  for (const std::uint32_t bad : {9U, 10U, 77U}) {
    for (const std::uint32_t corner : {0U, 1U, bad})
      mesh.corners.push_back(corner);
    mesh.polygonBegin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  mesh.droppedFaces = 4;
  const RepairedMesh result = repaired(mesh);
  EXPECT_EQ(count(result, "dropped_faces"), 7U);
  EXPECT_EQ(count(result, "dropped_vertices"), 3U);
  EXPECT_TRUE(result.closed);
  EXPECT_NEAR(result.mesh.grid.step, 1.0 / 16383, 1e-12);
}

TEST(Repair, ExtremesOfScaleLoadAndNothingIsRefused) {
  for (const double scale : {1e-300, 1e-36, 1e38, 1e300}) {
    EXPECT_EQ(repaired(scaled(cube(), scale)).mesh.triangles, repaired(cube()).mesh.triangles)
        << scale;
  }
  EXPECT_EQ(repairMesh(scaled(cube(), 0.0), {}).error().code, ErrorCode::kCorrupt);
  EXPECT_EQ(repairMesh(scaled(cube(), 1e-310), {}).error().code, ErrorCode::kCorrupt);
  ImportedMesh wide = cube();
  for (glm::dvec3& p : wide.positions)
    p = 2.0 * p * 1.5e308;
  EXPECT_EQ(repairMesh(wide, {}).error().code, ErrorCode::kCorrupt);
  EXPECT_EQ(repairMesh(ImportedMesh{}, {}).error().code, ErrorCode::kCorrupt);
}

TEST(Repair, AlignsShuffledOrientationWithTheOriginal) {
  for (const TriangleMesh& shape : {primitives::torus(24, 10), primitives::icosphere(3)}) {
    Rng rng(5);
    ImportedMesh shuffled = made(shape);
    std::uint64_t turned = 0;
    for (std::size_t f = 0; f < shape.triangles.size(); ++f) {
      if (rng.below(2) == 0) continue;
      std::swap(shuffled.corners[3 * f], shuffled.corners[3 * f + 1]);
      ++turned;
    }
    const RepairedMesh result = repaired(shuffled);
    EXPECT_EQ(testing::oriented(result.mesh), testing::oriented(shape));
    EXPECT_EQ(count(result, "flipped"), turned);
  }
}

TEST(Repair, TurnsClosedComponentsOutward) {
  const RepairedMesh result = repaired(insideOut(cube()));
  EXPECT_NEAR(volume(result.mesh), 1.0, 1e-3);
  EXPECT_EQ(count(result, "flipped"), 12U);
  const RepairedMesh both =
      repaired(joined(cube(), scaled(insideOut(cube()), 1.0, glm::dvec3(5, 0, 0))));
  EXPECT_NEAR(volume(both.mesh), 2.0, 1e-2);
}

TEST(Repair, KeepsCavitiesInward) {
  // A box with a hollow, as the file has it and inside out; and a solid within a solid.
  const ImportedMesh hollow = joined(scaled(cube(), 4.0), insideOut(cube()));
  EXPECT_NEAR(volume(repaired(hollow).mesh), 63.0, 0.1);
  EXPECT_EQ(count(repaired(hollow), "flipped"), 0U);
  EXPECT_NEAR(volume(repaired(insideOut(hollow)).mesh), 63.0, 0.1);
  EXPECT_NEAR(volume(repaired(joined(scaled(cube(), 4.0), cube())).mesh), 65.0, 0.1);
  // In the notch of a torus, not in its solid: no cavity.
  const ImportedMesh ring = scaled(made(primitives::torus(32, 16)), 1.0);
  glm::dvec3 low(1e9);
  glm::dvec3 high(-1e9);
  for (const glm::dvec3& p : ring.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const double size = 0.02 * (high.x - low.x);
  const ImportedMesh beside = joined(ring, scaled(insideOut(cube()), size, 0.5 * (low + high)));
  EXPECT_EQ(count(repaired(beside), "flipped"), 12U);
}

TEST(Repair, SplitsTouchingSolidsApart) {
  const ImportedMesh other = cube();
  // Sharing one corner, one edge: each cube stays closed.
  for (const glm::dvec3 offset : {glm::dvec3(1, 1, 1), glm::dvec3(1, 1, 0)}) {
    const RepairedMesh result = repaired(joined(cube(), scaled(other, 1.0, offset)));
    EXPECT_TRUE(result.closed);
    EXPECT_EQ(result.mesh.triangles.size(), 24U);
    EXPECT_EQ(result.mesh.positions.size(), 16U);
    EXPECT_NEAR(volume(result.mesh), 2.0, 1e-2);
  }
}

TEST(Repair, StacksWithACommonFaceLoseTheWallBetween) {
  // The two sides of the common square cancel: a membrane inside a solid that is closed without it.
  const RepairedMesh result = repaired(joined(cube(), scaled(cube(), 1.0, glm::dvec3(1, 0, 0))));
  EXPECT_TRUE(result.closed);
  EXPECT_NEAR(volume(result.mesh), 2.0, 1e-2);
}

TEST(Repair, ThreeFacesOnOneEdgeBecomeSheets) {
  const RepairedMesh result = repaired(made(
      {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}},
      {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
  EXPECT_EQ(result.mesh.triangles.size(), 3U);
  EXPECT_EQ(count(result, "split_vertices"), 2U);
}

TEST(Repair, MoebiusBandIsCutOpen) {
  constexpr std::uint32_t kSegments = 20;
  std::vector<glm::dvec3> positions;
  Polygons quads;
  for (std::uint32_t i = 0; i < kSegments; ++i) {
    const double a = 2.0 * std::numbers::pi * i / kSegments;
    for (const double side : {-0.4, 0.4}) {
      const double r = 2.0 + side * std::cos(a / 2);
      positions.emplace_back(r * std::cos(a), r * std::sin(a), side * std::sin(a / 2));
    }
    const std::uint32_t j = (i + 1) % kSegments;
    const bool last = j == 0;
    quads.push_back({2 * i, 2 * j + (last ? 1 : 0), 2 * j + (last ? 0 : 1), 2 * i + 1});
  }
  const RepairedMesh result = repaired(made(positions, quads));
  EXPECT_EQ(result.mesh.triangles.size(), 2U * kSegments);
  EXPECT_EQ(count(result, "split_vertices"), 2U);
  EXPECT_FALSE(result.closed);
}

TEST(Repair, DropsCopiesWhateverTheirOrientation) {
  for (const bool reversed : {false, true}) {
    ImportedMesh mesh = cube();
    ImportedMesh copy = mesh;
    copy.corners.resize(15);
    copy.polygonBegin.resize(6);
    if (reversed) copy = insideOut(copy);
    for (std::size_t p = 1; p < copy.polygonBegin.size(); ++p)
      mesh.polygonBegin.push_back(36 + copy.polygonBegin[p]);
    mesh.corners.insert(mesh.corners.end(), copy.corners.begin(), copy.corners.end());
    const RepairedMesh result = repaired(mesh);
    EXPECT_EQ(count(result, "dropped_faces"), 5U);
    EXPECT_TRUE(result.closed);
    EXPECT_NEAR(volume(result.mesh), 1.0, 1e-3);
  }
}

TEST(Repair, ADoubleSidedSheetKeepsOneSide) {
  const RepairedMesh result =
      repaired(made({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}, {3, 2, 1, 0}}));
  EXPECT_EQ(result.mesh.triangles.size(), 2U);
  EXPECT_EQ(count(result, "dropped_faces"), 2U);
}

TEST(Repair, ASliverThatCollapsesLeavesTheSurfaceClosed) {
  // One face is cut in two at m, and a fin stands in the cut, from a over m to b and back; its tip
  // merges with m on the grid.
  ImportedMesh mesh = cube();
  const std::uint32_t a = mesh.corners[0];
  const std::uint32_t b = mesh.corners[1];
  const std::uint32_t c = mesh.corners[2];
  const glm::dvec3 middle = (mesh.positions[a] + mesh.positions[b]) * 0.5;
  mesh.positions.push_back(middle);
  mesh.positions.push_back(middle + glm::dvec3(1e-9));
  mesh.corners.erase(mesh.corners.begin(), mesh.corners.begin() + 3);
  for (const std::uint32_t corner : {a, 8U, c, 8U, b, c, a, 9U, 8U, 8U, 9U, b, a, b, 9U})
    mesh.corners.push_back(corner);
  mesh.polygonBegin.clear();
  for (std::uint32_t f = 0; f <= mesh.corners.size() / 3; ++f)
    mesh.polygonBegin.push_back(3 * f);
  const RepairedMesh result = repaired(mesh);
  EXPECT_TRUE(result.inputClosed);
  EXPECT_TRUE(result.closed);
}

// Triangulation: the area of the parts is the area of the whole, and none is turned over.
TEST(Triangulate, ConcavePolygonsAreFilledExactlyOnce) {
  Rng rng(11);
  for (int trial = 0; trial < 60; ++trial) {
    const std::uint32_t n = 4 + rng.below(60);
    std::vector<glm::ivec3> positions;
    std::vector<std::uint32_t> corners;
    for (std::uint32_t i = 0; i < n; ++i) {
      const double a = 2.0 * std::numbers::pi * i / n;
      const double r = 1000.0 + 7000.0 * rng.uniform();
      const int x = 8192 + static_cast<int>(r * std::cos(a));
      const int y = 8192 + static_cast<int>(r * std::sin(a));
      positions.emplace_back(x, y, x / 2 + y / 4);
      corners.push_back(i);
    }
    if (trial % 2 == 1) std::reverse(corners.begin(), corners.end());
    std::vector<glm::uvec3> triangles;
    repair::triangulatePolygon(positions, corners, triangles);
    ASSERT_EQ(triangles.size(), n - 2);
    const auto area2 = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      return crossExact(
                 glm::i64vec3(positions[b] - positions[a]),
                 glm::i64vec3(positions[c] - positions[a]))
          .z;
    };
    std::int64_t whole = 0;
    for (std::uint32_t i = 1; i + 1 < n; ++i)
      whole += area2(corners[0], corners[i], corners[i + 1]);
    std::int64_t parts = 0;
    for (const glm::uvec3& t : triangles) {
      EXPECT_GE(area2(t.x, t.y, t.z) * (whole > 0 ? 1 : -1), 0);
      parts += area2(t.x, t.y, t.z);
    }
    EXPECT_EQ(parts, whole);
  }
}

TEST(Triangulate, BridgedHolesAreEarClipped) {
  // A square with a square hole, joined by a bridge that the outline walks twice.
  const std::vector<glm::ivec3> positions{
      {0, 0, 0},
      {90, 0, 0},
      {90, 90, 0},
      {0, 90, 0},
      {30, 30, 0},
      {30, 60, 0},
      {60, 60, 0},
      {60, 30, 0}};
  const std::vector<std::uint32_t> corners{0, 1, 2, 3, 0, 4, 5, 6, 7, 4};
  std::vector<glm::uvec3> triangles;
  repair::triangulatePolygon(positions, corners, triangles);
  std::int64_t area2 = 0;
  for (const glm::uvec3& t : triangles) {
    const std::int64_t part = crossExact(
                                  glm::i64vec3(positions[t.y] - positions[t.x]),
                                  glm::i64vec3(positions[t.z] - positions[t.x]))
                                  .z;
    EXPECT_GE(part, 0);
    area2 += part;
  }
  EXPECT_EQ(area2, 2 * (90 * 90 - 30 * 30));
}

TEST(Triangulate, CrossingOutlinesStillGiveFaces) {
  const RepairedMesh result =
      repaired(made({{0, 0, 0}, {4, 4, 0}, {4, 0, 0}, {0, 4, 0}, {2, 5, 1}}, {{0, 1, 2, 3, 4}}));
  EXPECT_EQ(result.mesh.triangles.size(), 3U);
  EXPECT_EQ(count(result, "triangulated"), 1U);
}

// Whatever the input: a valid oriented manifold, the same each time. Few places and many faces make
// every kind of contact there is.
TEST(Repair, AnySoupBecomesAManifoldDeterministically) {
  Rng rng(3);
  for (int trial = 0; trial < 1500; ++trial) {
    const std::uint32_t side = 2 + rng.below(3);
    const std::uint32_t vertices = 3 + rng.below(20);
    std::vector<glm::dvec3> positions;
    for (std::uint32_t v = 0; v < vertices; ++v)
      positions.emplace_back(rng.below(side), rng.below(side), rng.below(side));
    Polygons polygons(1 + rng.below(60));
    for (auto& polygon : polygons) {
      for (std::uint32_t k = rng.below(8) == 0 ? 3 + rng.below(6) : 3; k > 0; --k)
        polygon.push_back(rng.below(vertices));
    }
    const ImportedMesh soup = made(positions, polygons);
    if (!repairMesh(soup, {.quantizationBits = 11})) continue;  // nothing but degenerate faces
    const RepairedMesh once = repaired(soup, 11);
    const RepairedMesh again = repaired(soup, 11);
    ASSERT_EQ(once.mesh.triangles, again.mesh.triangles);
    ASSERT_EQ(once.repairs, again.repairs);
    ASSERT_FALSE(HasFailure()) << "trial " << trial;
  }
}

}  // namespace
}  // namespace limn
