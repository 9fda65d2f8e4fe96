// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/seeds/face_image.h"

#include "shared/core/camera.h"
#include "shared/silhouette/detector.h"
#include "shared/silhouette/field.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

/// A camera over a mesh on its grid, for square pictures.
struct GridView {
  glm::dmat4 clipFromGrid{1.0};
  SilhouetteView silhouette;

  [[nodiscard]] static GridView of(const Camera& camera, const Grid& grid);
};

/// Silhouette loops of one view, one after the other. A segment is named by a vertex beside it.
struct SilhouetteLoops {
  std::vector<VertexId> vertices;       // one a segment
  std::vector<std::uint32_t> begin{0};  // loops + 1 offsets

  [[nodiscard]] std::size_t count() const { return begin.size() - 1; }
};

/// Traces everything `found` has (all silhouettes of the field from that view) into loops.
[[nodiscard]] SilhouetteLoops
traceLoops(const SilhouetteField& field, const SilhouetteView& view, const SilhouetteResult& found);

/// How well each segment of some loops is seen.
enum class Seen : std::uint8_t {
  kHidden,
  kVisible,    // nothing nearer in the pixels around it
  kConfirmed,  // and an edge of the picture passes there
};

/// Judges segments by a picture of the mesh: depth by the planes of the faces it shows, edges by
/// Canny's detector on its shading and depth [Canny86].
class VisibilityJudge {
 public:
  /// faces: a field of kind kEdges of the mesh the picture shows; `radius`: its extent, grid units.
  VisibilityJudge(
      const SilhouetteField& faces,
      const GridView& view,
      const FaceImage& image,
      double radius);

  /// How the vertex is seen, and in `pixel` where.
  [[nodiscard]] Seen judge(VertexId v, glm::vec2& pixel) const;

 private:
  [[nodiscard]] float depthAt(int x, int y) const {
    return depth_
        [static_cast<std::size_t>(y) * static_cast<std::size_t>(image_->size) +
         static_cast<std::size_t>(x)];
  }

  void computeDepth(const SilhouetteField& faces);
  void findEdges(double radius);

  const FaceImage* image_;
  const SilhouetteField* faces_;
  GridView view_;
  float slack_;
  std::vector<float> depth_;          // distance from the eye along each pixel's ray
  std::vector<float> shade_;          // |cosine| between ray and normal
  std::vector<std::uint8_t> isEdge_;  // Canny, widened by a pixel
};

}  // namespace limn
