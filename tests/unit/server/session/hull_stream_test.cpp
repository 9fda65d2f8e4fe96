// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/hull_sections.h"
#include "tests/unit/server/session/session_link.h"

#include "protocol/messages.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

using protocol::GetHull;
using protocol::WireError;

constexpr protocol::HullSide kOuterSide = protocol::HullSide::kOuter;
constexpr protocol::HullSide kInnerSide = protocol::HullSide::kInner;

const Hulls& hulls() {
  static const Hulls built = buildHulls(primitives::torus(40, 20), {.baseFaces = 60}, 1);
  return built;
}

TriangleMesh paintedTorus() {
  TriangleMesh mesh = primitives::torus(40, 20);
  for (const glm::ivec3& p : mesh.positions)
    mesh.attributes.colors.emplace_back(p.x % 256, p.y % 256, p.z % 256);
  return mesh;
}

/// A torus with its hulls, and maps of a painted one.
std::shared_ptr<const Model> hulledModel() {
  const auto sections = encodeHullSections(hulls());
  EXPECT_TRUE(sections->reason.empty()) << sections->reason;
  const MapSections maps =
      encodeMapSections(paintedTorus(), *sections, 100, {.texelsPerFace = 200, .threads = 1});
  auto model = Model::load(memoryAssetOf(primitives::torus(40, 20), 7, 60, sections.get(), &maps));
  EXPECT_TRUE(model) << model.error().message;
  return *model;
}

class HullLink : public ::testing::Test {
 protected:
  HullLink() {
    link_.models_.add("hulled", hulledModel());
    link_.hello();
    link_.open("hulled");
    link_.settle();
  }

  [[nodiscard]] std::size_t splitsOf(protocol::HullSide side) {
    const auto hull = link_.decoder().hulls().hull(side);
    return hull ? hull->splits.size() : 0;
  }

  Link link_;
};

TEST_F(HullLink, SendsNoHullThatNobodyAskedFor) {
  EXPECT_EQ(link_.decoder().hulls().held(kOuterSide), 0U);
  ASSERT_TRUE(link_.decoder().model().hull.has_value());
  EXPECT_EQ(link_.decoder().model().hull->outer.baseFaces, hulls().outer->hull.facesAfter(0));
}

