// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/asset_sections.h"

#include "protocol/base_features.h"
#include "protocol/framing.h"
#include "protocol/messages.h"

#include "shared/codec/attribute_codec.h"
#include "shared/codec/seed_codec.h"
#include "shared/codec/split_codec.h"
#include "shared/codec/split_training.h"

#include <algorithm>

namespace limn {
namespace {

// Levels are blocks as long as every view needs most of them; what comes after is cheaper chosen by
// view (measured: server/session/README.md). But choosing takes the server up to two seconds on
// large scans, so these begin with 2,500 triangles to look at.
constexpr std::uint32_t kBlockVertices = 400;
constexpr std::uint32_t kBlockVerticesOfLarge = 1300;

std::uint32_t chooseBlockLevels(const SplitForest& forest) {
  const std::uint32_t wanted = std::max(
      std::min(kBlockVertices, std::max(1U, forest.vertexCount() / 10)),
      std::min(kBlockVerticesOfLarge, forest.vertexCount() / 80));
  std::uint32_t levels = 0;
  while (levels + 1 < forest.levelCount() && forest.levelBegin[levels + 1] < wanted)
    ++levels;
  return levels;
}

}  // namespace

std::uint64_t wireBytes(std::span<const std::uint8_t> section) {
  std::uint64_t total = 0;
  protocol::FrameReader reader(section);
  while (const auto message = reader.next()) {
    if (!*message) break;
    total += protocol::webSocketFrameBytes((*message)->size());
  }
  return total;
}

WireSections encodeWireSections(
    const BuiltForest& built,
    const SeedTable& seeds,
    const AssetIdentity& identity) {
  const SplitForest& forest = built.forest;
  const LevelFronts fronts = frontsOf(forest);
  const SplitModel model = trainSplitModel(forest, fronts);
  const std::vector<std::uint8_t> modelBytes = serializeSplitModel(model);
  const BoundingSphere sphere = boundingSphere(forest.grid, forest.positions);
  const std::uint32_t blockLevels = chooseBlockLevels(forest);

  const std::vector<std::uint8_t> features = protocol::packBaseFeatures(forest.baseFeatures);
  WireSections sections;
  protocol::appendFrame(
      sections.info,
      protocol::encodeMessage(protocol::ModelInfo{
          .name = {},
          .asset = identity.id,
          .gridOrigin = forest.grid.origin,
          .gridStep = forest.grid.step,
          .gridBits = forest.grid.bits,
          .center = sphere.center,
          .radius = sphere.radius,
          .vertices = forest.vertexCount(),
          .faces = static_cast<std::uint32_t>(forest.triangles.size()),
          .closed = identity.closed,
          .levelBegin = forest.levelBegin,
          .blockLevels = static_cast<std::uint8_t>(blockLevels),
          .splitModel = modelBytes,
          .hull = identity.hull,
          .maps = identity.maps,
          .attributes = forest.attributeKinds(),
          .placement = static_cast<std::uint8_t>(forest.placement()),
          .baseHash = protocol::sectionHash(built.baseDraco, features)}));

  const auto base =
      protocol::encodeMessage(protocol::Base{.draco = built.baseDraco, .features = features});
  protocol::appendFrame(sections.base, base);
  sections.levelBytes.push_back(protocol::webSocketFrameBytes(base.size()));
  sections.featureBytes = features.size();
  sections.baseAttributeBytes = built.baseAttributeBytes;

  for (std::uint32_t level = 1; level <= blockLevels; ++level) {
    const VertexId begin = forest.levelBegin[level];
    const VertexId end = forest.levelBegin[level + 1];
    const auto splits = encodeLevelRun(forest, model, fronts, begin, end);
    const auto attributes = encodeAttributes(forest, begin, end);
    sections.blockAttributeBytes += attributes.size();
    const auto message = protocol::encodeMessage(protocol::LevelBlock{
        .level = static_cast<std::uint8_t>(level),
        .splits = splits,
        .attributes = attributes});
    protocol::appendFrame(sections.blocks, message);
    sections.levelBytes.push_back(protocol::webSocketFrameBytes(message.size()));
  }
  // Packets end with their level, so that a level's bytes can be told.
  for (std::uint32_t level = blockLevels + 1; level < forest.levelCount(); ++level) {
    std::uint64_t bytes = 0;
    for (VertexId begin = forest.levelBegin[level]; begin < forest.levelBegin[level + 1];
         begin += kLevelRunSplits) {
      const VertexId end = std::min(begin + kLevelRunSplits, forest.levelBegin[level + 1]);
      const auto splits = encodeLevelRun(forest, model, fronts, begin, end);
      const auto attributes = encodeAttributes(forest, begin, end);
      sections.packetAttributeBytes += attributes.size();
      const auto message =
          protocol::encodeMessage(protocol::Packet{.splits = splits, .attributes = attributes});
      protocol::appendFrame(sections.packets, message);
      bytes += protocol::webSocketFrameBytes(message.size());
    }
    sections.levelBytes.push_back(bytes);
  }
  const std::vector<std::uint8_t> seedBytes = encodeSeeds(seeds);
  protocol::appendFrame(
      sections.seeds,
      protocol::encodeMessage(protocol::Seeds{.seeds = seedBytes}));
  return sections;
}

}  // namespace limn
