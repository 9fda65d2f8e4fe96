// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/drawing_method.h"
#include "client/render/face_pattern.h"
#include "client/render/face_textures.h"

#include "shared/gl/program.h"

#include <memory>
#include <vector>

namespace limn {

/// Image-precision silhouettes [Raskar99]: the first layer in the paper's colour and its depth,
/// then back faces, changed so that they show around it. No adjacency, no detector. `mode` picks
/// one of the six ways to change them.
class BackFacesMethod final : public DrawingMethod {
 public:
  /// mode: one of DrawMode::kBack…. Errors: kUnavailable.
  [[nodiscard]] static Result<std::unique_ptr<DrawingMethod>> create(
      DrawMode mode,
      DrawTools& tools);

  [[nodiscard]] Result<void>
  draw(const DrawRequest& request, const gl::Target& picture, FrameTimings& timings) override;

 private:
  BackFacesMethod(DrawMode mode, DrawTools& tools) : tools_(tools), mode_(mode) {}

  [[nodiscard]] Result<void> compile();
  /// Depth of what is nearest everywhere, and paper for colour.
  [[nodiscard]] Result<void> drawFirstLayer(const DrawRequest& request);
  /// The same where windings tell nothing: numbers of the nearest faces are read back, those faces
  /// marked. Leaves depth as it is.
  void findFirstLayer(const DrawRequest& request);
  void drawGreyFront(const DrawRequest& request) const;
  void drawBackFaces(const DrawRequest& request) const;
  /// Puts `program` in use, with the uniforms that all face programs share.
  void use(const gl::Program& program, const DrawRequest& request) const;
  void drawFaces() const;

  DrawTools& tools_;
  DrawMode mode_;
  FaceTextures faces_;
  gl::Program program_;
  gl::Program numberProgram_;
  gl::Program greyProgram_;  // charcoal's front
  gl::VertexArray noAttributes_;
  FacePattern pattern_;  // edges or faces
  gl::Target fine_;      // supersampled, colour and depth
  bool usesMarks_ = false;
  std::vector<std::uint8_t> pixels_;  // read back
};

}  // namespace limn