TEST_F(HullLink, SendsWhatWasAskedForAndGoesOnFromThere) {
  link_.send(GetHull{0, kOuterSide, 10, 0});
  link_.settle();
  EXPECT_EQ(link_.decoder().hulls().held(kOuterSide), 1U);
  EXPECT_EQ(splitsOf(kOuterSide), 0U);
  link_.send(GetHull{0, kOuterSide, 300, 1});
  link_.send(GetHull{0, kInnerSide, 100'000, 0});
  link_.settle();
  EXPECT_TRUE(link_.decoder().hulls().isThere(kOuterSide, 300, link_.decoder().model()));
  EXPECT_LT(splitsOf(kOuterSide), hulls().outer->hull.splits.size());
  EXPECT_EQ(splitsOf(kInnerSide), hulls().inner->hull.splits.size());
  EXPECT_TRUE(link_.failures_.empty());
}

TEST_F(HullLink, CountsAgainstTheWindow) {
  const std::uint64_t before = link_.payload_;
  link_.send(GetHull{0, kOuterSide, 300, 0});
  link_.settle();
  EXPECT_GT(link_.payload_, before);
}

TEST_F(HullLink, RefusesToGoOnFromWhereNothingIs) {
  link_.send(GetHull{0, kOuterSide, 300, 4000});
  link_.settle();
  ASSERT_EQ(link_.failures_.size(), 1U);
  EXPECT_EQ(link_.failures_[0], WireError::kState);
}

TEST_F(HullLink, SendsTheMapOfNormalsWholeAndForTheLevelItSays) {
  ASSERT_TRUE(link_.decoder().model().maps.has_value());
  EXPECT_EQ(link_.decoder().model().maps->faces, 100U);
  link_.send(GetHull{0, kOuterSide, 100, 0});
  link_.send(protocol::GetMap{0, protocol::MapKind::kNormals, 0});
  link_.settle();
  ASSERT_TRUE(link_.decoder().maps().map(protocol::MapKind::kNormals));
  EXPECT_EQ(
      link_.decoder().maps().map(protocol::MapKind::kNormals)->png.size(),
      link_.decoder().model().mapFile(protocol::MapKind::kNormals).bytes);
  EXPECT_GT(link_.decoder().maps().held(protocol::MapKind::kNormals), 1U);
  EXPECT_TRUE(link_.failures_.empty());
  link_.send(protocol::GetMap{0, protocol::MapKind::kNormals, 4000});
  link_.settle();
  ASSERT_EQ(link_.failures_.size(), 1U);
  EXPECT_EQ(link_.failures_[0], WireError::kState);
}

TEST_F(HullLink, SendsTheMapOfColoursBesideIt) {
  link_.send(protocol::GetMap{0, protocol::MapKind::kColors, 0});
  link_.send(protocol::GetMap{0, protocol::MapKind::kNormals, 0});
  link_.settle();
  EXPECT_TRUE(link_.decoder().maps().map(protocol::MapKind::kColors));
  EXPECT_TRUE(link_.decoder().maps().map(protocol::MapKind::kNormals));
  EXPECT_TRUE(link_.failures_.empty());
}

TEST(HullStream, WhatIsNotWhatItsHashSaysIsRefusedByTheClient) {
  const auto model = hulledModel();
  ASSERT_TRUE(model->info().baseHash && model->info().hull->outerHash);
  ASSERT_TRUE(model->info().maps->normalHash && model->info().maps->colorHash);
  const auto refused = [&](const protocol::Bytes message, auto damage) {
    StreamDecoder decoder;
    EXPECT_TRUE(decoder.beginModel(model->info()));
    auto decoded = protocol::decodeMessage(message, protocol::Sender::kServer);
    return damage(decoder, *decoded);
  };
  std::vector<std::uint8_t> bytes;
  const auto flipped = [&bytes](protocol::Bytes from) {
    bytes.assign(from.begin(), from.end());
    bytes[bytes.size() / 2] ^= 1;
    return protocol::Bytes(bytes);
  };
  const auto base = refused(model->base(), [&](StreamDecoder& decoder, protocol::Message& message) {
    auto body = *message.as<protocol::Base>();
    body.draco = flipped(body.draco);
    return decoder.take(body);
  });
  ASSERT_FALSE(base);
  EXPECT_EQ(base.error().code, ErrorCode::kCorrupt);
  EXPECT_NE(base.error().message.find("hash"), std::string::npos);
  const auto hull = refused(
      model->hull(kOuterSide).front(),
      [&](StreamDecoder& decoder, protocol::Message& message) {
        auto body = *message.as<protocol::Hull>();
        body.draco = flipped(body.draco);
        return decoder.take(body);
      });
  ASSERT_FALSE(hull);
  EXPECT_NE(hull.error().message.find("hash"), std::string::npos);
}

TEST(HullStream, ADamagedMapIsAskedForAnew) {
  const auto model = hulledModel();
  StreamDecoder decoder;
  ASSERT_TRUE(decoder.beginModel(model->info()));
  const auto kind = protocol::MapKind::kColors;
  const auto play = [&](std::size_t damagedPiece) {
    const auto& messages = model->map(kind);
    for (std::size_t i = 0; i < messages.size(); ++i) {
      const auto message = protocol::decodeMessage(messages[i], protocol::Sender::kServer);
      auto map = *message->as<protocol::Map>();
      std::vector<std::uint8_t> bytes(map.png.begin(), map.png.end());
      if (i == damagedPiece) bytes.back() ^= 1;
      map.png = bytes;
      if (auto taken = decoder.take(map); !taken) return taken;
    }
    return Result<void>();
  };
  EXPECT_FALSE(play(0));
  EXPECT_EQ(decoder.maps().held(kind), 0U);
  EXPECT_TRUE(play(SIZE_MAX));
  EXPECT_TRUE(decoder.maps().map(kind));
  // What another time kept is taken if it is that, and else not.
  StreamDecoder later;
  ASSERT_TRUE(later.beginModel(model->info()));
  auto png = decoder.maps().map(kind)->png;
  EXPECT_FALSE(later.restoreMap(protocol::MapKind::kNormals, png));
  png[100] ^= 1;
  EXPECT_FALSE(later.restoreMap(kind, png));
  png[100] ^= 1;
  EXPECT_TRUE(later.restoreMap(kind, png));
  EXPECT_EQ(later.snapshot()->colorMap->png, png);
}

// As after a reload in which a model lost them.
TEST(HullStream, AModelWithoutHullsAndMapsIsServedWithoutThem) {
  Link link;
  link.hello();
  link.open("bumpy");
  link.settle();
  EXPECT_FALSE(link.decoder().model().hull.has_value());
  link.send(GetHull{0, kOuterSide, 300, 2});
  link.send(GetHull{0, kInnerSide, 300, 0});
  link.send(protocol::GetMap{0, protocol::MapKind::kNormals, 0});
  link.look({1, 2, 3}, protocol::Goal::kComplete);
  link.settle();
  EXPECT_TRUE(link.failures_.empty());
  EXPECT_TRUE(link.decoder().complete());
  EXPECT_EQ(link.decoder().hulls().held(kOuterSide), 0U);
}

TEST(HullStream, PiecesOutOfOrderAreRefusedByTheClient) {
  const auto model = hulledModel();
  StreamDecoder decoder;
  ASSERT_TRUE(decoder.beginModel(model->info()));
  const auto take = [&](std::size_t i) {
    const auto message =
        protocol::decodeMessage(model->hull(kOuterSide)[i], protocol::Sender::kServer);
    if (const auto* hull = message->as<protocol::Hull>()) return decoder.take(*hull);
    return decoder.take(*message->as<protocol::HullSplits>());
  };
  EXPECT_FALSE(take(1));  // before the base
  EXPECT_TRUE(take(0));
  EXPECT_FALSE(take(0));  // twice
  EXPECT_FALSE(take(2));
  EXPECT_TRUE(take(1));
  EXPECT_TRUE(take(2));
}

TEST(HullStream, DamagedSectionsAreNoticedWhenTheModelIsLoaded) {
  auto sections = *encodeHullSections(hulls());
  std::swap(sections.outer, sections.inner);
  EXPECT_FALSE(Model::load(memoryAssetOf(primitives::torus(40, 20), 7, 60, &sections)));
}

}  // namespace
}  // namespace limn
