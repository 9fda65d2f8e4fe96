// SPDX-License-Identifier: Apache-2.0
// Based on: M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 3.2.4:
// silhouettes precomputed for a grid of viewpoints give the seeds.
// Deviations: seeds are vertices of a progressive mesh, so one that is not refined yet stands for
// its nearest ancestor; from a seed the search walks downhill in |normal · view| instead of testing
// a fixed neighbourhood; several viewpoints may give seeds at once.
#include "shared/silhouette/precomputed.h"

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

PrecomputedDetector::PrecomputedDetector(
    const SilhouetteField& field,
    const DetectorOptions& options)
    : SeededDetector(field),
      viewpoints_(options.seedViewpoints),
      steps_(options.seedSearchSteps) {
  if (options.seeds == nullptr) return;
  const SeedTable& table = *options.seeds;
  directions_ = table.directions;
  const auto slots = slotsOfNodes(table, options.slotOf, field.mesh().vertexCount());
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

void PrecomputedDetector::search(const SilhouetteView& /*view*/) {
  chooseViewpoints(glm::vec3(tracer().eye()));
  for (const std::uint32_t v : nearest_) {
    for (std::uint32_t i = slotBegin_[v]; i < slotBegin_[v + 1]; ++i) {
      ++tracer().stats().seedsTried;
      tracer().walkFromVertex(slots_[i], steps_);
    }
  }
}

void PrecomputedDetector::chooseViewpoints(const glm::vec3& toEye) {
  nearest_.resize(directions_.size());
  for (std::uint32_t v = 0; v < nearest_.size(); ++v)
    nearest_[v] = v;
  const auto count = std::min(nearest_.size(), static_cast<std::size_t>(std::max(viewpoints_, 0)));
  std::partial_sort(
      nearest_.begin(),
      nearest_.begin() + static_cast<std::ptrdiff_t>(count),
      nearest_.end(),
      [&](std::uint32_t a, std::uint32_t b) {
        return glm::dot(directions_[a], toEye) > glm::dot(directions_[b], toEye);
      });
  nearest_.resize(count);
}

std::size_t PrecomputedDetector::memoryBytes() const {
  return tracerBytes() + directions_.size() * sizeof(glm::vec3) +
         (slotBegin_.size() + slots_.size() + nearest_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace limn
