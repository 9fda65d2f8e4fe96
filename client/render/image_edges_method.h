// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/drawing_method.h"

#include "shared/gl/program.h"

#include <memory>

namespace limn {

/// Lines where depth or normals of neighbouring pixels do not belong together [Saito90,
/// Hertzmann99]: outlines, folds and creases, in one full-screen pass over a picture of normals and
/// depth. Knows nothing of the mesh's edges.
class ImageEdgesMethod final : public DrawingMethod {
 public:
  /// Errors: kUnavailable.
  [[nodiscard]] static Result<std::unique_ptr<DrawingMethod>> create(DrawTools& tools);

  [[nodiscard]] Result<void>
  draw(const DrawRequest& request, const gl::Target& picture, FrameTimings& timings) override;

 private:
  explicit ImageEdgesMethod(DrawTools& tools) : tools_(tools) {}

  void findEdges(const DrawRequest& request, const gl::Target& picture) const;

  DrawTools& tools_;
  gl::Program normalProgram_;
  gl::Program edgeProgram_;
  gl::Target surface_;  // supersampled: normals and depth
};

}  // namespace limn
