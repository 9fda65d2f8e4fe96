// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/hull_streams.h"
#include "client/core/map_streams.h"
#include "client/core/snapshot.h"

#include "protocol/messages.h"

#include "shared/codec/split_codec.h"
#include "shared/core/result.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace limn {

/// Turns the messages of one open model into its mesh. No thread, socket or clock of its own.
/// Threads: one at a time.
class StreamDecoder {
 public:
  /// Begins a model. When it already holds the same asset it goes on with what it holds; another
  /// asset drops everything. Errors: kCorrupt, kLimitExceeded (the split model).
  [[nodiscard]] Result<void> beginModel(const protocol::ModelInfo& info);

  /// Takes Base, LevelBlock, Packet, Seeds, Hull, HullSplits, Map or Contour of this model; no
  /// splits before the base mesh. A split whose prerequisites are missing is an error, which also
  /// keeps level blocks in order. Total over any bytes: after an error the mesh is still valid,
  /// with the splits that came before the damage. Errors: kProtocol (order), kCorrupt,
  /// kNonManifold, kLimitExceeded.
  [[nodiscard]] Result<void> take(const protocol::Base& message);
  [[nodiscard]] Result<void> take(const protocol::LevelBlock& message);
  [[nodiscard]] Result<void> take(const protocol::Packet& message);
  [[nodiscard]] Result<void> take(const protocol::Seeds& message);
  [[nodiscard]] Result<void> take(const protocol::Hull& message);
  [[nodiscard]] Result<void> take(const protocol::HullSplits& message);
  [[nodiscard]] Result<void> take(const protocol::Map& message);
  [[nodiscard]] Result<void> take(const protocol::Contour& message);

  /// Undoes splits that the server has dropped from its account; ids ascending. Errors: kProtocol
  /// (a split that cannot be undone: the account is wrong).
  [[nodiscard]] Result<void> undo(std::span<const VertexId> ids);

  /// Never more splits than this will come: takes the memory for them at once, not by doubling.
  void reserve(std::uint32_t splits) { mesh_.reserve(splits); }

  /// Forgets the model.
  void drop();

  [[nodiscard]] bool hasModel() const { return model_.has_value(); }

  [[nodiscard]] const ModelDescription& model() const { return *model_; }

  [[nodiscard]] bool hasBase() const { return hasBase_; }

  /// Every split is there: the mesh is the prepared mesh.
  [[nodiscard]] bool complete() const {
    return hasBase_ && mesh_.splitsHeld() == mesh_.splitsTotal();
  }

  [[nodiscard]] const ActiveMesh& mesh() const { return mesh_; }

  [[nodiscard]] const std::shared_ptr<const SeedTable>& seeds() const { return seeds_; }

  /// Bytes of the seeds held, for resuming.
  [[nodiscard]] std::uint32_t seedBytesHeld() const { return seedBytesHeld_; }

  /// All seeds that will come are there, if any will.
  [[nodiscard]] bool seedsAreThere() const { return seeds_ || seedBytesExpected_ == 0; }

  [[nodiscard]] const HullStreams& hulls() const { return hulls_; }

  [[nodiscard]] const MapStreams& maps() const { return maps_; }

  /// A map that was kept from another time. False when it is not this model's.
  [[nodiscard]] bool restoreMap(protocol::MapKind kind, std::vector<std::uint8_t> png);

  /// The last contour that came; null: none.
  [[nodiscard]] const std::shared_ptr<const ExactContour>& contour() const { return contour_; }

  /// Grows with every change of the mesh or the seeds.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

  /// A copy of the present mesh that other threads may keep. Cost: O(mesh).
  [[nodiscard]] std::shared_ptr<const MeshSnapshot> snapshot() const;

 private:
  Result<void> takeSplits(protocol::Bytes splits, protocol::Bytes attributes);

  std::optional<ModelDescription> model_;
  std::vector<std::uint32_t> levelBegin_;
  std::uint32_t blockLevels_ = 0;
  SplitDecoder splits_;
  ActiveMesh mesh_;
  bool hasBase_ = false;
  std::shared_ptr<const SeedTable> seeds_;
  std::uint32_t seedBytesExpected_ = 0;
  std::uint32_t seedBytesHeld_ = 0;
  std::vector<std::uint8_t> seedPieces_;  // until they are whole
  HullStreams hulls_;
  MapStreams maps_;
  std::shared_ptr<const ExactContour> contour_;
  std::uint64_t revision_ = 0;
};

}  // namespace limn
