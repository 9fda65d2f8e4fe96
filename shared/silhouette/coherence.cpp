// SPDX-License-Identifier: Apache-2.0
// Based on: M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 3.2.2
// (Coherence A and B, reseeding, camera tracking).
#include "shared/silhouette/coherence.h"

#include <algorithm>

namespace limn {
namespace {

// Reseeding with random seeds may lose silhouettes; with brute force it cannot.
std::unique_ptr<SilhouetteDetector> makeReseeder(
    const SilhouetteField& field,
    const DetectorOptions& options) {
  const bool isRandom = options.coherence.reseedWith == DetectorMethod::kRandom;
  return makeDetector(isRandom ? DetectorMethod::kRandom : DetectorMethod::kBrute, field, options);
}

}  // namespace

bool ReseedTrigger::isDue() {
  const bool isLate = options_.reseedEvery > 0 && framesSince_ + 1 >= options_.reseedEvery;
  const bool isLosing =
      options_.reseedBelow > 0.0 &&
      static_cast<double>(atLast_) < options_.reseedBelow * static_cast<double>(atReseed_);
  if (framesSince_ < 0 || isLate || isLosing) {
    framesSince_ = 0;
    return true;
  }
  ++framesSince_;
  return false;
}

void ReseedTrigger::found(std::size_t segments, bool afresh) {
  atLast_ = segments;
  if (afresh) atReseed_ = segments;
}

CoherenceADetector::CoherenceADetector(const SilhouetteField& field, const DetectorOptions& options)
    : SeededDetector(field),
      options_(options.coherence),
      reseeder_(makeReseeder(field, options)),
      trigger_(options.coherence) {}

void CoherenceADetector::search(const SilhouetteView& view) {
  const bool afresh = trigger_.isDue();
  if (afresh) {
    tracer().adopt(reseeder_->detect(view));
  } else {
    const glm::vec4* before = options_.followMotion ? &previousEye_ : nullptr;
    for (const FaceId f : previous_) {
      ++tracer().stats().seedsTried;
      // A face without a silhouette now says that it has moved on.
      if (tracer().visit(f) && !tracer().take(f)) {
        tracer().searchAround(f, options_.rings, SilhouetteTracer::Found::kTaken, before);
      }
    }
  }
  trigger_.found(tracer().segmentCount(), afresh);
  previous_.clear();
  for (std::size_t i = 0; i < tracer().segmentCount(); ++i)
    previous_.push_back(tracer().faceOf(i));
  previousEye_ = tracer().eye();
}

std::size_t CoherenceADetector::memoryBytes() const {
  return tracerBytes() + reseeder_->memoryBytes() + previous_.capacity() * sizeof(FaceId);
}

CoherenceBDetector::CoherenceBDetector(const SilhouetteField& field, const DetectorOptions& options)
    : SeededDetector(field),
      options_(options.coherence),
      reseeder_(makeReseeder(field, options)),
      trigger_(options.coherence),
      history_(field.mesh().faceCount(), 0) {}

void CoherenceBDetector::search(const SilhouetteView& view) {
  const bool afresh = trigger_.isDue();
  if (afresh) {
    tracer().adopt(reseeder_->detect(view));
  } else {
    for (const FaceId f : seeds_) {
      ++tracer().stats().seedsTried;
      if (tracer().visit(f)) tracer().follow(f);
    }
  }
  trigger_.found(tracer().segmentCount(), afresh);
  updateHistory();
}

void CoherenceBDetector::updateHistory() {
  const auto most = static_cast<std::uint8_t>(std::clamp(options_.longestHistory, 1, 255));
  std::size_t kept = 0;
  for (const FaceId f : seeds_) {
    std::uint8_t& count = history_[f];
    if (!tracer().holdsSegment(f)) {
      --count;
    } else if (count < most) {
      ++count;
    }
    if (count > 0) seeds_[kept++] = f;
  }
  seeds_.resize(kept);
  for (std::size_t i = 0; i < tracer().segmentCount(); ++i) {
    const FaceId f = tracer().faceOf(i);
    if (history_[f] > 0) continue;
    history_[f] = 1;
    seeds_.push_back(f);
  }
}

std::size_t CoherenceBDetector::memoryBytes() const {
  return tracerBytes() + reseeder_->memoryBytes() + history_.size() +
         seeds_.capacity() * sizeof(FaceId);
}

}  // namespace limn
