// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/camera.h"
#include "shared/core/result.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace limn {

/// A camera as parseCamera() reads it, on one line.
[[nodiscard]] std::string cameraFileJson(const Camera& camera);
/// A camera as `--camera-file` has it: {"eye":[3],"target":[3],"up":[3],"fov":deg,"ortho":bool};
/// model units; up defaults to [0,1,0], fov to 40, ortho to false. Near and far are not set: fit
/// them to the model. Errors: kInvalidArgument (names the field), kNotFound, kIo.
[[nodiscard]] Result<Camera> parseCamera(std::string_view json);
[[nodiscard]] Result<Camera> readCameraFile(const std::filesystem::path& path);

}  // namespace limn
