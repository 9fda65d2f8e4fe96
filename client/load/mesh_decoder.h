// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/load/light_client.h"

#include <memory>

namespace limn::load {

/// Decodes as a drawing client does, into a mesh, through client/core's StreamDecoder. Memory: the
/// mesh as far as it was received.
[[nodiscard]] std::unique_ptr<PayloadDecoder> makeMeshDecoder();

}  // namespace limn::load
