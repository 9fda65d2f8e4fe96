// SPDX-License-Identifier: Apache-2.0
#include "protocol/limits.h"
#include "protocol/message_fields.h"
#include "protocol/read_messages.h"
#include "protocol/text.h"

#include <cmath>
#include <utility>

namespace limn::protocol {
namespace {

Result<Body> read(const wire::Welcome& m) {
  if (!isText(view(m.server()), limits::kMaxNameBytes))
    return bad("Welcome.server is no short text");
  return Welcome{m.version(), view(m.server())};
}

Result<Body> read(const wire::Catalogue& m) {
  Catalogue catalogue;
  if (m.models() == nullptr) return catalogue;
  if (m.models()->size() > limits::kMaxCatalogueModels) return tooLarge("Catalogue.models");
  catalogue.models.reserve(m.models()->size());
  for (const wire::CatalogueEntry* e : *m.models()) {
    CatalogueEntry entry;
    entry.name = view(e->name());
    entry.state = e->state();
    entry.progress = e->progress();
    entry.reason = view(e->reason());
    entry.vertices = e->vertices();
    entry.faces = e->faces();
    entry.bytes = e->bytes();
    if (e->center() != nullptr) entry.center = toGlm(*e->center());
    entry.radius = e->radius();
    entry.hasHull = e->has_hull();
    if (!isValidModelName(entry.name)) return bad("CatalogueEntry.name is no model name");
    if (!isText(entry.reason, limits::kMaxTextBytes))
      return bad("CatalogueEntry.reason is no text");
    if (entry.state > ModelState::MAX) return bad("CatalogueEntry.state is unknown");
    if (!(entry.progress >= 0.0F && entry.progress <= 1.0F)) {
      return bad("CatalogueEntry.progress is not 0 to 1");
    }
    if (!finite(entry.center) || !std::isfinite(entry.radius)) {
      return bad("CatalogueEntry has a number that is not finite");
    }
    if (e->asset() != nullptr && e->asset()->size() != 0) {
      entry.asset = digest(view(e->asset()));
      if (!entry.asset) return bad("CatalogueEntry.asset is not 32 bytes");
    }
    catalogue.models.push_back(std::move(entry));
  }
  return catalogue;
}

Result<void> checkLevels(const ModelInfo& info) {
  const auto& levels = info.levelBegin;
  if (levels.size() < 2 || levels.size() > limits::kMaxLevels + 1) {
    return bad("ModelInfo.level_begin does not have 2 to 65 entries");
  }
  if (levels.front() != 0) return bad("ModelInfo.level_begin does not start with 0");
  for (std::size_t i = 1; i < levels.size(); ++i) {
    if (levels[i] <= levels[i - 1]) return bad("ModelInfo.level_begin does not ascend");
  }
  if (info.vertices > limits::kMaxVertices) return tooLarge("ModelInfo.vertices");
  if (levels[1] > limits::kMaxBaseVertices) return tooLarge("vertices of the base mesh");
  if (levels.back() != info.vertices)
    return bad("ModelInfo.level_begin does not end with vertices");
  // An oriented manifold of V vertices may have more than 2V faces (genus), but not by much more
  // than Euler's formula gives for the genus that fits; 4V bounds every honest model.
  if (info.faces == 0 || info.faces > 4ULL * info.vertices) return bad("ModelInfo.faces");
  if (info.blockLevels + 2U > levels.size()) return bad("ModelInfo.block_levels");
  return {};
}

Result<HullInfo> readHull(const wire::HullInfo& m) {
  const HullInfo hull{
      m.extra_bits(),
      m.outer_base(),
      m.outer_finest(),
      m.inner_base(),
      m.inner_finest(),
      view(m.reason()),
      toSectionHash(view(m.outer_hash())),
      toSectionHash(view(m.inner_hash()))};
  if (!isHash(view(m.outer_hash())) || !isHash(view(m.inner_hash())))
    return bad("HullInfo has a hash that is not 16 bytes");
  if (!isText(hull.reason, limits::kMaxTextBytes)) return bad("HullInfo.reason is no text");
  if (hull.extraBits > limits::kMaxHullExtraBits) return bad("HullInfo.extra_bits");
  if (hull.outerFinest > limits::kMaxHullFaces || hull.innerFinest > limits::kMaxHullFaces)
    return tooLarge("HullInfo.faces");
  if (hull.outerBase > hull.outerFinest || hull.innerBase > hull.innerFinest)
    return bad("HullInfo has a base finer than its finest level");
  return hull;
}

Result<MapInfo> readMaps(const wire::MapInfo& m) {
  const MapInfo maps{
      m.faces(),
      m.leg(),
      m.normal_bytes(),
      m.color_bytes(),
      toSectionHash(view(m.normal_hash())),
      toSectionHash(view(m.color_hash()))};
  if (!isHash(view(m.normal_hash())) || !isHash(view(m.color_hash())))
    return bad("MapInfo has a hash that is not 16 bytes");
  if (maps.faces == 0 || maps.faces > limits::kMaxMapFaces) return tooLarge("MapInfo.faces");
  if (maps.leg < 2 || maps.leg > limits::kMaxMapLeg) return tooLarge("MapInfo.leg");
  if (maps.normalBytes > limits::kMaxMapBytes || maps.colorBytes > limits::kMaxMapBytes)
    return tooLarge("the bytes of a map in MapInfo");
  return maps;
}

Result<Body> read(const wire::ModelInfo& m) {
  ModelInfo info;
  info.channel = m.channel();
  info.name = view(m.name());
  info.gridOrigin = toGlm(m.grid()->origin());
  info.gridStep = m.grid()->step();
  info.gridBits = m.grid()->bits();
  info.center = toGlm(*m.center());
  info.radius = m.radius();
  info.vertices = m.vertices();
  info.faces = m.faces();
  info.closed = m.closed();
  info.blockLevels = m.block_levels();
  info.splitModel = view(m.split_model());
  info.seedBytes = m.seed_bytes();
  info.attributes = m.attributes();
  info.placement = m.placement();
  const auto asset = digest(view(m.asset()));
  if (!asset) return bad("ModelInfo.asset is not 32 bytes");
  info.asset = *asset;
  info.baseHash = toSectionHash(view(m.base_hash()));
  if (!isHash(view(m.base_hash()))) return bad("ModelInfo.base_hash is not 16 bytes");
  if (!info.name.empty() && !isValidModelName(info.name)) {
    return bad("ModelInfo.name is no model name");
  }
  if (!finite(info.gridOrigin) || !finite(info.center) || !std::isfinite(info.radius) ||
      !(info.radius >= 0.0)) {
    return bad("ModelInfo has a number that is not finite");
  }
  if (!(info.gridStep > 0.0) || !std::isfinite(info.gridStep)) return bad("ModelInfo.grid.step");
  if (info.gridBits < limits::kMinGridBits || info.gridBits > limits::kMaxGridBits) {
    return bad("ModelInfo.grid.bits is not 11 to 18");
  }
  if (info.splitModel.size() > limits::kMaxSplitModelBytes)
    return tooLarge("ModelInfo.split_model");
  if (info.attributes > limits::kMaxAttributeKinds) return bad("ModelInfo.attributes");
  if (info.placement > limits::kMaxPlacement) return bad("ModelInfo.placement");
  if (info.seedBytes > limits::kMaxSeedBytes) return tooLarge("ModelInfo.seed_bytes");
  if (m.hull() != nullptr) {
    const auto hull = readHull(*m.hull());
    if (!hull) return tl::unexpected(hull.error());
    info.hull = *hull;
  }
  if (m.maps() != nullptr) {
    const auto maps = readMaps(*m.maps());
    if (!maps) return tl::unexpected(maps.error());
    info.maps = *maps;
  }
  if (m.level_begin()->size() > limits::kMaxLevels + 1) return tooLarge("ModelInfo.level_begin");
  info.levelBegin.assign(m.level_begin()->begin(), m.level_begin()->end());
  if (auto levels = checkLevels(info); !levels) return tl::unexpected(levels.error());
  return info;
}

Result<Body> read(const wire::Base& m) {
  if (m.draco()->size() == 0) return bad("Base.draco is empty");
  return Base{m.channel(), view(m.draco()), view(m.features())};
}

Result<Body> read(const wire::LevelBlock& m) {
  if (m.level() < 1 || m.level() >= limits::kMaxLevels) return bad("LevelBlock.level");
  if (m.splits()->size() == 0) return bad("LevelBlock.splits is empty");
  return LevelBlock{m.channel(), m.level(), view(m.splits()), view(m.attributes())};
}

Result<Body> read(const wire::Packet& m) {
  if (m.splits()->size() == 0) return bad("Packet.splits is empty");
  return Packet{m.channel(), m.pose(), view(m.splits()), view(m.attributes())};
}

Result<Body> read(const wire::Seeds& m) {
  const std::uint64_t end = std::uint64_t{m.offset()} + m.seeds()->size();
  if (m.total() > limits::kMaxSeedBytes) return tooLarge("Seeds.total");
  if (m.total() == 0 ? m.offset() != 0 : end > m.total() || m.seeds()->size() == 0) {
    return bad("Seeds goes past its total");
  }
  return Seeds{m.channel(), view(m.seeds()), m.offset(), m.total()};
}

Result<Body> read(const wire::Settled& m) {
  if (m.state() > Goal::MAX) return bad("Settled.state is unknown");
  return Settled{m.channel(), m.pose(), m.state()};
}

Result<Body> read(const wire::Error& m) {
  if (m.code() > WireError::MAX) return bad("Error.code is unknown");
  if (m.channel() < -1 || m.channel() > 255) return bad("Error.channel is not -1 to 255");
  if (!isText(view(m.message()), limits::kMaxTextBytes)) return bad("Error.message is no text");
  return Failure{m.code(), m.channel(), view(m.message()), m.retry_after_ms()};
}

Result<Body> read(const wire::Dropped& m) {
  return Dropped{m.channel(), view(m.kept())};
}

Result<Body> read(const wire::Full& m) {
  return Full{m.channel(), m.pose(), m.missing()};
}

Result<Body> read(const wire::Hull& m) {
  if (m.side() > HullSide::MAX) return bad("Hull.side is unknown");
  return Hull{m.channel(), m.side(), view(m.draco())};
}

Result<Body> read(const wire::HullSplits& m) {
  if (m.side() > HullSide::MAX) return bad("HullSplits.side is unknown");
  if (m.piece() >= limits::kMaxHullPieces) return tooLarge("HullSplits.piece");
  return HullSplits{m.channel(), m.side(), m.piece(), view(m.splits())};
}

Result<Body> read(const wire::Contour& m) {
  if (m.lines()->size() == 0) return bad("Contour.lines is empty");
  return Contour{m.channel(), m.id(), view(m.lines())};
}

Result<Body> read(const wire::Map& m) {
  if (m.kind() > MapKind::MAX) return bad("Map.kind is unknown");
  if (m.piece() >= limits::kMaxMapPieces) return tooLarge("Map.piece");
  if (m.png()->size() == 0) return bad("Map.png is empty");
  return Map{m.channel(), m.kind(), m.piece(), view(m.png())};
}

}  // namespace

Result<Body> readServerMessage(const wire::Message& m) {
  switch (m.body_type()) {
    case wire::Body::Welcome:
      return read(*m.body_as_Welcome());
    case wire::Body::Catalogue:
      return read(*m.body_as_Catalogue());
    case wire::Body::ModelInfo:
      return read(*m.body_as_ModelInfo());
    case wire::Body::Base:
      return read(*m.body_as_Base());
    case wire::Body::LevelBlock:
      return read(*m.body_as_LevelBlock());
    case wire::Body::Packet:
      return read(*m.body_as_Packet());
    case wire::Body::Seeds:
      return read(*m.body_as_Seeds());
    case wire::Body::Settled:
      return read(*m.body_as_Settled());
    case wire::Body::Error:
      return read(*m.body_as_Error());
    case wire::Body::Dropped:
      return read(*m.body_as_Dropped());
    case wire::Body::Full:
      return read(*m.body_as_Full());
    case wire::Body::Hull:
      return read(*m.body_as_Hull());
    case wire::Body::HullSplits:
      return read(*m.body_as_HullSplits());
    case wire::Body::Contour:
      return read(*m.body_as_Contour());
    case wire::Body::Map:
      return read(*m.body_as_Map());
    default:
      return refuse(m.body_type());
  }
}

}  // namespace limn::protocol
