// SPDX-License-Identifier: Apache-2.0
#include "client/render/gl_context.h"

#include "client/render/egl_context.h"

#include "shared/gl/osmesa_context.h"

#include <string>

namespace limn {

Result<GlBackend> parseGlBackend(std::string_view name) {
  if (name == "egl") return GlBackend::kEgl;
  if (name == "osmesa") return GlBackend::kOsmesa;
  return fail(
      ErrorCode::kInvalidArgument,
      "there is no GL backend '" + std::string(name) + "': use egl or osmesa");
}

Result<std::unique_ptr<GlContext>> createGlContext(GlBackend backend) {
  return backend == GlBackend::kEgl ? createEglContext() : createOsmesaContext();
}

}  // namespace limn
