// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/render_options.h"
#include "client/core/pose_reporter.h"
#include "client/pose/orbit_path.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"

namespace limn {

/// One camera a frame, as the flags ask for, about what is in `sphere`. Errors: of files.
[[nodiscard]] Result<CameraPath> camerasOf(
    const RenderCommandOptions& options,
    const BoundingSphere& sphere);

/// What a session is told of a camera.
[[nodiscard]] ClientView
viewOf(const RenderCommandOptions& options, const StopCondition& until, const Camera& camera);

}  // namespace limn
