// SPDX-License-Identifier: Apache-2.0
#include "server/contour/contour_extractor.h"

namespace limn {

ContourExtractor::ContourExtractor(const SilhouetteField& field)
    : detector_(makeDetector(DetectorMethod::kCones, field)),
      linker_(field) {}

ContourLines ContourExtractor::extract(const SilhouetteView& view) const {
  const std::lock_guard lock(mutex_);
  return linker_.link(view, detector_->detect(view));
}

std::size_t ContourExtractor::bytes() const {
  const std::lock_guard lock(mutex_);
  return sizeof(*this) + detector_->memoryBytes() + linker_.bytes();
}

}  // namespace limn
