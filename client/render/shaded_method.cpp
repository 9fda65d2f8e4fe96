// SPDX-License-Identifier: Apache-2.0
#include "client/render/shaded_method.h"

namespace limn {

Result<std::unique_ptr<DrawingMethod>> ShadedMethod::create(DrawTools& tools) {
  return std::unique_ptr<DrawingMethod>(new ShadedMethod(tools));
}

Result<void>
ShadedMethod::draw(const DrawRequest& request, const gl::Target& picture, FrameTimings&) {
  const MeshPass::Shading shading{.background = request.paper, .light = request.options.light};
  if (request.supersample == 1) {
    tools_.mesh().drawShaded(request.snapshot, request.camera, picture, shading);
    return {};
  }
  const gl::Target::Options options{.size = request.fineSize(), .hasDepth = true};
  if (auto ok = tools_.fit(fine_, "the supersampled picture", options); !ok) return ok;
  tools_.mesh().drawShaded(request.snapshot, request.camera, fine_, shading);
  tools_.reduce(fine_.color(), request.supersample, picture);
  return {};
}

}  // namespace limn
