// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/line_finder.h"
#include "client/apps/render_options.h"
#include "client/render/renderer.h"

#include "protocol/messages.h"

namespace limn {

/// The silhouettes that these flags draw, as a pose asks for them.
[[nodiscard]] protocol::Silhouette wantedSilhouette(const RenderCommandOptions& options);
/// How lines are found and drawn, of all that the flags say.
[[nodiscard]] LineFinderOptions lineOptionsOf(const RenderCommandOptions& options);
[[nodiscard]] RenderOptions renderOptionsOf(const RenderCommandOptions& options);

}  // namespace limn
