// SPDX-License-Identifier: Apache-2.0
#include "client/core/model_stream.h"

#include "client/core/have_set.h"

#include "shared/codec/id_set.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

namespace limn {
namespace {

/// What is dropped and comes back for the same view is needed after all.
constexpr std::uint32_t kMaxDropsAView = 8;
/// Of one Drop: its message stays well within its limit.
constexpr std::size_t kMaxDropSplits = 20'000;

}  // namespace

ModelStream::ModelStream(
    std::uint8_t channel,
    std::string model,
    const StreamOptions& options,
    Outbox& outbox)
    : channel_(channel),
      model_(std::move(model)),
      options_(options),
      outbox_(outbox),
      poses_(channel) {}

// ---- The channel

void ModelStream::open() {
  isOpen_ = false;
  dropping_.clear();
  outbox_.push_back(encodeMessage(protocol::Open{channel_, model_, decoder_.hasModel()}));
}

void ModelStream::openAgainAt(std::uint64_t atMs) {
  isOpen_ = false;
  openAtMs_ = atMs;
}

void ModelStream::restart() {
  decoder_.drop();
  settledAs_.reset();
  open();
}

void ModelStream::disconnect() {
  isOpen_ = false;
  openAtMs_.reset();
  settledAs_.reset();
  dropping_.clear();
  contourAsked_ = contourGot_;
}

// ---- What the server says

Result<void> ModelStream::describe(const protocol::ModelInfo& info) {
  return decoder_.beginModel(info);
}

Result<void> ModelStream::limitMemory(std::uint64_t bytes, const protocol::ModelInfo& info) {
  maxSplits_ = splitsThatFit(bytes, info);
  if (maxSplits_ > 0) return {};
  return fail(
      ErrorCode::kLimitExceeded,
      "'" + model_ + "' has " + std::to_string(info.vertices) +
          " vertices, not even a beginning of it fits into the memory given: allow more");
}

void ModelStream::sendHaveSet() {
  for (auto& piece : encodeHaveSet(decoder_, channel_))
    outbox_.push_back(std::move(piece));
}

Result<void> ModelStream::begin(std::uint64_t nowMs) {
  isOpen_ = true;
  hullAsked_ = {};
  mapAsked_ = {};
  if (auto asked = askForHulls(); !asked) return asked;
  poses_.repeat();
  tellView(nowMs);
  return {};
}

Result<double> ModelStream::noteContour(const protocol::Contour& message, std::uint64_t nowMs) {
  if (message.id != contourAsked_ || contourGot_ == contourAsked_) {
    return fail(ErrorCode::kProtocol, "a contour came that was not asked for");
  }
  contourGot_ = message.id;
  const auto answerMs = static_cast<double>(nowMs - contourAskedAtMs_);
  askForContour(nowMs);
  return answerMs;
}

Result<void> ModelStream::settle(MeshState state) {
  if (state == MeshState::kComplete && !decoder_.complete()) {
    return fail(ErrorCode::kProtocol, "the server says complete, but splits are missing");
  }
  if (!settledAs_ || *settledAs_ < state) settledAs_ = state;
  return {};
}

Result<void> ModelStream::drop(const protocol::Dropped& message) {
  const auto kept = decodeIdSet(message.kept, std::numeric_limits<VertexId>::max());
  if (dropping_.empty() || !kept) {
    return fail(ErrorCode::kProtocol, "an answer to a drop that was not asked for");
  }
  std::vector<VertexId> gone;
  std::ranges::set_difference(dropping_, *kept, std::back_inserter(gone));
  dropping_.clear();
  return decoder_.undo(gone);
}

Result<void> ModelStream::makeRoom(std::uint32_t missing) {
  if (!dropping_.empty()) return {};  // the answer lets the server say again that it is full
  // Some more than is missing, since of what is asked for not all may go; ever more if that fails.
  const std::size_t wanted =
      std::min<std::size_t>((std::size_t{missing} + maxSplits_ / 16 + 1) << drops_, kMaxDropSplits);
  if (drops_ < kMaxDropsAView) {
    dropping_ = eviction_.choose(decoder_.mesh(), decoder_.model().grid, wanted);
  }
  ++drops_;
  if (!dropping_.empty()) {
    outbox_.push_back(encodeMessage(protocol::Drop{channel_, encodeIdSet(dropping_)}));
    return {};
  }
  return fail(
      ErrorCode::kLimitExceeded,
      "this view of '" + model_ + "' needs " + std::to_string(missing) +
          " splits more than the memory given holds: allow more, or a larger error in pixels");
}

// ---- What the user wants

bool ModelStream::look(const ClientView& view) {
  const std::uint32_t before = poses_.newestId();
  poses_.set(view);
  if (poses_.newestId() == before) return false;
  settledAs_.reset();
  drops_ = 0;
  eviction_.look(view);
  return true;
}

void ModelStream::onTimer(std::uint64_t nowMs) {
  if (openAtMs_ && nowMs >= *openAtMs_) {
    openAtMs_.reset();
    open();
  }
  tellView(nowMs);
}

void ModelStream::tellView(std::uint64_t nowMs) {
  if (!isOpen_) return;
  if (options_.contours == StreamOptions::Contours::kServer) return askForContour(nowMs);
  auto pose = poses_.next(nowMs);
  if (!pose) return;
  pose->maxSplits = maxSplits_;
  outbox_.push_back(encodeMessage(*pose));
}

/// One at a time: what comes meanwhile is asked for when the answer is there, if it is the newest.
void ModelStream::askForContour(std::uint64_t nowMs) {
  const std::uint32_t newest = poses_.newestId();
  if (contourAsked_ != contourGot_ || contourAsked_ == newest) return;
  const auto pose = poses_.newest();
  if (!pose) return;
  contourAsked_ = newest;
  contourAskedAtMs_ = nowMs;
  outbox_.push_back(encodeMessage(protocol::GetContour{
      channel_,
      newest,
      pose->eye,
      pose->forward,
      pose->orthoHeight > 0.0,
      pose->silhouette}));
}

Result<void> ModelStream::askForHulls() {
  if (!decoder_.model().hasHull()) {
    const bool isWanted = options_.outerHullFaces > 0 || options_.innerHullFaces > 0;
    if (!isWanted || options_.hulls == StreamOptions::Hulls::kWanted) return {};
    return fail(ErrorCode::kUnsupported, whyNoHull(decoder_.model()));
  }
  askForHull(protocol::HullSide::kOuter, options_.outerHullFaces);
  askForHull(protocol::HullSide::kInner, options_.innerHullFaces);
  askForMap(protocol::MapKind::kNormals);
  askForMap(protocol::MapKind::kColors);
  return {};
}

void ModelStream::askForHull(protocol::HullSide side, std::uint32_t faces) {
  if (faces == 0) return;
  const HullStreams& hulls = decoder_.hulls();
  std::uint32_t& asked = hullAsked_[static_cast<std::size_t>(side)];
  const auto isThere = [&](std::uint32_t level) {
    return hulls.isThere(side, level, decoder_.model());
  };
  // What is on its way comes first: a request says what is held.
  if (isThere(faces) || (asked != 0 && !isThere(asked))) return;
  asked = faces;
  outbox_.push_back(encodeMessage(protocol::GetHull{channel_, side, faces, hulls.held(side)}));
}

void ModelStream::askForMap(protocol::MapKind kind) {
  const MapStreams& maps = decoder_.maps();
  bool& asked = mapAsked_[static_cast<std::size_t>(kind)];
  if (!wantsMap(kind) || maps.map(kind) || asked) return;
  const auto& hash = decoder_.model().mapFile(kind).hash;
  if (maps.held(kind) == 0 && options_.cache && hash) {
    // What is not what it should be is asked for, and kept in its place.
    if (auto png = options_.cache->load(*hash); !png.empty())
      static_cast<void>(decoder_.restoreMap(kind, std::move(png)));
    if (maps.map(kind)) return;
  }
  asked = true;
  outbox_.push_back(encodeMessage(protocol::GetMap{channel_, kind, maps.held(kind)}));
}

void ModelStream::keepMap(protocol::MapKind kind) {
  const auto& map = decoder_.maps().map(kind);
  const auto& hash = decoder_.model().mapFile(kind).hash;
  if (options_.cache && map && hash) options_.cache->keep(*hash, map->png);
}

/// A map is of use to its own level only.
bool ModelStream::wantsMap(protocol::MapKind kind) const {
  const auto& model = decoder_.model();
  return options_.maps == StreamOptions::Maps::kWanted && model.maps &&
         model.mapFile(kind).bytes > 0 && model.maps->faces <= options_.outerHullFaces &&
         options_.outerHullFaces < model.maps->faces + 2;
}

// ---- Where it stands

MeshState ModelStream::state() const {
  if (!decoder_.hasBase()) return MeshState::kNothing;
  if (decoder_.complete()) return MeshState::kComplete;
  if (settledAs_) return *settledAs_;
  return decoder_.mesh().splitsHeld() == 0 ? MeshState::kBase : MeshState::kPartial;
}

bool ModelStream::hasReached(MeshState wanted) const {
  return state() >= wanted && hullsAreThere() && contourIsThere();
}

bool ModelStream::hullsAreThere() const {
  const auto isThere = [&](protocol::HullSide side, std::uint32_t faces) {
    return faces == 0 || !decoder_.model().hasHull() ||
           decoder_.hulls().isThere(side, faces, decoder_.model());
  };
  const auto hasMap = [&](protocol::MapKind kind) {
    return !wantsMap(kind) || decoder_.maps().map(kind);
  };
  return decoder_.hasModel() && hasMap(protocol::MapKind::kNormals) &&
         hasMap(protocol::MapKind::kColors) &&
         isThere(protocol::HullSide::kOuter, options_.outerHullFaces) &&
         isThere(protocol::HullSide::kInner, options_.innerHullFaces);
}

bool ModelStream::contourIsThere() const {
  return options_.contours == StreamOptions::Contours::kOwnMesh ||
         (contourGot_ != 0 && contourGot_ == poses_.newestId());
}

bool ModelStream::owesAnswer() const {
  if (!isOpen_) return !openAtMs_;
  // The base mesh is owed from the start; more only for a view that has been told.
  if (!decoder_.hasBase()) return true;
  if (poses_.newestId() == 0) return false;
  if (options_.contours == StreamOptions::Contours::kServer) {
    return !contourIsThere() || !hullsAreThere();
  }
  return state() < MeshState::kSettled;
}

bool ModelStream::hasToldView() const {
  return isOpen_ && decoder_.hasBase() && poses_.newestId() != 0 &&
         options_.contours == StreamOptions::Contours::kOwnMesh;
}

std::optional<std::uint64_t> ModelStream::wakeAtMs() const {
  std::optional<std::uint64_t> wake = openAtMs_;
  if (isOpen_ && options_.contours == StreamOptions::Contours::kOwnMesh) {
    const auto due = poses_.dueAtMs();
    if (due) wake = wake ? std::min(*wake, *due) : *due;
  }
  return wake;
}

}  // namespace limn
