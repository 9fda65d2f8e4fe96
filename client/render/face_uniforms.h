// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/drawing_method.h"
#include "client/render/face_textures.h"

#include "shared/gl/program.h"

namespace limn {

/// Puts a program of shaders::kFaceCommon in use: binds the mesh's textures to units 0 to 3, sets
/// camera, colours, widths and distances. What only some programs have stays to be set.
void useFaceProgram(
    const gl::Program& program,
    const DrawRequest& request,
    const DrawTools& tools,
    const FaceTextures& faces);

}  // namespace limn
