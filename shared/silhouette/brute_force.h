// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/detector.h"

#include <array>
#include <memory>

namespace limn {

/// Tests every face (kEdges) or every vertex and face (kSmooth): the oracle, made as fast as it
/// goes so that whatever claims to beat it has to.
class BruteForceDetector final : public SilhouetteDetector {
 public:
  explicit BruteForceDetector(const SilhouetteField& field, const DetectorOptions& options = {});

  [[nodiscard]] const SilhouetteResult& detect(const SilhouetteView& view) override;

  [[nodiscard]] DetectorMethod method() const override { return DetectorMethod::kBrute; }

  [[nodiscard]] std::size_t memoryBytes() const override;

 private:
  const SilhouetteField* field_;
  VectorCode vectorCode_;
  std::array<std::vector<float>, 4> planes_;  // x, y, z, w of every site, padded to sixteens
  /// What a half-edge is compared with: kEdges, the face across it (its own on a border); kSmooth,
  /// its origin. Padded to sixteen faces.
  std::vector<std::uint32_t> partners_;
  std::vector<std::uint8_t> front_;  // one bit a site, rewritten by every detection
  SilhouetteResult result_;
};

}  // namespace limn
