// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/render_options.h"
#include "client/apps/source.h"
#include "client/core/client_session.h"

#include <cstdint>

namespace limn {

/// What every session of a source begins with. It publishes finished states alone (none on the way
/// is worth a copy to who waits) and stops at `settled`. memoryMib: for the mesh; 0: no limit.
[[nodiscard]] ClientSession::Options sessionOptionsOf(
    const Source& source,
    std::uint64_t memoryMib = 0);

/// A session that brings what the flags of `render` draw and write, and stops as they say: files
/// are read whole, since there is nobody to settle a view of them, and the server's contours need
/// no more of the mesh than its base.
[[nodiscard]] ClientSession::Options sessionOptionsOf(
    const Source& source,
    const RenderCommandOptions& options);

}  // namespace limn
