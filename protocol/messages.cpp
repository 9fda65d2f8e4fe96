// SPDX-License-Identifier: Apache-2.0
#include "protocol/messages.h"

#include "protocol/limits.h"
#include "protocol/text.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>

namespace limn::protocol {
namespace {

using flatbuffers::FlatBufferBuilder;

// ---- Decoding

/// Deepest legal nesting: Message → Catalogue → vector → CatalogueEntry.
constexpr flatbuffers::uoffset_t kMaxDepth = 8;
constexpr flatbuffers::uoffset_t kMaxTables = limits::kMaxCatalogueModels + 8;
constexpr std::size_t kAlignment = alignof(std::uint64_t);

tl::unexpected<Error> bad(std::string_view what) {
  return fail(ErrorCode::kProtocol, "malformed message: " + std::string(what));
}

tl::unexpected<Error> tooLarge(std::string_view what) {
  return fail(
      ErrorCode::kLimitExceeded,
      "message over a limit of the protocol: " + std::string(what));
}

Bytes view(const flatbuffers::Vector<std::uint8_t>* vector) {
  return vector == nullptr ? Bytes{} : Bytes{vector->data(), vector->size()};
}

std::string_view view(const flatbuffers::String* text) {
  return text == nullptr ? std::string_view{} : std::string_view{text->c_str(), text->size()};
}

glm::dvec3 toGlm(const wire::Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

wire::Vec3 fromGlm(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::optional<Sha256Digest> digest(Bytes bytes) {
  Sha256Digest result{};
  if (bytes.size() != result.size()) return std::nullopt;
  std::copy(bytes.begin(), bytes.end(), result.begin());
  return result;
}

/// Absent, or whole.
bool isHash(Bytes bytes) {
  return bytes.empty() || toSectionHash(bytes).has_value();
}

Result<Body> read(const wire::Hello& m) {
  if (!isText(view(m.client()), limits::kMaxNameBytes)) return bad("Hello.client is no short text");
  return Hello{m.version(), view(m.client())};
}

Result<Body> read(const wire::GetCatalogue&) {
  return GetCatalogue{};
}

Result<Body> read(const wire::Open& m) {
  if (!isValidModelName(view(m.model()))) return bad("Open.model is no model name");
  return Open{m.channel(), view(m.model()), m.resume()};
}

Result<Body> read(const wire::HaveSet& m) {
  const auto asset = digest(view(m.asset()));
  if (!asset) return bad("HaveSet.asset is not 32 bytes");
  const Bytes bits = view(m.bits());
  if (bits.size() > limits::kMaxHaveSetPieceBytes) return tooLarge("HaveSet.bits");
  if (m.first() % 8 != 0) return bad("HaveSet.first is not a multiple of 8");
  if (m.first() / 8 + std::uint64_t{bits.size()} > (limits::kMaxVertices + 7ULL) / 8) {
    return tooLarge("HaveSet goes past the largest vertex id");
  }
  if (m.seeds() > limits::kMaxSeedBytes) return tooLarge("HaveSet.seeds");
  return HaveSet{m.channel(), *asset, m.base(), m.first(), bits, m.last(), m.seeds()};
}

Result<Body> read(const wire::Pose& m) {
  Pose pose;
  pose.channel = m.channel();
  pose.id = m.id();
  pose.eye = toGlm(*m.eye());
  pose.forward = toGlm(*m.forward());
  pose.up = toGlm(*m.up());
  pose.fovY = m.fov_y();
  pose.orthoHeight = m.ortho_height();
  pose.width = m.width();
  pose.height = m.height();
  pose.errorPx = m.error_px();
  pose.silhouette = m.silhouette();
  pose.goal = m.goal();
  pose.maxSplits = m.max_splits();
  if (!finite(pose.eye) || !finite(pose.forward) || !finite(pose.up)) {
    return bad("Pose has a number that is not finite");
  }
  // Lengths first: a cross product of huge or tiny vectors could overflow or vanish by itself.
  const double forwardLength = glm::length(pose.forward);
  const double upLength = glm::length(pose.up);
  if (!(forwardLength > 1e-100 && forwardLength < 1e100 && upLength > 1e-100 && upLength < 1e100)) {
    return bad("Pose.forward or Pose.up has no usable length");
  }
  const double sine = glm::length(glm::cross(pose.forward / forwardLength, pose.up / upLength));
  if (!(sine > 1e-9)) return bad("Pose.forward and Pose.up are parallel");
  if (!(pose.fovY > 0.0F && pose.fovY < 3.14159F)) return bad("Pose.fov_y is not between 0 and pi");
  if (!(pose.orthoHeight >= 0.0) || !std::isfinite(pose.orthoHeight)) {
    return bad("Pose.ortho_height is negative or not finite");
  }
  if (pose.width < 1 || pose.width > limits::kMaxViewportPixels || pose.height < 1 ||
      pose.height > limits::kMaxViewportPixels) {
    return bad("Pose viewport is not 1 to 16384 pixels");
  }
  if (!(pose.errorPx >= limits::kMinErrorPx && pose.errorPx <= limits::kMaxErrorPx)) {
    return bad("Pose.error_px is not 0.1 to 64");
  }
  if (pose.silhouette > Silhouette::MAX) return bad("Pose.silhouette is unknown");
  if (pose.goal > Goal::MAX) return bad("Pose.goal is unknown");
  return pose;
}

Result<Body> read(const wire::Acknowledge& m) {
  return Acknowledge{m.bytes()};
}

Result<Body> read(const wire::Drop& m) {
  return Drop{m.channel(), view(m.ids())};
}

Result<Body> read(const wire::GetHull& m) {
  if (m.side() > HullSide::MAX) return bad("GetHull.side is unknown");
  if (m.faces() > limits::kMaxHullFaces) return tooLarge("GetHull.faces");
  if (m.held() > limits::kMaxHullPieces) return tooLarge("GetHull.held");
  return GetHull{m.channel(), m.side(), m.faces(), m.held()};
}

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

Result<Body> read(const wire::GetContour& m) {
  const GetContour request{
      m.channel(),
      m.id(),
      toGlm(*m.eye()),
      toGlm(*m.forward()),
      m.orthographic(),
      m.silhouette()};
  if (!finite(request.eye) || !finite(request.forward)) {
    return bad("GetContour has a number that is not finite");
  }
  const double length = glm::length(request.forward);
  if (!(length > 1e-100 && length < 1e100)) return bad("GetContour.forward has no usable length");
  if (request.silhouette > Silhouette::MAX) return bad("GetContour.silhouette is unknown");
  return request;
}

Result<Body> read(const wire::Contour& m) {
  if (m.lines()->size() == 0) return bad("Contour.lines is empty");
  return Contour{m.channel(), m.id(), view(m.lines())};
}

Result<Body> read(const wire::GetMap& m) {
  if (m.kind() > MapKind::MAX) return bad("GetMap.kind is unknown");
  if (m.held() > limits::kMaxMapPieces) return tooLarge("GetMap.held");
  return GetMap{m.channel(), m.kind(), m.held()};
}

Result<Body> read(const wire::Map& m) {
  if (m.kind() > MapKind::MAX) return bad("Map.kind is unknown");
  if (m.piece() >= limits::kMaxMapPieces) return tooLarge("Map.piece");
  if (m.png()->size() == 0) return bad("Map.png is empty");
  return Map{m.channel(), m.kind(), m.piece(), view(m.png())};
}

Result<Body> readBody(const wire::Message& m) {
  switch (m.body_type()) {
    case wire::Body::Hello:
      return read(*m.body_as_Hello());
    case wire::Body::GetCatalogue:
      return read(*m.body_as_GetCatalogue());
    case wire::Body::Open:
      return read(*m.body_as_Open());
    case wire::Body::HaveSet:
      return read(*m.body_as_HaveSet());
    case wire::Body::Pose:
      return read(*m.body_as_Pose());
    case wire::Body::Acknowledge:
      return read(*m.body_as_Acknowledge());
    case wire::Body::Drop:
      return read(*m.body_as_Drop());
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
    case wire::Body::GetHull:
      return read(*m.body_as_GetHull());
    case wire::Body::Hull:
      return read(*m.body_as_Hull());
    case wire::Body::HullSplits:
      return read(*m.body_as_HullSplits());
    case wire::Body::GetContour:
      return read(*m.body_as_GetContour());
    case wire::Body::Contour:
      return read(*m.body_as_Contour());
    case wire::Body::GetMap:
      return read(*m.body_as_GetMap());
    case wire::Body::Map:
      return read(*m.body_as_Map());
    case wire::Body::NONE:
      break;
  }
  // The verifier lets types pass that it does not know, for newer schemas; this version refuses.
  return bad("unknown type of message");
}

// ---- Encoding

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

/// Everything else is a server's.
template <class T>
constexpr bool kSentByClient =
    std::is_same_v<T, Hello> || std::is_same_v<T, GetCatalogue> || std::is_same_v<T, Open> ||
    std::is_same_v<T, HaveSet> || std::is_same_v<T, Pose> || std::is_same_v<T, Acknowledge> ||
    std::is_same_v<T, Drop> || std::is_same_v<T, GetHull> || std::is_same_v<T, GetContour> ||
    std::is_same_v<T, GetMap>;

// The schema's union numbers types in the order of the variant; typeOf() relies on it.
static_assert(std::variant_size_v<Body> == static_cast<std::size_t>(wire::Body::MAX));

wire::Body typeOf(const Body& body) {
  return static_cast<wire::Body>(body.index() + 1);
}

}  // namespace

Result<Message> decodeMessage(Bytes bytes, Sender sender) {
  const std::size_t limit =
      sender == Sender::kClient ? limits::kMaxClientMessageBytes : limits::kMaxServerMessageBytes;
  if (bytes.size() > limit) return tooLarge(std::to_string(bytes.size()) + " bytes");
  Message message;
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % kAlignment != 0) {
    message.realigned =
        std::make_unique<std::uint64_t[]>((bytes.size() + kAlignment - 1) / kAlignment);
    std::memcpy(message.realigned.get(), bytes.data(), bytes.size());
    bytes = {reinterpret_cast<const std::uint8_t*>(message.realigned.get()), bytes.size()};
  }
  // The shortest buffer with an identifier; the verifier reads that far without a look at the size.
  constexpr std::size_t kHeader =
      sizeof(flatbuffers::uoffset_t) + flatbuffers::kFileIdentifierLength;
  if (bytes.size() < kHeader) return bad("cut short");
  if (!wire::MessageBufferHasIdentifier(bytes.data())) {
    return bad("does not carry the identifier LIMN");
  }
  flatbuffers::Verifier verifier(bytes.data(), bytes.size(), kMaxDepth, kMaxTables);
  if (!wire::VerifyMessageBuffer(verifier)) return bad("the FlatBuffers verifier refuses it");
  auto body = readBody(*wire::GetMessage(bytes.data()));
  if (!body) return tl::unexpected(std::move(body).error());
  const bool fromClient =
      std::visit([](const auto& m) { return kSentByClient<std::decay_t<decltype(m)>>; }, *body);
  if (fromClient != (sender == Sender::kClient)) {
    return fail(
        ErrorCode::kProtocol,
        std::string(nameOf(*body)) + " came from the wrong side of the connection");
  }
  message.body = std::move(*body);
  return message;
}

std::vector<std::uint8_t> encodeMessage(const Body& body) {
  FlatBufferBuilder builder(256);
  const auto table = std::visit(Writer{builder}, body);
  wire::FinishMessageBuffer(builder, wire::CreateMessage(builder, typeOf(body), table));
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

bool isPayload(const Body& body) {
  return std::holds_alternative<Base>(body) || std::holds_alternative<LevelBlock>(body) ||
         std::holds_alternative<Packet>(body) || std::holds_alternative<Seeds>(body) ||
         std::holds_alternative<Hull>(body) || std::holds_alternative<HullSplits>(body) ||
         std::holds_alternative<Contour>(body) || std::holds_alternative<Map>(body);
}

std::optional<std::uint8_t> channelOf(const Body& body) {
  return std::visit(
      [](const auto& m) -> std::optional<std::uint8_t> {
        if constexpr (requires { m.channel; }) {
          if (m.channel < 0) return std::nullopt;
          return static_cast<std::uint8_t>(m.channel);
        } else {
          return std::nullopt;
        }
      },
      body);
}

std::string_view nameOf(const Body& body) {
  return wire::EnumNameBody(typeOf(body));
}

std::string_view nameOf(WireError code) {
  return wire::EnumNameErrorCode(code);
}

bool isValidModelName(std::string_view name) {
  return !name.empty() && isText(name, limits::kMaxNameBytes) &&
         name.find('/') == std::string_view::npos;
}

}  // namespace limn::protocol
