// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/contour/contour_extractor.h"
#include "server/session/dependents.h"
#include "server/session/full_mesh.h"
#include "server/session/packet_maker.h"
#include "server/session/view.h"
#include "server/store/asset_store.h"

#include "protocol/messages.h"

#include "shared/codec/split_codec.h"
#include "shared/progressive/split_forest.h"

#include <array>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace limn {

/// A prepared model in memory, ready to be streamed: its forest, and the wire messages that are the
/// same for everyone. Safe to use from any thread.
class Model {
 public:
  /// Parses and cross-checks an asset's sections. Errors: kNotFound, kCorrupt.
  /// Cost: O(asset), about 0.1 s a million vertices.
  [[nodiscard]] static Result<std::shared_ptr<const Model>> load(
      std::shared_ptr<const Asset> asset);

  [[nodiscard]] const Sha256Digest& id() const { return asset_->id(); }

  [[nodiscard]] const SplitForest& forest() const { return forest_; }

  [[nodiscard]] const SplitModel& splitModel() const { return splitModel_; }

  [[nodiscard]] const protocol::ModelInfo& info() const {
    return *infoMessage_.as<protocol::ModelInfo>();
  }

  /// smoothConesOf(forest()).
  [[nodiscard]] const std::vector<SplitCone>& smoothCones() const { return smoothCones_; }

  // Whole messages, channel 0.
  [[nodiscard]] protocol::Bytes base() const { return base_; }

  [[nodiscard]] const std::vector<protocol::Bytes>& blocks() const { return blocks_; }

  /// A level run (encodeLevelRun) of what comes after the level blocks: for a client that holds
  /// every vertex before `begin`, and smaller than splits picked one by one.
  struct Run {
    VertexId begin = 0;
    VertexId end = 0;
    protocol::Bytes splits;  // as in Packet
    protocol::Bytes attributes;
  };

  /// In order, without gaps, to the last vertex.
  [[nodiscard]] const std::vector<Run>& runs() const { return runs_; }

  /// One Hull, then HullSplits in order. Empty: none.
  [[nodiscard]] const std::vector<protocol::Bytes>& hull(protocol::HullSide side) const {
    return hulls_[static_cast<std::size_t>(side)];
  }

  /// Maps in order. Empty: none.
  [[nodiscard]] const std::vector<protocol::Bytes>& map(protocol::MapKind kind) const {
    return maps_[static_cast<std::size_t>(kind)];
  }

  /// The content of the Seeds messages. Empty: none.
  [[nodiscard]] protocol::Bytes seeds() const { return seeds_; }

  /// Made on first use: O(faces), and as much memory again as the forest. Null when the full mesh
  /// is no manifold, which preparation never leaves behind.
  [[nodiscard]] const FullMesh* fullMesh() const;
  /// Silhouettes of the full mesh. Made on first use, 1 µs a face and 20 bytes. Null as fullMesh().
  [[nodiscard]] const ContourExtractor* contours(SilhouetteKind kind) const;
  /// Made on first use: few clients ever drop anything.
  [[nodiscard]] const Dependents& dependents() const;
  /// Made on first use: 4 bytes a split, and more for those that are sent.
  [[nodiscard]] PacketMaker& packets() const;
  /// Memory held, mapped sections excluded, what is made on first use included from then on.
  [[nodiscard]] std::size_t bytes() const;

 private:
  Model() = default;

  /// Takes over the packets of the whole stream. False when they are not that.
  [[nodiscard]] bool takeRuns(std::span<const protocol::Bytes> packets);

  std::shared_ptr<const Asset> asset_;
  SplitForest forest_;
  SplitModel splitModel_;
  std::vector<SplitCone> smoothCones_;
  protocol::Message infoMessage_;
  protocol::Bytes base_;
  std::vector<protocol::Bytes> blocks_;
  std::vector<protocol::Message> runMessages_;
  std::vector<Run> runs_;  // of runMessages_
  std::array<std::vector<protocol::Bytes>, 2> hulls_;
  std::array<std::vector<protocol::Bytes>, 2> maps_;  // by MapKind
  protocol::Message seedsMessage_;
  protocol::Bytes seeds_;  // of seedsMessage_
  mutable std::mutex mutex_;
  mutable std::unique_ptr<const FullMesh> full_;  // guarded by mutex_, constant once made
  mutable bool fullFailed_ = false;               // guarded by mutex_
  mutable std::array<std::unique_ptr<const ContourExtractor>, 2> contours_;  // as full_, by kind
  mutable std::unique_ptr<const Dependents> dependents_;  // guarded by mutex_, constant once made
  mutable std::unique_ptr<PacketMaker> packets_;          // made under mutex_
};

/// A message with another channel. Messages without one, and those that have it already, come back
/// as they are. `message`: well-formed, from the server.
[[nodiscard]] std::vector<std::uint8_t> withChannel(protocol::Bytes message, std::uint8_t channel);

}  // namespace limn
