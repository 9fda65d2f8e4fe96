// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain/crease_noise.h"

#include "shared/mesh/feature_edges.h"
#include "shared/mesh/primitives.h"
#include "shared/progressive/vertex_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

namespace limn {
namespace {

constexpr int kCells = 160;
constexpr int kCell = 64;  // grid units

HalfEdgeMesh link(const TriangleMesh& mesh) {
  auto linked =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  EXPECT_TRUE(linked);
  return std::move(*linked);
}

/// A square field of cells, as high as `heightOf(column, row)` has it, in cells.
template <class Height>
TriangleMesh field(Height heightOf) {
  TriangleMesh mesh;
  for (int y = 0; y <= kCells; ++y) {
    for (int x = 0; x <= kCells; ++x) {
      mesh.positions.emplace_back(
          kCell * x,
          kCell * y,
          static_cast<int>(std::lround(kCell * (20.0 + heightOf(x, y)))));
    }
  }
  const auto at = [](int x, int y) { return static_cast<std::uint32_t>(y * (kCells + 1) + x); };
  for (int y = 0; y < kCells; ++y) {
    for (int x = 0; x < kCells; ++x) {
      mesh.triangles.emplace_back(at(x, y), at(x + 1, y), at(x + 1, y + 1));
      mesh.triangles.emplace_back(at(x, y), at(x + 1, y + 1), at(x, y + 1));
    }
  }
  return mesh;
}

std::size_t creasesLeft(const TriangleMesh& shape) {
  const HalfEdgeMesh mesh = link(shape);
  const std::vector<std::uint8_t> features = findCreases(mesh, shape.positions, 40.0);
  EXPECT_TRUE(std::any_of(features.begin(), features.end(), [](auto f) { return f != 0; }));
  const std::vector<std::uint8_t> kept = withoutNoise(mesh, shape.positions, features);
  return static_cast<std::size_t>(
      std::count_if(kept.begin(), kept.end(), [](auto f) { return (f & kFeatureCrease) != 0; }));
}

/// 1 around the field's middle row, 0 from so many rows away on.
double share(int y, int rows) {
  return std::clamp((rows - std::abs(y - kCells / 2)) / 4.0, 0.0, 1.0);
}

TEST(CreaseNoise, ASpeckOfACreaseIsNoise) {
  const TriangleMesh round = primitives::bumpySphere(5, 3);
  const HalfEdgeMesh mesh = link(round);
  std::vector<std::uint8_t> speck(mesh.origins.size(), 0);
  speck[0] = speck[mesh.twin(0)] = kFeatureCrease | kFeatureSeam;
  EXPECT_EQ(withoutNoise(mesh, round.positions, speck)[0], kFeatureSeam);
  EXPECT_TRUE(withoutNoise(mesh, round.positions, {}).empty());
}

TEST(CreaseNoise, EdgesOfASolidAreNone) {
  const TriangleMesh cube = primitives::cube();
  const HalfEdgeMesh mesh = link(cube);
  const std::vector<std::uint8_t> features = findCreases(mesh, cube.positions, 40.0);
  EXPECT_EQ(withoutNoise(mesh, cube.positions, features), features);
}

TEST(CreaseNoise, AStepWithinASurfaceThatGoesOnAroundItIsNoise) {
  // Sharp above, softly running out below.
  EXPECT_EQ(
      creasesLeft(field([](int x, int y) {
        return 1.2 * share(y, 8) * std::exp(-1.4 * std::max(0, kCells / 2 - x));
      })),
      0U);
}

TEST(CreaseNoise, AnEdgeThatComesInUnjoinedPiecesIsNone) {
  // A roof in strips of two columns, each with vertices of its own.
  const TriangleMesh roof = field([](int, int y) { return -std::abs(y - kCells / 2); });
  TriangleMesh strips;
  std::map<std::pair<int, std::uint32_t>, std::uint32_t> copies;
  for (const glm::uvec3& t : roof.triangles) {
    int column = kCells;
    for (int k = 0; k < 3; ++k)
      column = std::min(column, roof.positions[t[k]].x / kCell);
    glm::uvec3 copy(0);
    for (int k = 0; k < 3; ++k) {
      const auto [known, isNew] = copies.try_emplace(
          {column / 2, t[k]},
          static_cast<std::uint32_t>(strips.positions.size()));
      if (isNew) strips.positions.push_back(roof.positions[t[k]]);
      copy[k] = known->second;
    }
    strips.triangles.push_back(copy);
  }
  const HalfEdgeMesh mesh = link(strips);
  const std::vector<std::uint8_t> features = findCreases(mesh, strips.positions, 40.0);
  const Cracks cracks = findCracks(mesh, strips.positions);
  EXPECT_EQ(std::ranges::count(features, kFeatureCrease), 2 * kCells);
  EXPECT_EQ(std::ranges::count(withoutNoise(mesh, strips.positions, features), kFeatureCrease), 0);
  EXPECT_EQ(withoutNoise(mesh, strips.positions, features, cracks.kinds), features);
}

TEST(CreaseNoise, ARidgeThatRunsOutIsNone) {
  EXPECT_GT(
      creasesLeft(field([](int x, int y) {
        return share(y, 12) * std::max(0.0, 10.0 - 0.8 * std::abs(x - kCells / 2));
      })),
      40U);
}

}  // namespace
}  // namespace limn
