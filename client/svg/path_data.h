// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/svg/curve_fit.h"

#include <string>

namespace limn {

/// A path as the `d` attribute of SVG: hundredths of a pixel, relative, as short as the grammar
/// allows. Steps are rounded where they end, so that rounding never adds up.
[[nodiscard]] std::string pathData(const FittedPath& path, PathEnds ends);

}  // namespace limn
