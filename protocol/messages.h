// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol/limn_generated.h"
#include "protocol/section_hash.h"

#include "shared/core/result.h"
#include "shared/core/sha256.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

/// The messages of subprotocol `limn.1` as plain values. limn.fbs has the meaning of every field,
/// its unit and its limits; SPEC.md the order in which they travel.
///
/// Byte fields and texts are views: of what decodeMessage() was given, or, for encode(), of what
/// the caller holds. They are never copied.
namespace limn::protocol {

using wire::Goal;
using wire::HullSide;
using wire::MapKind;
using wire::ModelState;
using wire::Silhouette;
/// Why the peer refused; not to be confused with limn::ErrorCode, which names our own failures.
using WireError = wire::ErrorCode;

using Bytes = std::span<const std::uint8_t>;

// ---- Client to server

struct Hello {
  std::uint16_t version = 0;
  std::string_view client;
};

struct GetCatalogue {};

struct Open {
  std::uint8_t channel = 0;
  std::string_view model;
  bool resume = false;
};

struct HaveSet {
  std::uint8_t channel = 0;
  Sha256Digest asset{};
  bool base = false;
  std::uint32_t first = 0;  // multiple of 8
  Bytes bits;
  bool last = false;
  std::uint32_t seeds = 0;  // bytes of the seeds held
};

struct Pose {
  std::uint8_t channel = 0;
  std::uint32_t id = 0;
  glm::dvec3 eye{0.0, 0.0, 3.0};
  glm::dvec3 forward{0.0, 0.0, -1.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  float fovY = 0.7F;         // radians, vertical
  double orthoHeight = 0.0;  // model units; 0: perspective
  std::uint16_t width = 1024;
  std::uint16_t height = 1024;
  float errorPx = 1.0F;
  Silhouette silhouette = Silhouette::kSmooth;
  Goal goal = Goal::kSettled;
  std::uint32_t maxSplits = 0;  // 0: no limit
};

struct Acknowledge {
  std::uint64_t bytes = 0;
};

struct Drop {
  std::uint8_t channel = 0;
  Bytes ids;  // shared/codec/id_set.h
};

struct GetHull {
  std::uint8_t channel = 0;
  HullSide side = HullSide::kOuter;
  std::uint32_t faces = 0;
  std::uint32_t held = 0;  // messages of it that the client has: Hull, then pieces
};

struct GetContour {
  std::uint8_t channel = 0;
  std::uint32_t id = 0;
  glm::dvec3 eye{0.0, 0.0, 3.0};
  glm::dvec3 forward{0.0, 0.0, -1.0};
  bool orthographic = false;
  Silhouette silhouette = Silhouette::kSmooth;
};

struct GetMap {
  std::uint8_t channel = 0;
  MapKind kind = MapKind::kNormals;
  std::uint32_t held = 0;  // pieces of it that the client has
};

// ---- Server to client

struct Welcome {
  std::uint16_t version = 0;
  std::string_view server;
};

struct CatalogueEntry {
  std::string_view name;
  ModelState state = ModelState::kQueued;
  float progress = 0.0F;
  std::string_view reason;
  std::optional<Sha256Digest> asset;
  std::uint32_t vertices = 0;
  std::uint32_t faces = 0;
  std::uint64_t bytes = 0;
  glm::dvec3 center{0.0};
  double radius = 0.0;
  bool hasHull = false;
};

struct Catalogue {
  std::vector<CatalogueEntry> models;
};

struct HullInfo {
  std::uint8_t extraBits = 0;
  std::uint32_t outerBase = 0;  // faces
  std::uint32_t outerFinest = 0;
  std::uint32_t innerBase = 0;
  std::uint32_t innerFinest = 0;
  std::string_view reason;  // not empty: there is none
  std::optional<SectionHash> outerHash{};
  std::optional<SectionHash> innerHash{};
};

struct MapInfo {
  std::uint32_t faces = 0;
  std::uint16_t leg = 0;
  std::uint32_t normalBytes = 0;  // 0: no such map
  std::uint32_t colorBytes = 0;
  std::optional<SectionHash> normalHash{};
  std::optional<SectionHash> colorHash{};
};

struct ModelInfo {
  std::uint8_t channel = 0;
  std::string_view name;
  Sha256Digest asset{};
  glm::dvec3 gridOrigin{0.0};
  double gridStep = 1.0;
  int gridBits = 14;
  glm::dvec3 center{0.0};
  double radius = 0.0;
  std::uint32_t vertices = 0;
  std::uint32_t faces = 0;
  bool closed = false;
  std::vector<std::uint32_t> levelBegin;
  std::uint8_t blockLevels = 0;
  Bytes splitModel;
  std::uint32_t seedBytes = 0;  // that will come; 0: none, or all at once
  std::optional<HullInfo> hull;
  std::optional<MapInfo> maps;
  std::uint8_t attributes = 0;  // AttributeKind bits
  std::uint8_t placement = 0;   // Placement
  std::optional<SectionHash> baseHash{};
};

struct Base {
  std::uint8_t channel = 0;
  Bytes draco;
  Bytes features;  // base_features.h; empty: none
};

struct LevelBlock {
  std::uint8_t channel = 0;
  std::uint8_t level = 1;
  Bytes splits;
  Bytes attributes{};  // empty: the model has none
};

struct Packet {
  std::uint8_t channel = 0;
  std::uint32_t pose = 0;
  Bytes splits;
  Bytes attributes{};  // empty: the model has none
};

struct Seeds {
  std::uint8_t channel = 0;
  Bytes seeds;
  std::uint32_t offset = 0;
  std::uint32_t total = 0;  // 0: these are all
};

struct Settled {
  std::uint8_t channel = 0;
  std::uint32_t pose = 0;
  Goal state = Goal::kSettled;
};

struct Failure {  // table Error
  WireError code = WireError::kInternal;
  std::int16_t channel = -1;  // −1: the connection
  std::string_view message;
  std::uint32_t retryAfterMs = 0;
};

struct Dropped {
  std::uint8_t channel = 0;
  Bytes kept;  // shared/codec/id_set.h
};

struct Full {
  std::uint8_t channel = 0;
  std::uint32_t pose = 0;
  std::uint32_t missing = 0;
};

struct Hull {
  std::uint8_t channel = 0;
  HullSide side = HullSide::kOuter;
  Bytes draco;
};

struct HullSplits {
  std::uint8_t channel = 0;
  HullSide side = HullSide::kOuter;
  std::uint32_t piece = 0;
  Bytes splits;
};

struct Contour {
  std::uint8_t channel = 0;
  std::uint32_t id = 0;
  Bytes lines;  // shared/codec/contour_codec.h
};

struct Map {
  std::uint8_t channel = 0;
  MapKind kind = MapKind::kNormals;
  std::uint32_t piece = 0;
  Bytes png;
};

using Body = std::variant<
    Hello,
    GetCatalogue,
    Open,
    HaveSet,
    Pose,
    Acknowledge,
    Drop,
    Welcome,
    Catalogue,
    ModelInfo,
    Base,
    LevelBlock,
    Packet,
    Seeds,
    Settled,
    Failure,
    Dropped,
    Full,
    GetHull,
    Hull,
    HullSplits,
    GetContour,
    Contour,
    GetMap,
    Map>;

/// Who sent a message: decides which types are legal and how long it may be.
enum class Sender : std::uint8_t { kClient, kServer };

/// A decoded message. Its views stay valid as long as both this object and the bytes it was decoded
/// from. Movable.
struct Message {
  Body body;
  /// A realigned copy of the bytes, made only when they did not start at a multiple of 8.
  std::unique_ptr<std::uint64_t[]> realigned;

