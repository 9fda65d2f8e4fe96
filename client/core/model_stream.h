// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/eviction.h"
#include "client/core/pose_reporter.h"
#include "client/core/section_cache.h"
#include "client/core/session_state.h"
#include "client/core/stream_decoder.h"

#include "protocol/messages.h"

#include "shared/core/ids.h"
#include "shared/core/result.h"

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace limn {

/// Messages to send, in order.
using Outbox = std::deque<std::vector<std::uint8_t>>;

/// What is wanted of every model of a session besides its mesh.
struct StreamOptions {
  /// Faces of the hulls that are wanted, and without which no state counts; 0: none.
  std::uint32_t outerHullFaces = 0;
  std::uint32_t innerHullFaces = 0;
  /// What becomes of a model without hulls where one is wanted. kWanted: it goes on as if none
  /// were. kNeeded: the session fails.
  enum class Hulls : std::uint8_t { kWanted, kNeeded };
  Hulls hulls = Hulls::kWanted;
  /// The maps over the outer hull are wanted where the model has them, and without them no state
  /// counts. Go with outerHullFaces.
  enum class Maps : std::uint8_t { kOff, kWanted };
  Maps maps = Maps::kOff;
  /// Where maps are kept from session to session: what is there is not asked for. Null: nowhere.
  std::shared_ptr<SectionCache> cache;
  /// Where silhouettes come from. kServer: of the full mesh, asked for view by view, one request
  /// at a time; views are told in no other way, so of the mesh only its start comes, and no state
  /// counts without the newest view's contour.
  enum class Contours : std::uint8_t { kOwnMesh, kServer };
  Contours contours = Contours::kOwnMesh;
};

/// One model of a session: its channel, what is held of it, where it is looked at from, and what
/// has been asked for and not come. What it has to say goes into the session's outbox; what must
/// become of the connection is the session's to decide. Threads: one at a time.
class ModelStream {
 public:
  /// options, outbox: the session's; they outlive this.
  ModelStream(
      std::uint8_t channel,
      std::string model,
      const StreamOptions& options,
      Outbox& outbox);

  // ---- The channel

  /// Asks for the model, to go on from what is held of it.
  void open();
  /// The server was not ready: asks again then.
  void openAgainAt(std::uint64_t atMs);
  /// Drops what is held and asks for the model from its beginning.
  void restart();
  /// The connection is lost, and what was on its way with it.
  void disconnect();

  /// The model's description has come, on this connection.
  [[nodiscard]] bool isOpen() const { return isOpen_; }

  /// It was asked for, and has not come.
  [[nodiscard]] bool awaitsDescription() const { return !isOpen_ && !openAtMs_; }

  // ---- What the server says

  /// The description, of the model held or of another. Errors: it makes no sense.
  [[nodiscard]] Result<void> describe(const protocol::ModelInfo& info);
  /// Bounds the memory that the model described may take. Errors: kLimitExceeded (not even a
  /// beginning fits).
  [[nodiscard]] Result<void> limitMemory(std::uint64_t bytes, const protocol::ModelInfo& info);
  /// Tells the server what is held: it waits for that where a model was opened to go on.
  void sendHaveSet();
  /// The channel is open: asks for hulls and maps, tells the newest view. Errors: as askForHulls().
  [[nodiscard]] Result<void> begin(std::uint64_t nowMs);

  /// A part of the model. Errors: it is damaged, or does not fit what is held.
  template <class Payload>

  requires requires(StreamDecoder& decoder, const Payload& message) { decoder.take(message); }

  [[nodiscard]] Result<void> take(const Payload& message) {
    if (auto taken = decoder_.take(message); !taken) return taken;
    if constexpr (std::is_same_v<Payload, protocol::Base>) {
      if (maxSplits_ > 0) decoder_.reserve(maxSplits_);
    }
    if constexpr (std::is_same_v<Payload, protocol::Map>) keepMap(message.kind);
    return {};
  }

  /// A contour that take() has decoded; asks for the newest view's, if it is another. Returns the
  /// time from request to answer. Errors: kProtocol (nobody asked).
  [[nodiscard]] Result<double> noteContour(const protocol::Contour& message, std::uint64_t nowMs);
  /// Errors: kProtocol (the server says that everything was sent, but splits are missing).
  [[nodiscard]] Result<void> settle(MeshState state);
  /// The answer to makeRoom(). Errors: it was not asked for, or makes no sense.
  [[nodiscard]] Result<void> drop(const protocol::Dropped& message);
  /// Asks the server to forget splits that no view needs. missing: how many more the present one
  /// needs than fit. Errors: kLimitExceeded (there are none; the view does not fit).
  [[nodiscard]] Result<void> makeRoom(std::uint32_t missing);

  // ---- What the user wants

  /// Whether this is another view than the last one.
  [[nodiscard]] bool look(const ClientView& view);
  /// Sends what has become due: a request to open the model, the newest view.
  void onTimer(std::uint64_t nowMs);
  void tellView(std::uint64_t nowMs);
  /// Of hulls and maps that are wanted, asks for what is neither there nor on its way. Errors:
  /// kUnsupported (a hull is needed, and the model has none).
  [[nodiscard]] Result<void> askForHulls();

  // ---- Where it stands

  [[nodiscard]] const StreamDecoder& decoder() const { return decoder_; }

  [[nodiscard]] MeshState state() const;
  /// Whether the newest view has that state or a later one, with hulls, maps and contours that are
  /// wanted.
  [[nodiscard]] bool hasReached(MeshState state) const;

  /// How many splits there is room for; 0: no limit, or not known yet.
  [[nodiscard]] std::uint32_t maxSplits() const { return maxSplits_; }

  /// Id of the newest view; 0: there is none.
  [[nodiscard]] std::uint32_t newestView() const { return poses_.newestId(); }

  /// Whether the server owes something without being told more.
  [[nodiscard]] bool owesAnswer() const;
  /// Whether the server has a view to refine the mesh for.
  [[nodiscard]] bool hasToldView() const;
  /// When onTimer() will have something to do.
  [[nodiscard]] std::optional<std::uint64_t> wakeAtMs() const;

 private:
  void askForContour(std::uint64_t nowMs);
  void askForHull(protocol::HullSide side, std::uint32_t faces);
  void askForMap(protocol::MapKind kind);
  void keepMap(protocol::MapKind kind);
  [[nodiscard]] bool wantsMap(protocol::MapKind kind) const;
  [[nodiscard]] bool hullsAreThere() const;
  [[nodiscard]] bool contourIsThere() const;

  // Constant after construction.
  std::uint8_t channel_;
  std::string model_;
  const StreamOptions& options_;
  Outbox& outbox_;

  StreamDecoder decoder_;
  PoseReporter poses_;
  bool isOpen_ = false;
  std::optional<MeshState> settledAs_;     // what the server said about the newest view
  std::optional<std::uint64_t> openAtMs_;  // the model was not ready

  // Exact contours: ids of views.
  std::uint32_t contourAsked_ = 0;
  std::uint32_t contourGot_ = 0;
  std::uint64_t contourAskedAtMs_ = 0;

  // On this connection.
  std::array<std::uint32_t, 2> hullAsked_{};  // faces, by HullSide
  std::array<bool, kMapKinds> mapAsked_{};

  // Room.
  std::uint32_t maxSplits_ = 0;  // 0: no limit
  Eviction eviction_;
  std::vector<VertexId> dropping_;  // asked for, not answered yet
  std::uint32_t drops_ = 0;         // asked for at this view
};

}  // namespace limn
