// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/connection.h"
#include "client/net/asset_files.h"

#include <memory>

namespace limn {

/// A prepared asset played as the protocol's own messages: welcome, description, base mesh, level
/// blocks, seeds, then every split in level order. There is no server, so it chooses nothing by
/// view. Obeys the send window like a server.
[[nodiscard]] std::unique_ptr<Connection> makeAssetConnection(
    std::shared_ptr<const AssetFiles> files);

}  // namespace limn
