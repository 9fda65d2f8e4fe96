// SPDX-License-Identifier: Apache-2.0
// Based on: T. Saito and T. Takahashi, "Comprehensible Rendering of 3-D Shapes", SIGGRAPH 1990
// (discontinuities of depth). A. Hertzmann, "Introduction to 3D Non-Photorealistic Rendering:
// Silhouettes and Outlines", SIGGRAPH 1999 course notes (those of a map of normals, too).
// Deviations: pairs of pixels as far apart as the line is wide instead of Sobel's operator, so that
// lines have a width without a second pass; normals are those of faces.
#include "client/render/image_edges_method.h"

#include "client/render/shaders/image_edge_shaders.h"
#include "client/render/shaders/shaders.h"

#include <cmath>
#include <utility>

namespace limn {
namespace {

/// Second difference of depth that is a step: pixels' worth a pixel of reach.
constexpr float kJump = 6.0F;
/// Cosines of the normals' difference for full ink and for none.
constexpr glm::vec2 kCreases(0.62F, 0.72F);

}  // namespace

Result<std::unique_ptr<DrawingMethod>> ImageEdgesMethod::create(DrawTools& tools) {
  std::unique_ptr<ImageEdgesMethod> method(new ImageEdgesMethod(tools));
  auto normal = gl::Program::build(
      tools.api(),
      "face normals",
      shaders::kMeshVertex,
      shaders::kFaceNormalFragment);
  if (!normal) return tl::unexpected(normal.error());
  auto edge = gl::Program::build(
      tools.api(),
      "image edges",
      shaders::kScreenVertex,
      shaders::kImageEdgeFragment);
  if (!edge) return tl::unexpected(edge.error());
  method->normalProgram_ = *std::move(normal);
  method->edgeProgram_ = *std::move(edge);
  return method;
}

Result<void>
ImageEdgesMethod::draw(const DrawRequest& request, const gl::Target& picture, FrameTimings&) {
  const gl::Api& api = tools_.api();
  const gl::Target::Options options{.size = request.fineSize(), .hasDepth = true};
  if (auto ok = tools_.fit(surface_, "the picture of normals", options); !ok) return ok;
  surface_.bind();
  api.clearColor(0.0F, 0.0F, 0.0F, 0.0F);
  api.clearDepthf(1.0F);
  api.clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  normalProgram_.use();
  tools_.mesh().draw(request.snapshot, request.camera, surface_, normalProgram_);
  findEdges(request, picture);
  return {};
}

void ImageEdgesMethod::findEdges(const DrawRequest& request, const gl::Target& picture) const {
  const gl::Api& api = tools_.api();
  const RenderOptions& options = request.options;
  const Camera& camera = request.camera;
  const BoundingSphere& sphere = request.snapshot.model.sphere;
  const double reference = glm::distance(camera.eye, camera.target);
  const double height = 2.0 * reference * std::tan(glm::radians(0.5 * camera.fovDegrees));
  const double nearest = glm::dot(sphere.center - camera.eye, camera.forward()) - sphere.radius;
  picture.bind();
  edgeProgram_.use();
  edgeProgram_.set("depthMap", 0);
  edgeProgram_.set("normalMap", 1);
  gl::bindTexture(api, 0, surface_.depth());
  gl::bindTexture(api, 1, surface_.color());
  edgeProgram_.set("supersample", request.supersample);
  edgeProgram_.set(
      "width",
      glm::vec2(
          request.lineWidthPx(),
          options.widthModelUnits ? 1.0F : static_cast<float>(options.widthFalloff)));
  edgeProgram_.set("referenceDistance", static_cast<float>(reference));
  edgeProgram_.set("planes", glm::vec2(camera.nearPlane, camera.farPlane));
  edgeProgram_.set("orthographic", camera.orthographic ? 1 : 0);
  edgeProgram_.set("pixelSize", static_cast<float>(height / request.fineSize().height));
  edgeProgram_.set("jump", kJump);
  edgeProgram_.set("creases", kCreases);
  edgeProgram_.set("depthRange", glm::vec2(nearest, 2.0 * sphere.radius));
  edgeProgram_.set("fading", static_cast<float>(options.lineFade));
  edgeProgram_.set("line", options.lineColor.value_or(request.style.style.visible.color));
  edgeProgram_.set("paper", request.paper);
  tools_.drawScreen();
}

}  // namespace limn
