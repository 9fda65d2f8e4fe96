// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/inspect/byte_account.h"
#include "server/inspect/rate_distortion.h"
#include "server/session/model.h"

#include <string>

namespace limn {

/// A table for a terminal: sections, then levels with the bits a split spends on each kind of
/// symbol.
[[nodiscard]] std::string byteTable(const Model& model, const ByteAccount& account);

/// A table of bytes and errors.
[[nodiscard]] std::string rateTable(const RateDistortion& rates);

/// Everything as one JSON object; rates: null when it was not measured.
[[nodiscard]] std::string
inspectJson(const Model& model, const ByteAccount& account, const RateDistortion* rates);

/// Contour error and surface error against bytes, an SVG document.
[[nodiscard]] std::string ratePlot(const Model& model, const RateDistortion& rates);

}  // namespace limn
