// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/seed_slots.h"
#include "shared/silhouette/tracer.h"

#include <vector>

namespace limn {

/// Starts from seeds that were prepared for the viewpoints nearest to the eye, walks from each to a
/// silhouette, and traces that [Mohr13 §3.2.4]; and goes on from the last frame's.
class PrecomputedDetector final : public SeededDetector {
 public:
  PrecomputedDetector(const SilhouetteField& field, const DetectorOptions& options);

  [[nodiscard]] DetectorMethod method() const override { return DetectorMethod::kPrecomputed; }

  [[nodiscard]] std::size_t memoryBytes() const override;

 private:
  void search(const SilhouetteView& view) override;
  void followMotion();

  int viewpoints_;
  int steps_;
  int motionRings_;
  SeedSlots seeds_;
  // The last frame.
  std::vector<FaceId> lastFaces_;
  glm::vec4 lastEye_{0.0F};
};

}  // namespace limn
