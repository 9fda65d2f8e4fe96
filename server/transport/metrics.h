// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/catalogue.h"
#include "server/transport/http_routes.h"

#include <string>
#include <vector>

namespace limn {

/// Prometheus text of what is known: base units, no labels per client.
[[nodiscard]] std::string metricsText(
    const ServerStatus& status,
    const std::vector<CatalogueItem>& items);

}  // namespace limn
