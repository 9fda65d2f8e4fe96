// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/detector.h"
#include "shared/silhouette/seed_table.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// The seeds of a table as vertices of one mesh state: a seed whose vertex is not held stands for
/// its nearest held ancestor, and those that share one are one. Total over any table.
class SeedSlots {
 public:
  SeedSlots() = default;
  /// slotOf: where the mesh holds a vertex; empty: slot = id. Cost: O(table).
  SeedSlots(const SeedTable& table, const SlotLookup& slotOf, std::uint32_t vertexCount);

  [[nodiscard]] std::size_t viewpointCount() const { return directions_.size(); }

  [[nodiscard]] std::span<const std::uint32_t> seedsOf(std::uint32_t viewpoint) const {
    return {
        slots_.data() + slotBegin_[viewpoint],
        slotBegin_[viewpoint + 1] - slotBegin_[viewpoint]};
  }

  /// The `count` viewpoints nearest in direction to an eye, nearest first. Valid until the next
  /// call. toEye: from the model's centre. Cost: O(viewpoints).
  [[nodiscard]] std::span<const std::uint32_t> nearest(const glm::vec3& toEye, int count);

  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  std::vector<glm::vec3> directions_;  // of viewpoints
  std::vector<std::uint32_t> slotBegin_;
  std::vector<std::uint32_t> slots_;
  std::vector<std::uint32_t> nearest_;
};

}  // namespace limn
