// SPDX-License-Identifier: Apache-2.0
#include "client/render/face_uniforms.h"

#include <cmath>

namespace limn {

void useFaceProgram(
    const gl::Program& program,
    const DrawRequest& request,
    const DrawTools& tools,
    const FaceTextures& faces) {
  const gl::Api& api = tools.api();
  const RenderOptions& options = request.options;
  const Camera& camera = request.camera;
  const ModelDescription& model = request.snapshot.model;
  const glm::dvec3 center = model.grid.toModel(tools.mesh().center());
  const glm::dvec3 forward = camera.forward();
  const glm::dvec3 eye = (camera.eye - center) / model.grid.step;
  const double reference = glm::distance(camera.eye, camera.target) / model.grid.step;
  const double nearest =
      glm::dot(model.sphere.center - model.sphere.radius * forward - camera.eye, forward);

  program.use();
  program.set("positions", 0);
  program.set("corners", 1);
  program.set("firstLayer", 2);
  program.set("normals", 3);
  gl::bindTexture(api, 0, faces.positions());
  gl::bindTexture(api, 1, faces.corners());
  gl::bindTexture(api, 2, faces.marks());
  if (faces.normals()) gl::bindTexture(api, 3, faces.normals());
  program.set(
      "clipFromCenter",
      tools.mesh().clipFromCenter(request.snapshot, camera, request.fineSize()));
  program.set("eye", glm::vec3(eye));
  program.set("forward", glm::vec3(forward));
  program.set("orthographic", camera.orthographic ? 1 : 0);
  program.set(
      "depthRange",
      glm::vec2(nearest / model.grid.step, 2.0 * model.sphere.radius / model.grid.step));
  program.set("pictureSize", glm::vec2(options.viewport.width, options.viewport.height));
  program.set(
      "width",
      glm::vec2(
          request.lineWidthPx(),
          options.widthModelUnits ? 1.0F : static_cast<float>(options.widthFalloff)));
  program.set("referenceDistance", static_cast<float>(reference));
  const double halfHeight = reference * std::tan(glm::radians(0.5 * camera.fovDegrees));
  program.set("pixelSize", static_cast<float>(2.0 * halfHeight / options.viewport.height));
  program.set("line", options.lineColor.value_or(request.style.style.visible.color));
  program.set("paper", request.paper);
  program.set("fading", static_cast<float>(options.lineFade));
}

}  // namespace limn
