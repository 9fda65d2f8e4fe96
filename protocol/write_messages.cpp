// SPDX-License-Identifier: Apache-2.0
#include "protocol/message_fields.h"
#include "protocol/messages.h"

#include <variant>
#include <vector>

namespace limn::protocol {
namespace {

using flatbuffers::FlatBufferBuilder;

auto bytesOf(FlatBufferBuilder& b, Bytes bytes) {
  // CreateVector must not see a null pointer, even for no bytes.
  static constexpr std::uint8_t kEmpty = 0;
  return b.CreateVector(bytes.empty() ? &kEmpty : bytes.data(), bytes.size());
}

/// Absent where there is none.
flatbuffers::Offset<flatbuffers::Vector<std::uint8_t>> hashOf(
    FlatBufferBuilder& b,
    const std::optional<SectionHash>& hash) {
  if (!hash) return 0;
  return bytesOf(b, *hash);
}

auto textOf(FlatBufferBuilder& b, std::string_view text) {
  return b.CreateString(text.data() == nullptr ? "" : text.data(), text.size());
}

struct Writer {
  FlatBufferBuilder& b;

  auto operator()(const Hello& m) {
    return wire::CreateHello(b, m.version, textOf(b, m.client)).Union();
  }

  auto operator()(const GetCatalogue&) { return wire::CreateGetCatalogue(b).Union(); }

  auto operator()(const Open& m) {
    return wire::CreateOpen(b, m.channel, textOf(b, m.model), m.resume).Union();
  }

  auto operator()(const HaveSet& m) {
    const auto asset = bytesOf(b, m.asset);
    const auto bits = bytesOf(b, m.bits);
    return wire::CreateHaveSet(b, m.channel, asset, m.base, m.first, bits, m.last, m.seeds).Union();
  }

  auto operator()(const Pose& m) {
    const wire::Vec3 eye = fromGlm(m.eye);
    const wire::Vec3 forward = fromGlm(m.forward);
    const wire::Vec3 up = fromGlm(m.up);
    wire::PoseBuilder pose(b);
    pose.add_channel(m.channel);
    pose.add_id(m.id);
    pose.add_eye(&eye);
    pose.add_forward(&forward);
    pose.add_up(&up);
    pose.add_fov_y(m.fovY);
    pose.add_ortho_height(m.orthoHeight);
    pose.add_width(m.width);
    pose.add_height(m.height);
    pose.add_error_px(m.errorPx);
    pose.add_silhouette(m.silhouette);
    pose.add_goal(m.goal);
    pose.add_max_splits(m.maxSplits);
    return pose.Finish().Union();
  }

  auto operator()(const Acknowledge& m) { return wire::CreateAcknowledge(b, m.bytes).Union(); }

  auto operator()(const Drop& m) {
    return wire::CreateDrop(b, m.channel, bytesOf(b, m.ids)).Union();
  }

  auto operator()(const Welcome& m) {
    return wire::CreateWelcome(b, m.version, textOf(b, m.server)).Union();
  }

  auto operator()(const CatalogueEntry& e) {
    const auto name = textOf(b, e.name);
    const auto reason = textOf(b, e.reason);
    const auto asset = e.asset ? bytesOf(b, *e.asset) : 0;
    const wire::Vec3 center = fromGlm(e.center);
    wire::CatalogueEntryBuilder entry(b);
    entry.add_name(name);
    entry.add_state(e.state);
    entry.add_progress(e.progress);
    entry.add_reason(reason);
    if (e.asset) entry.add_asset(asset);
    entry.add_vertices(e.vertices);
    entry.add_faces(e.faces);
    entry.add_bytes(e.bytes);
    entry.add_center(&center);
    entry.add_radius(e.radius);
    entry.add_has_hull(e.hasHull);
    return entry.Finish();
  }

  auto operator()(const Catalogue& m) {
    std::vector<flatbuffers::Offset<wire::CatalogueEntry>> entries;
    entries.reserve(m.models.size());
    for (const CatalogueEntry& entry : m.models)
      entries.push_back((*this)(entry));
    return wire::CreateCatalogue(b, b.CreateVector(entries)).Union();
  }

