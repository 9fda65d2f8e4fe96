// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/detector.h"

#include <vector>

namespace limn {

/// Starts from seeds that were prepared for the viewpoints nearest to the eye, walks from each to a
/// silhouette, and traces that [Mohr13 §3.2.4]. Finds what the seeds lead to: measure it with
/// recall().
class PrecomputedDetector final : public SilhouetteDetector {
 public:
  PrecomputedDetector(const SilhouetteField& field, const DetectorOptions& options);

  [[nodiscard]] const SilhouetteResult& detect(const SilhouetteView& view) override;

  [[nodiscard]] DetectorMethod method() const override { return DetectorMethod::kPrecomputed; }

  [[nodiscard]] std::size_t memoryBytes() const override;

 private:
  void chooseViewpoints(const glm::vec3& toEye);
  void searchEdges(std::uint32_t slot, const glm::vec4& eye);
  void searchSmooth(std::uint32_t slot, const glm::vec4& eye);
  void traceEdges(HalfEdgeId first, const glm::vec4& eye);
  void traceSmooth(FaceId first, const glm::vec4& eye);
  bool mark(FaceId f, std::uint32_t bit);
  [[nodiscard]] bool isOnPath(std::uint32_t site) const;

  const SilhouetteField* field_;
  int viewpoints_;
  int steps_;
  // Constant after construction: viewpoints, and the slots of each one's seeds.
  std::vector<glm::vec3> directions_;
  std::vector<std::uint32_t> slotBegin_;
  std::vector<std::uint32_t> slots_;
  // Working memory. Marks hold the frame above three bits, one a half-edge (bit 0: the face).
  std::vector<std::uint32_t> nearest_;
  std::vector<std::uint32_t> path_;  // sites of the walk from the present seed
  std::vector<std::uint32_t> marks_;
  std::uint32_t frame_ = 0;
  SilhouetteResult result_;
};

}  // namespace limn
