// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/tracer.h"

#include <cstdint>
#include <utility>

namespace limn {

/// Starts from the faces under the edges of a picture of the mesh [Mohr13 §3.2.3]. Who draws the
/// picture and finds its edges is the caller's business (DetectorOptions::imageFaces); hidden
/// silhouettes are only found where visible ones lead to them.
class ImageDetector final : public SeededDetector {
 public:
  ImageDetector(const SilhouetteField& field, const DetectorOptions& options)
      : SeededDetector(field),
        faces_(options.imageFaces),
        rings_(options.imageRings) {}

  [[nodiscard]] DetectorMethod method() const override { return DetectorMethod::kImage; }

  [[nodiscard]] std::size_t memoryBytes() const override { return tracerBytes(); }

 private:
  void search(const SilhouetteView& view) override {
    if (!faces_) return;
    for (const FaceId f : faces_(view)) {
      if (f >= field().mesh().faceCount()) continue;
      ++tracer().stats().seedsTried;
      if (!tracer().visit(f) || tracer().follow(f)) continue;
      tracer().searchAround(f, rings_, SilhouetteTracer::Found::kFollowed);
    }
  }

  SeedFaces faces_;
  int rings_;
};

}  // namespace limn
