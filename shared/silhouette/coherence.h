// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/tracer.h"

#include <memory>
#include <optional>
#include <vector>

namespace limn {

/// When a detector that lives off its last frame starts afresh [Mohr13 §3.2.2].
class ReseedTrigger {
 public:
  explicit ReseedTrigger(const CoherenceOptions& options) : options_(options) {}

  /// Whether this frame should start afresh; counts it.
  [[nodiscard]] bool isDue();
  /// What a frame found; afresh: it was one that started afresh.
  void found(std::size_t segments, bool afresh);

 private:
  CoherenceOptions options_;
  int framesSince_ = -1;  // -1: there was none
  std::size_t atReseed_ = 0;
  std::size_t atLast_ = 0;
};

/// Looks where the last frame's silhouettes were and in a small neighbourhood, without tracing
/// (Coherence A): fast, and loses what moves too far.
class CoherenceADetector final : public SeededDetector {
 public:
  CoherenceADetector(const SilhouetteField& field, const DetectorOptions& options);

  [[nodiscard]] DetectorMethod method() const override { return DetectorMethod::kCoherenceA; }

  [[nodiscard]] std::size_t memoryBytes() const override;

 private:
  void search(const SilhouetteView& view) override;

  CoherenceOptions options_;
  std::unique_ptr<SilhouetteDetector> reseeder_;
  ReseedTrigger trigger_;
  std::vector<FaceId> previous_;
  glm::vec4 previousEye_{0.0F};
};

/// Traces from every face that was a silhouette often enough lately: a counter a face goes up with
/// each frame that finds one there and down with each that does not (Coherence B).
class CoherenceBDetector final : public SeededDetector {
 public:
  CoherenceBDetector(const SilhouetteField& field, const DetectorOptions& options);

  [[nodiscard]] DetectorMethod method() const override { return DetectorMethod::kCoherenceB; }

  [[nodiscard]] std::size_t memoryBytes() const override;

 private:
  void search(const SilhouetteView& view) override;
  void updateHistory();

  CoherenceOptions options_;
  std::unique_ptr<SilhouetteDetector> reseeder_;
  ReseedTrigger trigger_;
  std::vector<std::uint8_t> history_;  // by face
  std::vector<FaceId> seeds_;          // faces with a history
};

}  // namespace limn
