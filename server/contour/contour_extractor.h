// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/contour/contour_loops.h"

#include "shared/silhouette/detector.h"
#include "shared/silhouette/field.h"

#include <memory>
#include <mutex>

namespace limn {

/// Finds the silhouettes of one mesh, all of them, from any eye: a search structure and its working
/// memory, shared by all sessions. Safe from any thread; searches come one after another, and take
/// a small part of what coding their result takes.
class ContourExtractor {
 public:
  /// field must outlive it. Cost: about 1 µs a face.
  explicit ContourExtractor(const SilhouetteField& field);

  /// Cost: O(√faces) on smooth shapes; 0.1 to 1 ms for 200,000 faces.
  [[nodiscard]] ContourLines extract(const SilhouetteView& view) const;

  [[nodiscard]] std::size_t bytes() const;

 private:
  mutable std::mutex mutex_;
  std::unique_ptr<SilhouetteDetector> detector_;  // guarded by mutex_
  mutable ContourLinker linker_;                  // guarded by mutex_
};

}  // namespace limn
