// SPDX-License-Identifier: Apache-2.0
#include "shared/silhouette/seed_slots.h"

#include <algorithm>

namespace limn {
namespace {

// The slot that each node of a table stands for: its own, else its nearest held ancestor's.
std::vector<std::uint32_t>
slotsOfNodes(const SeedTable& table, const SlotLookup& slotOf, std::uint32_t vertexCount) {
  std::vector<std::uint32_t> slots(table.nodes.size(), kNone);
  for (std::size_t i = 0; i < table.nodes.size(); ++i) {
    const SeedTable::Node& node = table.nodes[i];
    const Slot own = slotOf ? slotOf(node.vertex) : node.vertex;
    if (own < vertexCount) {
      slots[i] = own;
    } else if (node.parent < i) {  // parents come before children
      slots[i] = slots[node.parent];
    }
  }
  return slots;
}

}  // namespace

SeedSlots::SeedSlots(const SeedTable& table, const SlotLookup& slotOf, std::uint32_t vertexCount)
    : directions_(table.directions) {
  const auto slots = slotsOfNodes(table, slotOf, vertexCount);
  slotBegin_.push_back(0);
  for (std::size_t v = 0; v + 1 < table.seedBegin.size(); ++v) {
    for (std::uint32_t i = table.seedBegin[v]; i < table.seedBegin[v + 1]; ++i) {
      const std::uint32_t node = i < table.seeds.size() ? table.seeds[i] : kNone;
      const std::uint32_t slot = node < slots.size() ? slots[node] : kNone;
      // Seeds that share an ancestor are one.
      if (slot != kNone &&
          std::find(slots_.begin() + slotBegin_.back(), slots_.end(), slot) == slots_.end()) {
        slots_.push_back(slot);
      }
    }
    slotBegin_.push_back(static_cast<std::uint32_t>(slots_.size()));
  }
  directions_.resize(std::min(directions_.size(), slotBegin_.size() - 1));
}

std::span<const std::uint32_t> SeedSlots::nearest(const glm::vec3& toEye, int count) {
  nearest_.resize(directions_.size());
  for (std::uint32_t v = 0; v < nearest_.size(); ++v)
    nearest_[v] = v;
  const auto most = std::min(nearest_.size(), static_cast<std::size_t>(std::max(count, 0)));
  std::partial_sort(
      nearest_.begin(),
      nearest_.begin() + static_cast<std::ptrdiff_t>(most),
      nearest_.end(),
      [&](std::uint32_t a, std::uint32_t b) {
        return glm::dot(directions_[a], toEye) > glm::dot(directions_[b], toEye);
      });
  return std::span<const std::uint32_t>(nearest_).first(most);
}

std::size_t SeedSlots::memoryBytes() const {
  return directions_.size() * sizeof(glm::vec3) +
         (slotBegin_.size() + slots_.size() + nearest_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace limn
