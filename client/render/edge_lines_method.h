// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/drawing_method.h"
#include "client/render/face_pattern.h"
#include "client/render/face_textures.h"

#include "shared/gl/program.h"

#include <memory>

namespace limn {

/// Silhouette edges with respect to the eye or to a light, found on the GPU from adjacency: by a
/// geometry shader over triangles with adjacency [OGLdev39], or, where GL has none or
/// kConditionalLines asks for it, by a vertex shader over all edges. Borders are lines, too.
/// A light's silhouettes are drawn on the mesh, lit by it.
class EdgeLinesMethod final : public DrawingMethod {
 public:
  /// mode: kGeometryShader or kConditionalLines. Errors: kUnavailable.
  [[nodiscard]] static Result<std::unique_ptr<DrawingMethod>> create(
      DrawMode mode,
      DrawTools& tools);

  [[nodiscard]] Result<void>
  draw(const DrawRequest& request, const gl::Target& picture, FrameTimings& timings) override;

  [[nodiscard]] bool usesGeometryShader() const { return usesGeometryShader_; }

 private:
  explicit EdgeLinesMethod(DrawTools& tools) : tools_(tools) {}

  /// Errors: kUnavailable: this GL has no geometry shaders.
  [[nodiscard]] Result<void> compileGeometryShader();
  [[nodiscard]] Result<void> compileConditionalLines();
  [[nodiscard]] Result<void> upload(const MeshSnapshot& snapshot);
  void drawLines(const DrawRequest& request, const gl::Texture& depth) const;

  DrawTools& tools_;
  bool usesGeometryShader_ = false;
  gl::Program program_;
  FaceTextures faces_;
  FacePattern quads_;          // conditional lines
  gl::Texture edges_;          // the same: four indices an edge
  gl::VertexArray triangles_;  // the geometry shader's
  gl::Buffer adjacency_;
  int count_ = 0;    // of edges, or of indices of triangles with adjacency
  gl::Target fine_;  // supersampled, colour and depth
};

}  // namespace limn
