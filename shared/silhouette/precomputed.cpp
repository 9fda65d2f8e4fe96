// SPDX-License-Identifier: Apache-2.0
// Based on: M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 3.2.4:
// silhouettes precomputed for a grid of viewpoints give the seeds.
// Deviations: seeds are vertices of a progressive mesh, so one that is not refined yet stands for
// its nearest ancestor; from a seed the search walks downhill in |normal · view| instead of testing
// a fixed neighbourhood; several viewpoints may give seeds at once, and so does the last frame.
#include "shared/silhouette/precomputed.h"

namespace limn {
namespace {

// A step of the eye after which the last frame says nothing, in distances from the model.
constexpr float kLongestStep = 0.2F;

}  // namespace

PrecomputedDetector::PrecomputedDetector(
    const SilhouetteField& field,
    const DetectorOptions& options)
    : SeededDetector(field),
      viewpoints_(options.seedViewpoints),
      steps_(options.seedSearchSteps),
      motionRings_(options.seedMotionRings) {
  if (options.seeds != nullptr)
    seeds_ = SeedSlots(*options.seeds, options.slotOf, field.mesh().vertexCount());
}

void PrecomputedDetector::search(const SilhouetteView& /*view*/) {
  for (const std::uint32_t v : seeds_.nearest(glm::vec3(tracer().eye()), viewpoints_)) {
    for (const std::uint32_t slot : seeds_.seedsOf(v)) {
      ++tracer().stats().seedsTried;
      tracer().walkFromVertex(slot, steps_);
    }
  }
  if (motionRings_ > 0) followMotion();
}

// From the last frame's silhouettes: on where they still are, else to where the camera's motion can
// have taken them [Mohr13 §3.2.2].
void PrecomputedDetector::followMotion() {
  const glm::vec3 eye(tracer().eye());
  const glm::vec3 before(lastEye_);
  const bool isNear = lastEye_.w == tracer().eye().w &&
                      glm::distance(eye, before) <= kLongestStep * glm::length(eye);
  if (isNear) {
    for (const FaceId f : lastFaces_) {
      if (tracer().holdsSegment(f) || !tracer().visit(f)) continue;
      if (!tracer().follow(f))
        tracer().searchAround(f, motionRings_, SilhouetteTracer::Found::kFollowed, &lastEye_);
    }
  }
  lastEye_ = tracer().eye();
  lastFaces_.clear();
  for (std::size_t i = 0; i < tracer().segmentCount(); ++i)
    lastFaces_.push_back(tracer().faceOf(i));
}

std::size_t PrecomputedDetector::memoryBytes() const {
  return tracerBytes() + seeds_.memoryBytes() + lastFaces_.capacity() * sizeof(FaceId);
}

}  // namespace limn
