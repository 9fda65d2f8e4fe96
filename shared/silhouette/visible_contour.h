// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/field.h"
#include "shared/silhouette/nearness_image.h"
#include "shared/silhouette/picture.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// A point of a visible silhouette in a picture.
struct ContourPoint {
  glm::vec2 px{0.0F};
  float lengthPx = 0.0F;      // of the silhouette that it stands for
  std::uint32_t segment = 0;  // kEdges: half-edge of the front face; kSmooth: the crossed face
};

/// Finds what of a mesh's silhouettes a picture shows, without GL: as a client finds it, by brute
/// force and the 8-neighbourhood test [Mohr13 §3.4] against a depth image. Keeps its working memory
/// from call to call. Threads: one caller at a time.
class VisibleContourFinder {
 public:
  /// Points at most spacingPx apart along the visible silhouettes of `field`, within the picture,
  /// one at least a visible segment. Valid until the next call.
  /// Cost: O(faces + pixels + length).
  [[nodiscard]] const std::vector<ContourPoint>&
  find(const SilhouetteField& field, const PictureView& picture, double spacingPx = 0.5);

  /// Of the last find(): PictureView::project of every vertex.
  [[nodiscard]] std::span<const glm::vec3> projected() const { return projected_; }

 private:
  std::vector<glm::vec3> projected_;
  NearnessImage image_;
  std::vector<std::uint8_t> front_;
  std::vector<ContourPoint> points_;
};

}  // namespace limn
