// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/client/core/small_asset.h"

#include "server/preprocess/asset_sections.h"

#include "protocol/framing.h"

#include "shared/codec/split_training.h"

#include <algorithm>
#include <array>
#include <set>

namespace limn {
namespace {

std::vector<std::vector<std::uint8_t>> framesOf(const std::vector<std::uint8_t>& section) {
  std::vector<std::vector<std::uint8_t>> messages;
  protocol::FrameReader reader(section);
  while (true) {
    const auto frame = reader.next();
    if (!frame || !*frame) return messages;
    messages.emplace_back((*frame)->begin(), (*frame)->end());
  }
}

/// A triangle with its smallest corner first, orientation kept.
std::array<std::uint32_t, 3> canonical(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  std::array<std::uint32_t, 3> t{a, b, c};
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

}  // namespace

std::vector<std::uint8_t> SmallAsset::packet(std::uint32_t pose, std::span<const VertexId> ids)
    const {
  const auto splits = encodeSplits(built.forest, splitModel, ids);
  const auto attributes = encodeAttributes(built.forest, ids);
  return protocol::encodeMessage(protocol::Packet{0, pose, splits, attributes});
}

VertexId SmallAsset::firstPacketVertex() const {
  return built.forest.levelBegin[1 + blocks.size()];
}

SmallAsset
makeSmallAsset(const TriangleMesh& mesh, std::uint8_t tag, std::span<const std::uint8_t> seams) {
  SmallAsset asset;
  ForestOptions options;
  options.baseFaces = 60;
  options.threads = 1;
  asset.built = *buildForest(mesh, options, seams);
  asset.id.fill(tag);
  asset.splitModel = trainSplitModel(asset.built.forest, frontsOf(asset.built.forest));
  const WireSections sections = encodeWireSections(asset.built, SeedTable{}, {asset.id, true});
  asset.info = framesOf(sections.info).front();
  asset.base = framesOf(sections.base).front();
  asset.blocks = framesOf(sections.blocks);
  asset.packets = framesOf(sections.packets);
  if (const auto seeds = framesOf(sections.seeds); !seeds.empty()) asset.seeds = seeds.front();
  return asset;
}

bool isWhole(const SmallAsset& asset, const ActiveMesh& mesh) {
  const SplitForest& forest = asset.built.forest;
  if (mesh.mesh().vertexCount() != forest.vertexCount()) return false;
  for (Slot s = 0; s < mesh.ids().size(); ++s) {
    if (mesh.positions()[s] != forest.positions[mesh.ids()[s]]) return false;
    if (mesh.attributes().at(s) != forest.attributes.at(mesh.ids()[s])) return false;
  }
  std::multiset<std::array<std::uint32_t, 3>> ours;
  std::multiset<std::array<std::uint32_t, 3>> theirs;
  for (const glm::uvec3& t : mesh.mesh().triangles()) {
    ours.insert(canonical(mesh.ids()[t.x], mesh.ids()[t.y], mesh.ids()[t.z]));
  }
  for (const glm::uvec3& t : forest.triangles)
    theirs.insert(canonical(t.x, t.y, t.z));
  return ours == theirs;
}

}  // namespace limn
