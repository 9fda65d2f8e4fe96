// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/line_finder.h"
#include "client/apps/render_options.h"
#include "client/render/renderer.h"

namespace limn {

/// How lines are found and drawn, of all that the flags say.
[[nodiscard]] LineFinderOptions lineOptionsOf(const RenderCommandOptions& options);
[[nodiscard]] RenderOptions renderOptionsOf(const RenderCommandOptions& options);

}  // namespace limn
