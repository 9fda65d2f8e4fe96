// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/gl/context.h"
#include "shared/gl/handles.h"
#include "shared/gl/program.h"
#include "shared/gl/target.h"
#include "shared/mesh/triangle_mesh.h"

#include <glm/glm.hpp>

#include <vector>

namespace limn {

/// Which face is seen at each pixel of a square picture.
struct FaceImage {
  int size = 0;               // pixels a side
  std::vector<FaceId> faces;  // rows from the bottom up; kNone: background

  [[nodiscard]] FaceId at(int x, int y) const {
    return faces
        [static_cast<std::size_t>(y) * static_cast<std::size_t>(size) +
         static_cast<std::size_t>(x)];
  }
};

/// Whether faces seen from behind are drawn. Leaving them out is right for closed meshes seen from
/// outside, and half the work.
enum class BackFaces { kDrawn, kLeftOut };

/// Draws face-id images of one mesh. Threads: the context's.
class FaceImageRenderer {
 public:
  /// `context` must outlive it. size: pixels a side. Errors: kUnavailable, kLimitExceeded.
  [[nodiscard]] static Result<FaceImageRenderer>
  create(const GlContext& context, const TriangleMesh& mesh, int size, BackFaces backFaces);

  /// clipFromGrid: of the whole mesh, grid units. Cost: some 0.1 µs a face.
  [[nodiscard]] FaceImage render(const glm::dmat4& clipFromGrid) const;

 private:
  const gl::Api* api_ = nullptr;
  gl::Program program_;
  gl::Target target_;
  gl::VertexArray vertexArray_;
  gl::Buffer corners_;
  GLsizei cornerCount_ = 0;
  BackFaces backFaces_ = BackFaces::kDrawn;
};

}  // namespace limn
