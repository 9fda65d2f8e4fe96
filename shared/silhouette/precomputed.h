// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/tracer.h"

#include <vector>

namespace limn {

/// Starts from seeds that were prepared for the viewpoints nearest to the eye, walks from each to a
/// silhouette, and traces that [Mohr13 §3.2.4].
class PrecomputedDetector final : public SeededDetector {
 public:
  PrecomputedDetector(const SilhouetteField& field, const DetectorOptions& options);

  [[nodiscard]] DetectorMethod method() const override { return DetectorMethod::kPrecomputed; }

  [[nodiscard]] std::size_t memoryBytes() const override;

 private:
  void search(const SilhouetteView& view) override;
  void chooseViewpoints(const glm::vec3& toEye);

  int viewpoints_;
  int steps_;
  // Constant after construction: viewpoints, and the slots of each one's seeds.
  std::vector<glm::vec3> directions_;
  std::vector<std::uint32_t> slotBegin_;
  std::vector<std::uint32_t> slots_;
  std::vector<std::uint32_t> nearest_;
};

}  // namespace limn
