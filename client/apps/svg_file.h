// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/render_options.h"
#include "client/core/snapshot.h"
#include "client/stroke/chain/polyline.h"
#include "client/stroke/visibility/resolved_visibility.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"

#include <string>

namespace limn {

/// `--svg`: the lines as a vector drawing in the style asked for, whose dashes are those of its
/// textures. resolver: of the snapshot's mesh. Errors: as readStyle().
[[nodiscard]] Result<std::string> svgFile(
    const RenderCommandOptions& options,
    const std::string& modelName,
    const MeshSnapshot& snapshot,
    const PolylineSet& lines,
    const VisibilityResolver& resolver,
    const Camera& camera);

}  // namespace limn
