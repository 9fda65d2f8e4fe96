// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/packet_encoder.h"

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

namespace limn {

/// What a Packet message carries.
struct CodedSplits {
  std::vector<std::uint8_t> splits;
  std::vector<std::uint8_t> attributes;  // empty: the model has none

  [[nodiscard]] std::size_t bytes() const { return splits.size() + attributes.size(); }

  friend bool operator==(const CodedSplits&, const CodedSplits&) = default;
};

/// Makes the splits of Packet messages for all sessions of one model. What a split is coded as is
/// found once and kept; packets are kept too, least recently used forgotten first, so that clients
/// who lack the same splits, a crowd that comes to the same view, share theirs. Safe to use from
/// any thread.
class PacketMaker {
 public:
  /// Both outlive this. cacheBytes: of packets and the ids they are known by; 0: none are kept.
  PacketMaker(
      const SplitForest& forest,
      const SplitModel& model,
      std::size_t cacheBytes = kCacheBytes);

  /// encodeSplits(forest, model, ids) and encodeAttributes(forest, ids), perhaps made before. Never
  /// null.
  [[nodiscard]] std::shared_ptr<const CodedSplits> packet(std::span<const VertexId> ids);

  [[nodiscard]] std::size_t bytes() const;

  [[nodiscard]] std::uint64_t hits() const;

  static constexpr std::size_t kCacheBytes = std::size_t{16} << 20;

 private:
  struct Entry {
    std::uint64_t hash = 0;
    std::vector<VertexId> ids;
    std::shared_ptr<const CodedSplits> packet;

    [[nodiscard]] std::size_t bytes() const {
      return sizeof(Entry) + 64 + ids.capacity() * sizeof(VertexId) + packet->splits.capacity() +
             packet->attributes.capacity();
    }
  };

  void keep(Entry entry);

  const SplitForest& forest_;
  std::size_t cacheBytes_;
  mutable std::mutex mutex_;
  // Guarded by mutex_.
  PacketEncoder encoder_;
  std::list<Entry> entries_;  // most recently used first
  std::unordered_map<std::uint64_t, std::list<Entry>::iterator> byHash_;
  std::size_t keptBytes_ = 0;
  std::uint64_t hits_ = 0;
};

}  // namespace limn
