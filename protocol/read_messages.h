// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol/messages.h"

#include "shared/core/result.h"

/// The inner half of decodeMessage(): fields of buffers that FlatBuffers' verifier has passed, each
/// held to its limits (limits.h, limn.fbs). Errors: kProtocol, kLimitExceeded.
namespace limn::protocol {

/// What a client may send; anything else is an error.
[[nodiscard]] Result<Body> readClientMessage(const wire::Message& message);

/// What a server may send; anything else is an error.
[[nodiscard]] Result<Body> readServerMessage(const wire::Message& message);

}  // namespace limn::protocol
