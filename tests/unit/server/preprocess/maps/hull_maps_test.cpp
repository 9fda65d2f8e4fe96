// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/maps/hull_maps.h"

#include "server/preprocess/maps/corner_normals.h"
#include "server/preprocess/maps/png.h"

#include "shared/core/rng.h"
#include "shared/mesh/closest_point.h"
#include "shared/mesh/primitives.h"
#include "shared/progressive/map_normal.h"
#include "shared/ray/triangle_bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

namespace limn {
namespace {

glm::dmat3 frameOf(const TriangleMesh& hull, std::uint32_t face) {
  const glm::uvec3& t = hull.triangles[face];
  return mapFrame(
      glm::dvec3(hull.positions[t.x]),
      glm::dvec3(hull.positions[t.y]),
      glm::dvec3(hull.positions[t.z]));
}

/// In the texel of a face's corner.
glm::dvec3 normalAt(const HullMaps& map, const TriangleMesh& hull, std::uint32_t face, int corner) {
  const glm::ivec2 texel(map.layout.corner(face, corner));
  const std::size_t at = 2 * static_cast<std::size_t>(texel.y * map.layout.width() + texel.x);
  return decodeMapNormal(frameOf(hull, face), {map.normals[at], map.normals[at + 1]});
}

/// Twice as large about the middle.
TriangleMesh swollen(TriangleMesh mesh) {
  glm::ivec3 low = mesh.positions[0];
  glm::ivec3 high = low;
  for (const glm::ivec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  for (glm::ivec3& p : mesh.positions)
    p = 2 * p - (low + high) / 2;
  return mesh;
}

TEST(MapLayout, TilesLieApartAndInsideTheMap) {
  for (const std::uint32_t faces : {1U, 2U, 7U, 500U}) {
    const MapLayout layout{faces, 6};
    std::set<std::pair<int, int>> used;
    for (std::uint32_t face = 0; face < faces; ++face) {
      for (int v = 0; v < layout.leg; ++v) {
        for (int u = 0; u + v < layout.leg; ++u) {
          const glm::vec2 a = layout.corner(face, 0);
          const float scale = 1.0F / static_cast<float>(layout.leg - 1);
          const glm::vec2 place = a + static_cast<float>(u) * scale * (layout.corner(face, 1) - a) +
                                  static_cast<float>(v) * scale * (layout.corner(face, 2) - a);
          const int x = static_cast<int>(std::floor(place.x));
          const int y = static_cast<int>(std::floor(place.y));
          EXPECT_NEAR(place.x, static_cast<float>(x) + 0.5F, 1e-3F);
          ASSERT_TRUE(x >= 1 && y >= 1 && x + 1 < layout.width() && y + 1 < layout.height());
          ASSERT_TRUE(used.insert({x, y}).second) << face;
        }
      }
    }
  }
}

TEST(HullMaps, OfASphereOverALargerOneIsRadial) {
  const TriangleMesh sphere = primitives::icosphere(5);
  const TriangleMesh hull = swollen(primitives::icosphere(1));
  ASSERT_EQ(hull.grid.step, primitives::icosphere(1).grid.step);
  TriangleMesh onGrid = hull;
  onGrid.grid = sphere.grid;
  const HullMaps map = shootMaps(sphere, onGrid, {.texelsPerFace = 60, .threads = 2});
  EXPECT_EQ(map.misses, 0U);
  for (std::uint32_t face = 0; face < map.layout.faces; ++face) {
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 n = normalAt(map, onGrid, face, k);
      glm::dvec3 middle(0.0);
      for (const glm::ivec3& p : onGrid.positions)
        middle += glm::dvec3(p) / static_cast<double>(onGrid.positions.size());
      const glm::dvec3 out =
          glm::normalize(glm::dvec3(onGrid.positions[onGrid.triangles[face][k]]) - middle);
      EXPECT_GT(glm::dot(n, out), 0.995);
    }
  }
}

TEST(HullMaps, DoesNotDependOnThreads) {
  const TriangleMesh mesh = primitives::bumpySphere(4, 3);
  const TriangleMesh hull = swollen(primitives::icosphere(1));
  TriangleMesh onGrid = hull;
  onGrid.grid = mesh.grid;
  const HullMaps one = shootMaps(mesh, onGrid, {.texelsPerFace = 40, .threads = 1});
  const HullMaps three = shootMaps(mesh, onGrid, {.texelsPerFace = 40, .threads = 3});
  EXPECT_EQ(one.normals, three.normals);
  EXPECT_EQ(one.misses, three.misses);
}

TEST(HullMaps, ARayThatMissesTakesTheClosestPoint) {
  // A hull far to the side: none of its rays meets anything.
  const TriangleMesh mesh = primitives::icosphere(3);
  TriangleMesh hull = primitives::icosphere(0);
  hull.grid = mesh.grid;
  for (glm::ivec3& p : hull.positions)
    p.x += 1 << 18;
  const HullMaps map = shootMaps(mesh, hull, {.texelsPerFace = 30, .threads = 1});
  EXPECT_GT(map.misses, 0U);
  for (std::uint32_t face = 0; face < map.layout.faces; ++face) {
    for (int k = 0; k < 3; ++k)
      EXPECT_GT(normalAt(map, hull, face, k).x, -0.05) << face;  // towards the hull
  }
}

TEST(HullMaps, ColoursAreTheMeshsWhereTheRayMeetsIt) {
  TriangleMesh sphere = primitives::icosphere(5);
  EXPECT_TRUE(
      shootMaps(sphere, swollen(primitives::icosphere(1)), {.texelsPerFace = 20}).colors.empty());
  const auto middleOf = [](const TriangleMesh& mesh) {
    glm::dvec3 middle(0.0);
    for (const glm::ivec3& p : mesh.positions)
      middle += glm::dvec3(p) / static_cast<double>(mesh.positions.size());
    return middle;
  };
  const auto colorTowards = [](const glm::dvec3& direction) {
    return 127.5 + 127.5 * glm::normalize(direction);
  };
  const glm::dvec3 middle = middleOf(sphere);
  for (const glm::ivec3& p : sphere.positions)
    sphere.attributes.colors.emplace_back(glm::round(colorTowards(glm::dvec3(p) - middle)));
  TriangleMesh hull = swollen(primitives::icosphere(1));
  hull.grid = sphere.grid;
  const HullMaps map = shootMaps(sphere, hull, {.texelsPerFace = 60, .threads = 2});
  ASSERT_EQ(map.colors.size(), map.normals.size() / 2 * 3);
  for (std::uint32_t face = 0; face < map.layout.faces; ++face) {
    for (int k = 0; k < 3; ++k) {
      const glm::ivec2 texel(map.layout.corner(face, k));
      const auto at = static_cast<std::size_t>(3 * (texel.y * map.layout.width() + texel.x));
      const glm::dvec3 expected =
          colorTowards(glm::dvec3(hull.positions[hull.triangles[face][k]]) - middleOf(hull));
      for (int channel = 0; channel < 3; ++channel) {
        const std::uint8_t code = map.colors[at + static_cast<std::size_t>(channel)];
        ASSERT_LE(code, kMapColorSteps);
        EXPECT_NEAR(code * 255.0 / kMapColorSteps, expected[channel], 8.0);
      }
    }
  }
}

TEST(CornerNormals, KeepCreasesAndSmoothTheRest) {
  const TriangleMesh box = primitives::cube();
  const auto sharp = cornerNormals(box, 40.0);
  for (const glm::vec3& n : sharp)
    EXPECT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1.0F, 1e-5F);
  const auto smooth = cornerNormals(box, 180.0);
  for (const glm::vec3& n : smooth)
    EXPECT_LT(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 0.9F);
}

TEST(TriangleBvh, TheClosestPointIsTheNearestOfAllFaces) {
  const TriangleMesh mesh = primitives::bumpySphere(4, 3);
  const TriangleBvh tree(mesh.positions, mesh.triangles);
  Rng rng(5);
  for (int round = 0; round < 200; ++round) {
    const auto any = [&rng] { return static_cast<double>(rng.below(40'000)) - 12'000.0; };
    const glm::dvec3 p(any(), any(), any());
    double best = 1e300;
    for (const glm::uvec3& t : mesh.triangles) {
      const auto corner = [&](int k) { return glm::dvec3(mesh.positions[t[k]]); };
      best = std::min(
          best,
          glm::distance(p, closestPointOnTriangle(p, corner(0), corner(1), corner(2))));
    }
    const auto found = tree.closest(p);
    ASSERT_TRUE(found);
    EXPECT_NEAR(glm::distance(p, found->point), best, 1e-9 * (1.0 + best));
  }
}

TEST(MapNormal, IsWhatWasEncodedToTwoDegreesInAnyFrame) {
  // Half a step in both coordinates moves a point of the octahedron, which is at least 1 / √3 from
  // the middle, by at most √6 / 126.
  const double most = std::sqrt(6.0) / 126.0 * std::sqrt(3.0);
  Rng rng(4);
  const auto any = [&rng] {
    return glm::normalize(
        glm::dvec3(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5));
  };
  for (int round = 0; round < 5000; ++round) {
    const glm::dmat3 frame = mapFrame(100.0 * any(), 100.0 * any(), 100.0 * any());
    const glm::dvec3 normal = any();
    const auto code = encodeMapNormal(frame, normal);
    EXPECT_GE(std::min(code[0], code[1]), 1);
    EXPECT_LE(std::max(code[0], code[1]), 127);
    EXPECT_GT(glm::dot(decodeMapNormal(frame, code), normal), std::cos(most));
  }
  const glm::dmat3 frame = mapFrame({0, 0, 0}, {0, 2, 0}, {0, 0, 3});
  EXPECT_EQ(encodeMapNormal(frame, {1, 0, 0}), (std::array<std::uint8_t, 2>{64, 64}));
  EXPECT_EQ(decodeMapNormal(frame, {127, 64}), glm::dvec3(0, 1, 0));
  EXPECT_EQ(decodeMapNormal(frame, {64, 127}), glm::dvec3(0, 0, 1));
}

TEST(MapNormal, OfAnyTwoBytesOrAFaceWithoutAreaIsUnit) {
  const glm::dmat3 frame = mapFrame({1, 1, 1}, {1, 1, 1}, {1, 1, 1});
  for (int a = 0; a < 256; ++a) {
    for (int b = 0; b < 256; ++b) {
      const glm::dvec3 n =
          decodeMapNormal(frame, {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)});
      ASSERT_NEAR(glm::length(n), 1.0, 1e-9) << a << " " << b;
    }
  }
}

TEST(Png, StartsAsOneAndPacksWhatRepeats) {
  for (int channels = 1; channels <= 4; ++channels) {
    const std::vector<std::uint8_t> texels(static_cast<std::size_t>(channels) * 400 * 200, 77);
    const auto bytes = encodePng(400, 200, channels, texels);
    ASSERT_GT(bytes.size(), 8U);
    EXPECT_EQ(bytes[1], 'P');
    EXPECT_LT(bytes.size(), 1000U);
  }
}

}  // namespace
}  // namespace limn