  template <class T>
  [[nodiscard]] const T* as() const {
    return std::get_if<T>(&body);
  }
};

/// Decodes one message: FlatBuffers' verifier, then every limit of limits.h and limn.fbs. Total
/// over any bytes, allocates nothing in proportion to a field that was not checked before. Errors:
/// kProtocol (malformed, or not a message that `sender` sends), kLimitExceeded. Threads: reentrant.
/// Cost: O(size) at worst, byte fields are not read.
[[nodiscard]] Result<Message> decodeMessage(Bytes bytes, Sender sender);

/// Encodes one message. The bytes depend on nothing but the argument. What breaks a limit is a bug
/// of the caller: decodeMessage() of the other side will refuse it.
[[nodiscard]] std::vector<std::uint8_t> encodeMessage(const Body& body);

/// Base, LevelBlock, Packet, Seeds, Hull, HullSplits, Contour and Map: what Acknowledge counts and
/// the send window bounds.
[[nodiscard]] bool isPayload(const Body& body);

/// The channel of a message that has one.
[[nodiscard]] std::optional<std::uint8_t> channelOf(const Body& body);

/// A short name for logs and errors, "Packet".
[[nodiscard]] std::string_view nameOf(const Body& body);
[[nodiscard]] std::string_view nameOf(WireError code);

/// A model name as it may stand in Open and in catalogues: 1 to 200 bytes of UTF-8 without control
/// characters and without '/'.
[[nodiscard]] bool isValidModelName(std::string_view name);

}  // namespace limn::protocol
