// SPDX-License-Identifier: Apache-2.0
#include "tests/conformance/protocol/samples.h"

#include <numeric>

namespace limn::protocol {
namespace {

/// 0, 1, 2, …: byte fields whose content the message layer does not read.
template <class Container>
Container counting(std::size_t size) {
  Container bytes{};
  if constexpr (requires { bytes.resize(size); }) bytes.resize(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

}  // namespace

std::vector<Sample> samples() {
  const auto payload = counting<std::vector<std::uint8_t>>(24);
  const auto asset = counting<Sha256Digest>(32);
  std::vector<Sample> all;
  const auto add = [&all](const char* file, Sender sender, const Body& body) {
    all.push_back({file, sender, encodeMessage(body)});
  };

  add("hello.bin", Sender::kClient, Hello{1, "limn-client 0.1.0"});
  add("get_catalogue.bin", Sender::kClient, GetCatalogue{});
  add("open.bin", Sender::kClient, Open{3, "dragon", true});
  add("have_set.bin", Sender::kClient, HaveSet{3, asset, true, 64, payload, true, 4096});
  Pose pose;
  pose.channel = 3;
  pose.id = 77;
  pose.eye = {1.5, -2.25, 3.0};
  pose.forward = {0.0, 0.6, -0.8};
  pose.up = {0.0, 1.0, 0.0};
  pose.fovY = 0.75F;
  pose.orthoHeight = 2.5;
  pose.width = 1920;
  pose.height = 1080;
  pose.errorPx = 0.5F;
  pose.silhouette = Silhouette::kEdges;
  pose.goal = Goal::kExact;
  pose.maxSplits = 250'000;
  add("pose.bin", Sender::kClient, pose);
  add("acknowledge.bin", Sender::kClient, Acknowledge{5'000'000'000});
  add("drop.bin", Sender::kClient, Drop{3, payload});

  add("welcome.bin", Sender::kServer, Welcome{1, "limn-server 0.1.0"});
  Catalogue catalogue;
  catalogue.models.push_back(
      {"dragon",
       ModelState::kReady,
       1.0F,
       "",
       asset,
       437'645,
       871'414,
       1'500'000,
       {1.0, 2.0, 3.0},
       4.0,
       false});
  catalogue.models.push_back(
      {"fünf",
       ModelState::kFailed,
       0.0F,
       "no faces: check the file",
       std::nullopt,
       0,
       0,
       0,
       {0.0, 0.0, 0.0},
       0.0,
       false});
  add("catalogue.bin", Sender::kServer, catalogue);
  ModelInfo info;
  info.channel = 3;
  info.name = "dragon";
  info.asset = asset;
  info.gridOrigin = {-1.0, -2.0, -3.0};
  info.gridStep = 0.0009765625;
  info.gridBits = 14;
  info.center = {0.5, 0.25, 0.125};
  info.radius = 9.5;
  info.vertices = 1000;
  info.faces = 1996;
  info.closed = true;
  info.levelBegin = {0, 400, 600, 1000};
  info.blockLevels = 1;
  info.splitModel = payload;
  info.seedBytes = 9000;
  add("model_info.bin", Sender::kServer, info);
  add("base.bin", Sender::kServer, Base{3, payload, Bytes(payload).first(5)});
  add("base_without_features.bin", Sender::kServer, Base{3, payload, {}});
  add("level_block.bin", Sender::kServer, LevelBlock{3, 1, payload});
  add("packet.bin", Sender::kServer, Packet{3, 77, payload});
  add("seeds.bin", Sender::kServer, Seeds{3, payload, 4096, 9000});
  add("settled.bin", Sender::kServer, Settled{3, 77, Goal::kExact});
  add("error.bin", Sender::kServer, Failure{WireError::kNotReady, 3, "still preparing", 1500});
  add("dropped.bin", Sender::kServer, Dropped{3, payload});
  add("dropped_all.bin", Sender::kServer, Dropped{3, {}});
  info.hull = HullInfo{2, 200, 32'768, 198, 32'766, {}};
  const SectionHash hash{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
  add("model_info_hull.bin", Sender::kServer, info);
  info.maps = MapInfo{500, 31, 345'678};
  add("model_info_maps.bin", Sender::kServer, info);
  info.maps = MapInfo{500, 31, 345'678, 23'456, hash, hash};
  info.hull->outerHash = hash;
  info.hull->innerHash = hash;
  info.baseHash = hash;
  add("model_info_hashes.bin", Sender::kServer, info);
  info.baseHash.reset();
  info.maps.reset();
  add("get_map.bin", Sender::kClient, GetMap{3, MapKind::kNormals, 4});
  add("map.bin", Sender::kServer, Map{3, MapKind::kNormals, 4, payload});
  add("get_map_colors.bin", Sender::kClient, GetMap{3, MapKind::kColors, 0});
  add("map_colors.bin", Sender::kServer, Map{3, MapKind::kColors, 0, payload});
  info.hull = HullInfo{.reason = "the mesh is open"};
  add("model_info_no_hull.bin", Sender::kServer, info);
  info.hull.reset();
  info.attributes = 7;
  add("model_info_attributes.bin", Sender::kServer, info);
  info.attributes = 0;
  info.placement = 1;
  add("model_info_placement.bin", Sender::kServer, info);
  const Bytes attributes = Bytes(payload).first(7);
  add("level_block_attributes.bin", Sender::kServer, LevelBlock{3, 1, payload, attributes});
  add("packet_attributes.bin", Sender::kServer, Packet{3, 77, payload, attributes});
  add("get_hull.bin", Sender::kClient, GetHull{3, HullSide::kInner, 500, 2});
  add("hull.bin", Sender::kServer, Hull{3, HullSide::kOuter, payload});
  add("get_contour.bin",
      Sender::kClient,
      GetContour{3, 41, {0.25, -1.5, 4.0}, {0.0, 0.5, -1.0}, true, Silhouette::kEdges});
  add("contour.bin", Sender::kServer, Contour{3, 41, payload});
  add("hull_splits.bin", Sender::kServer, HullSplits{3, HullSide::kInner, 7, payload});
  add("full.bin", Sender::kServer, Full{3, 77, 12'345});
  return all;
}

}  // namespace limn::protocol
