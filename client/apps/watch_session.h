// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/interrupt.h"
#include "client/apps/progress_line.h"
#include "client/apps/source.h"
#include "client/core/client_session.h"

#include "shared/core/result.h"

#include <cstdint>

namespace limn {

/// Waits in slices, so that an interrupt is noticed and progress is shown.
template <class Wait>
auto watchSession(ClientSession& session, ProgressLine& progress, Wait wait) -> decltype(wait(0)) {
  constexpr std::uint64_t kSliceMs = 200;
  while (true) {
    auto result = wait(kSliceMs);
    const bool running = session.isRunning();
    if (!result && !running) result = wait(0);  // it may have ended between the two
    if (result || result.error().code != ErrorCode::kUnavailable || !running) {
      progress.clear();
      return result;
    }
    if (interrupted()) {
      progress.clear();
      return fail(ErrorCode::kCancelled, "stopped on request");
    }
    progress.show(session.progress());
  }
}

/// Streams a whole model from the beginning to its end. Errors: the session's.
[[nodiscard]] Result<SessionOutcome> loadWhole(const Source& source);

}  // namespace limn