  auto operator()(const ModelInfo& m) {
    const auto name = textOf(b, m.name);
    const auto asset = bytesOf(b, m.asset);
    const auto levels = b.CreateVector(m.levelBegin);
    const auto model = bytesOf(b, m.splitModel);
    const wire::Grid grid(fromGlm(m.gridOrigin), m.gridStep, static_cast<std::uint8_t>(m.gridBits));
    const wire::Vec3 center = fromGlm(m.center);
    flatbuffers::Offset<wire::HullInfo> hull;
    if (m.hull) {
      const auto reason = m.hull->reason.empty() ? 0 : textOf(b, m.hull->reason);
      const auto outer = hashOf(b, m.hull->outerHash);
      const auto inner = hashOf(b, m.hull->innerHash);
      hull = wire::CreateHullInfo(
          b,
          m.hull->extraBits,
          m.hull->outerBase,
          m.hull->outerFinest,
          m.hull->innerBase,
          m.hull->innerFinest,
          reason,
          outer,
          inner);
    }
    flatbuffers::Offset<wire::MapInfo> maps;
    if (m.maps) {
      const auto normals = hashOf(b, m.maps->normalHash);
      const auto colors = hashOf(b, m.maps->colorHash);
      maps = wire::CreateMapInfo(
          b,
          m.maps->faces,
          m.maps->leg,
          m.maps->normalBytes,
          m.maps->colorBytes,
          normals,
          colors);
    }
    const auto baseHash = hashOf(b, m.baseHash);
    wire::ModelInfoBuilder info(b);
    info.add_channel(m.channel);
    info.add_name(name);
    info.add_asset(asset);
    info.add_grid(&grid);
    info.add_center(&center);
    info.add_radius(m.radius);
    info.add_vertices(m.vertices);
    info.add_faces(m.faces);
    info.add_closed(m.closed);
    info.add_level_begin(levels);
    info.add_block_levels(m.blockLevels);
    info.add_split_model(model);
    info.add_seed_bytes(m.seedBytes);
    if (m.hull) info.add_hull(hull);
    if (m.maps) info.add_maps(maps);
    info.add_attributes(m.attributes);
    info.add_placement(m.placement);
    if (m.baseHash) info.add_base_hash(baseHash);
    return info.Finish().Union();
  }

  auto operator()(const Base& m) {
    const auto draco = bytesOf(b, m.draco);
    const auto features = m.features.empty() ? 0 : bytesOf(b, m.features);
    return wire::CreateBase(b, m.channel, draco, features).Union();
  }

  auto operator()(const LevelBlock& m) {
    const auto splits = bytesOf(b, m.splits);
    const auto attributes = m.attributes.empty() ? 0 : bytesOf(b, m.attributes);
    return wire::CreateLevelBlock(b, m.channel, m.level, splits, attributes).Union();
  }

  auto operator()(const Packet& m) {
    const auto splits = bytesOf(b, m.splits);
    const auto attributes = m.attributes.empty() ? 0 : bytesOf(b, m.attributes);
    return wire::CreatePacket(b, m.channel, m.pose, splits, attributes).Union();
  }

  auto operator()(const Seeds& m) {
    return wire::CreateSeeds(b, m.channel, bytesOf(b, m.seeds), m.offset, m.total).Union();
  }

  auto operator()(const Settled& m) {
    return wire::CreateSettled(b, m.channel, m.pose, m.state).Union();
  }

  auto operator()(const Failure& m) {
    return wire::CreateError(b, m.code, m.channel, textOf(b, m.message), m.retryAfterMs).Union();
  }

  auto operator()(const Dropped& m) {
    const auto kept = m.kept.empty() ? 0 : bytesOf(b, m.kept);
    return wire::CreateDropped(b, m.channel, kept).Union();
  }

  auto operator()(const Full& m) {
    return wire::CreateFull(b, m.channel, m.pose, m.missing).Union();
  }

  auto operator()(const GetHull& m) {
    return wire::CreateGetHull(b, m.channel, m.side, m.faces, m.held).Union();
  }

  auto operator()(const Hull& m) {
    return wire::CreateHull(b, m.channel, m.side, bytesOf(b, m.draco)).Union();
  }

  auto operator()(const HullSplits& m) {
    return wire::CreateHullSplits(b, m.channel, m.side, m.piece, bytesOf(b, m.splits)).Union();
  }

  auto operator()(const GetContour& m) {
    const wire::Vec3 eye = fromGlm(m.eye);
    const wire::Vec3 forward = fromGlm(m.forward);
    return wire::CreateGetContour(b, m.channel, m.id, &eye, &forward, m.orthographic, m.silhouette)
        .Union();
  }

  auto operator()(const GetMap& m) {
    return wire::CreateGetMap(b, m.channel, m.kind, m.held).Union();
  }

  auto operator()(const Map& m) {
    return wire::CreateMap(b, m.channel, m.kind, m.piece, bytesOf(b, m.png)).Union();
  }

  auto operator()(const Contour& m) {
    return wire::CreateContour(b, m.channel, m.id, bytesOf(b, m.lines)).Union();
  }
};

}  // namespace

std::vector<std::uint8_t> encodeMessage(const Body& body) {
  FlatBufferBuilder builder(256);
  const auto table = std::visit(Writer{builder}, body);
  wire::FinishMessageBuffer(builder, wire::CreateMessage(builder, typeOf(body), table));
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

}  // namespace limn::protocol
