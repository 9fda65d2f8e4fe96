// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <cstdint>
#include <string_view>

namespace limn::protocol {

/// Whether a Sec-WebSocket-Protocol header ("limn.1, other") offers the subprotocol `limn.1`.
[[nodiscard]] bool offersSubprotocol(std::string_view header);

/// The version that both sides will speak: the lower of the client's highest and ours.
/// Errors: kProtocol (the client speaks none that we do); answer Error kVersion and close.
[[nodiscard]] Result<std::uint16_t> negotiateVersion(std::uint16_t clientHighest);

/// Checks what a Welcome says. Errors: kProtocol (a version we did not offer).
[[nodiscard]] Result<void> checkWelcome(std::uint16_t serverVersion);

}  // namespace limn::protocol
