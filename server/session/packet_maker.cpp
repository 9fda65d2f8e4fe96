// SPDX-License-Identifier: Apache-2.0
#include "server/session/packet_maker.h"

#include "shared/codec/attribute_codec.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace limn {
namespace {

std::uint64_t hashOf(std::span<const VertexId> ids) {
  std::uint64_t hash = 0x9E3779B97F4A7C15ULL * (ids.size() + 1);
  for (const VertexId id : ids) {
    hash = (hash ^ id) * 0xD6E8FEB86659FD93ULL;
    hash ^= hash >> 32;
  }
  return hash;
}

}  // namespace

PacketMaker::PacketMaker(const SplitForest& forest, const SplitModel& model, std::size_t cacheBytes)
    : forest_(forest),
      cacheBytes_(cacheBytes),
      encoder_(forest, model) {}

std::shared_ptr<const CodedSplits> PacketMaker::packet(std::span<const VertexId> ids) {
  const std::uint64_t hash = cacheBytes_ == 0 ? 0 : hashOf(ids);
  const std::lock_guard lock(mutex_);
  // Known by all of its ids: two sets with one hash never share a packet.
  if (const auto found = byHash_.find(hash);
      found != byHash_.end() && std::ranges::equal(found->second->ids, ids)) {
    entries_.splice(entries_.begin(), entries_, found->second);
    ++hits_;
    return found->second->packet;
  }
  auto packet = std::make_shared<const CodedSplits>(
      CodedSplits{encoder_.encode(ids), encodeAttributes(forest_, ids)});
  if (cacheBytes_ > 0) keep({hash, {ids.begin(), ids.end()}, packet});
  return packet;
}

void PacketMaker::keep(Entry entry) {
  const auto forget = [this](std::list<Entry>::iterator which) {
    keptBytes_ -= which->bytes();
    byHash_.erase(which->hash);
    entries_.erase(which);
  };
  if (const auto same = byHash_.find(entry.hash); same != byHash_.end()) forget(same->second);
  keptBytes_ += entry.bytes();
  entries_.push_front(std::move(entry));
  byHash_.emplace(entries_.front().hash, entries_.begin());
  while (keptBytes_ > cacheBytes_ && !entries_.empty())
    forget(std::prev(entries_.end()));
}

std::size_t PacketMaker::bytes() const {
  const std::lock_guard lock(mutex_);
  return sizeof(*this) + encoder_.bytes() + keptBytes_;
}

std::uint64_t PacketMaker::hits() const {
  const std::lock_guard lock(mutex_);
  return hits_;
}

}  // namespace limn
