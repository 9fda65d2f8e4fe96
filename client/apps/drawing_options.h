// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/line_finder.h"
#include "client/apps/render_options.h"
#include "client/core/snapshot.h"
#include "client/render/renderer.h"

#include "protocol/messages.h"

#include "shared/core/result.h"

namespace limn {

/// The silhouettes that these flags draw, as a pose asks for them.
[[nodiscard]] protocol::Silhouette wantedSilhouette(const RenderCommandOptions& options);
/// How lines are found and drawn, of all that the flags say.
[[nodiscard]] LineFinderOptions lineOptionsOf(const RenderCommandOptions& options);
[[nodiscard]] RenderOptions renderOptionsOf(const RenderCommandOptions& options);
/// Says on stderr that a model without a hull is drawn whole where it was to be clipped.
void noteMissingHull(const ModelDescription& model, const RenderCommandOptions& options);
/// Errors: kUnavailable (a model is to be clipped that has a hull, which has not come).
[[nodiscard]] Result<void> checkHull(
    const MeshSnapshot& snapshot,
    const RenderCommandOptions& options);

}  // namespace limn
