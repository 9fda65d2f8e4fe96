// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/hull_codec.h"

#include "server/preprocess/hulls/build_hull.h"

#include "shared/core/rng.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

namespace limn {
namespace {

constexpr std::uint32_t kMaxFaces = 1U << 16;

ProgressiveHull hullOf(const TriangleMesh& mesh, HullSide side, std::uint32_t baseFaces = 60) {
  const auto built = buildHull(mesh, side, {.baseFaces = baseFaces});
  EXPECT_TRUE(built.has_value());
  return built->hull;
}

/// A mesh's triangles by position, each from its least corner on, sorted: numbering set aside.
std::vector<std::array<int, 9>> shapeOf(const TriangleMesh& mesh) {
  std::vector<std::array<int, 9>> shape;
  for (const glm::uvec3& t : mesh.triangles) {
    std::array<std::array<int, 9>, 3> turns{};
    for (int k = 0; k < 3; ++k) {
      for (int c = 0; c < 3; ++c) {
        const glm::ivec3& p = mesh.positions[t[(k + c) % 3]];
        for (int axis = 0; axis < 3; ++axis)
          turns[static_cast<std::size_t>(k)][static_cast<std::size_t>(3 * c + axis)] = p[axis];
      }
    }
    shape.push_back(*std::min_element(turns.begin(), turns.end()));
  }
  std::sort(shape.begin(), shape.end());
  return shape;
}

TEST(HullCodec, EveryPrefixOfPiecesDecodesToThatLevel) {
  for (const TriangleMesh& mesh :
       {primitives::bumpySphere(3, 1), primitives::torus(40, 16), primitives::tetrahedron()}) {
    for (const HullSide side : {HullSide::kOuter, HullSide::kInner}) {
      const ProgressiveHull hull = hullOf(mesh, side);
      const auto encoded = encodeHull(hull);
      ASSERT_TRUE(encoded.has_value()) << encoded.error().message;
      ASSERT_EQ(encoded->pieces.size(), hullPiecesFor(hull.splits.size()));
      auto decoder = HullDecoder::begin(encoded->base, hull.base.grid, kMaxFaces);
      ASSERT_TRUE(decoder.has_value()) << decoder.error().message;
      for (std::size_t n = 0;; ++n) {
        const std::size_t held = decoder->hull().splits.size();
        const auto decoded = hullAfter(decoder->hull(), held);
        const auto original = hullAfter(hull, held);
        ASSERT_TRUE(decoded && original);
        EXPECT_EQ(shapeOf(*decoded), shapeOf(*original));
        EXPECT_TRUE(validate(HullRefiner::fromBase(*decoded)->links()));
        if (n == encoded->pieces.size()) break;
        const auto added = decoder->addPiece(encoded->pieces[n], hull.splits.size() - held);
        ASSERT_TRUE(added.has_value()) << added.error().message;
      }
      EXPECT_EQ(decoder->hull().splits.size(), hull.splits.size());
    }
  }
}

TEST(HullCodec, EveryTruncationIsRefused) {
  const ProgressiveHull hull = hullOf(primitives::bumpySphere(3, 2), HullSide::kOuter, 100);
  const auto encoded = encodeHull(hull);
  ASSERT_TRUE(encoded.has_value());
  for (std::size_t size = 0; size < encoded->base.size(); ++size) {
    EXPECT_FALSE(
        HullDecoder::begin(std::span(encoded->base).first(size), hull.base.grid, kMaxFaces));
  }
  const auto& piece = encoded->pieces[0];
  for (std::size_t size = 0; size < piece.size(); ++size) {
    auto decoder = HullDecoder::begin(encoded->base, hull.base.grid, kMaxFaces);
    ASSERT_TRUE(decoder.has_value());
    EXPECT_FALSE(decoder->addPiece(std::span(piece).first(size), hull.splits.size()))
        << size << " of " << piece.size();
  }
}

TEST(HullCodec, MutationsAreRefusedOrGiveAValidMesh) {
  const ProgressiveHull hull = hullOf(primitives::torus(30, 12), HullSide::kOuter, 100);
  const auto encoded = encodeHull(hull);
  ASSERT_TRUE(encoded.has_value());
  Rng rng(23);
  int taken = 0;
  for (int round = 0; round < 3000; ++round) {
    std::vector<std::uint8_t> piece = encoded->pieces[0];
    for (std::uint32_t i = 0; i <= rng.below(3); ++i)
      piece[rng.below(static_cast<std::uint32_t>(piece.size()))] =
          static_cast<std::uint8_t>(rng.below(256));
    auto decoder = HullDecoder::begin(encoded->base, hull.base.grid, kMaxFaces);
    ASSERT_TRUE(decoder.has_value());
    taken += decoder->addPiece(piece, hull.splits.size()) ? 1 : 0;
    const auto mesh = hullAfter(decoder->hull(), decoder->hull().splits.size());
    ASSERT_TRUE(mesh.has_value());
    EXPECT_TRUE(HullRefiner::fromBase(*mesh));
  }
  EXPECT_LT(taken, 300);
}

TEST(HullCodec, PiecesGrowAndCoverEverySplitOnce) {
  EXPECT_EQ(hullPieceBegin(0), 0U);
  EXPECT_EQ(hullPieceBegin(1), 64U);
  EXPECT_EQ(hullPiecesFor(0), 0U);
  EXPECT_EQ(hullPiecesFor(1), 1U);
  EXPECT_EQ(hullPiecesFor(64), 1U);
  EXPECT_EQ(hullPiecesFor(65), 2U);
  for (std::uint32_t piece = 1; piece < 60; ++piece)
    EXPECT_EQ(hullPiecesFor(hullPieceBegin(piece)), piece);
}

TEST(HullRefiner, RefusesSplitsThatDoNotFit) {
  auto mesh = HullRefiner::fromBase(primitives::cube());
  ASSERT_TRUE(mesh.has_value());
  const HalfEdgeMesh& links = mesh->links();
  const std::uint32_t u = links.origin(0);
  const std::uint32_t l = links.target(0);
  EXPECT_FALSE(mesh->apply({99, 1, 2, {}, {}}));
  EXPECT_FALSE(mesh->apply({u, l, l, {}, {}}));
  std::uint32_t stranger = 0;
  while (stranger == u || links.find(u, stranger) != kNone)
    ++stranger;
  EXPECT_FALSE(mesh->apply({u, l, stranger, {}, {}}));
  const glm::ivec3 far(kMaxHullCoordinate + 1, 0, 0);
  const std::uint32_t r = links.target(links.rotateCcw(0));
  EXPECT_FALSE(mesh->apply({u, l, r, {}, far}));
  EXPECT_EQ(links.faceCount(), 12U);
  EXPECT_TRUE(mesh->apply({u, l, r, {}, {1, 1, 1}}));
  EXPECT_EQ(links.faceCount(), 14U);
  EXPECT_TRUE(validate(links));
}

TEST(HullRefiner, RefusesAnOpenBase) {
  EXPECT_FALSE(HullRefiner::fromBase(primitives::openGrid(3, 3)));
}

}  // namespace
}  // namespace limn
