// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/clip_contours.h"
#include "client/render/contour_coverage.h"
#include "client/render/drawing_method.h"

#include "shared/gl/handles.h"
#include "shared/gl/program.h"
#include "shared/gl/target.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace limn {

/// Silhouette clipping [Sander00]: a coarse outer hull, lit and painted (by the maps of normals
/// and of colours where the snapshot has them for this level, else by its own faces and in one
/// colour), cut to the outline of a finer mesh and antialiased there. The silhouettes are the
/// snapshot's exact contour if it has one, else the request's lines; they should be those of edges,
/// as the outline of a mesh is. Where the eye is not outside the hull's convex hull, or a
/// silhouette runs behind it, winding numbers say nothing: the mesh is drawn instead.
class ClipMethod final : public DrawingMethod {
 public:
  [[nodiscard]] static Result<std::unique_ptr<DrawingMethod>> create(DrawTools& tools);

  explicit ClipMethod(DrawTools& tools) : tools_(tools) {}

  [[nodiscard]] static Result<std::unique_ptr<ClipMethod>> make(DrawTools& tools);

  /// Errors: also kUnavailable when the snapshot has no outer hull.
  [[nodiscard]] Result<void>
  draw(const DrawRequest& request, const gl::Target& picture, FrameTimings& timings) override;

  /// What a model is drawn over.
  enum class Behind : std::uint8_t { kPaper, kPicture };

  /// The same without the mesh. False, and nothing drawn: winding numbers say nothing here.
  [[nodiscard]] Result<bool> drawClipped(
      const DrawRequest& request,
      Behind behind,
      const gl::Target& picture,
      FrameTimings& timings);

 private:
  Result<void> uploadHull(const DrawRequest& request);

  struct MapTexture {
    std::shared_ptr<const HullMap> map;  // what the texture holds
    gl::Texture texture;
  };

  Result<void> uploadMap(const std::shared_ptr<const HullMap>& map, int channels, MapTexture& there)
      const;
  [[nodiscard]] bool fits(const MapTexture& map) const;
  [[nodiscard]] Result<void> drawMesh(const DrawRequest& request, const gl::Target& picture);
  [[nodiscard]] Camera fitted(const Camera& camera) const;
  void setStencil(const ClipContours& contours) const;
  void drawPixels(GLsizei count) const;
  void drawHull(
      const DrawRequest& request,
      const glm::mat4& clipFromCenter,
      const gl::Target& picture) const;

  DrawTools& tools_;
  gl::Program stencilProgram_;
  gl::Program pixelProgram_;
  gl::Program hullProgram_;
  gl::Target fine_;    // the mesh, where the eye is inside
  gl::Target behind_;  // of partly covered pixels: what was in the picture
  gl::VertexArray contourArray_;
  gl::VertexArray pixelArray_;
  gl::VertexArray hullArray_;
  gl::VertexArray fringeArray_;
  gl::Buffer contourPoints_;
  gl::Buffer contourIndices_;
  gl::Buffer pixels_;
  gl::Buffer hullPoints_;
  gl::Buffer fringePoints_;
  ContourCoverage coverage_;
  MapTexture normals_;
  MapTexture colors_;

  // The hull that is there.
  std::shared_ptr<const ProgressiveHull> hull_;
  std::size_t hullSplits_ = 0;
  std::vector<glm::dvec3> hullModelPoints_;  // model units
  glm::dvec3 origin_{0.0};                   // of the hull's points on the GPU, grid units
  GLsizei hullCorners_ = 0;
  GLsizei fringeCorners_ = 0;
  GLint subpixelBits_ = 8;
};

}  // namespace limn
