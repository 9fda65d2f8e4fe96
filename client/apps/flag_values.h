// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/render_options.h"
#include "client/core/session_state.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"

#include <glm/glm.hpp>

#include <string>

/// Values of flags, from their text. Errors: kInvalidArgument, in one line that says what to write
/// instead.
namespace limn {

/// A flag that cannot be followed.
[[nodiscard]] tl::unexpected<Error> wrong(const std::string& message);

/// Of every detector, between commas: what may be written.
[[nodiscard]] std::string detectorNames();
/// Parses `base|settled|exact|complete|bytes:N|seconds:S`.
[[nodiscard]] Result<StopCondition> parseUntil(const std::string& text);
/// Parses `WIDTHxHEIGHT`, 1 to 8192 each.
[[nodiscard]] Result<Viewport> parseSize(const std::string& text);
/// Parses `smooth|edges`.
[[nodiscard]] Result<SilhouetteKind> parseSilhouette(const std::string& text);
/// Parses `X,Y,Z`.
[[nodiscard]] Result<glm::dvec3> parseLight(const std::string& text);
/// Parses `MODEL[@X,Y,Z]`.
[[nodiscard]] Result<RenderCommandOptions::With> parseWith(const std::string& text);
/// Parses any choice of `crease,border,seam,suggestive,ridge,valley,intersection`, or `none`.
[[nodiscard]] Result<FeatureChoice> parseFeatures(const std::string& text);

}  // namespace limn
