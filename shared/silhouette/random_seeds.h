// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/rng.h"
#include "shared/silhouette/tracer.h"

#include <vector>

namespace limn {

/// Tests a random share of the faces in every frame and traces what it hits [Mohr13 §3.2.1]: a
/// silhouette is found with a probability that grows with its length.
class RandomDetector final : public SeededDetector {
 public:
  RandomDetector(const SilhouetteField& field, const RandomSeedOptions& options);

  [[nodiscard]] DetectorMethod method() const override { return DetectorMethod::kRandom; }

  [[nodiscard]] std::size_t memoryBytes() const override {
    return tracerBytes() + byDihedral_.size() * sizeof(FaceId);
  }

 private:
  void search(const SilhouetteView& view) override;

  RandomSeedOptions options_;
  std::vector<FaceId> byDihedral_;  // sharpest first; empty: not asked for
  Rng rng_;
};

}  // namespace limn
