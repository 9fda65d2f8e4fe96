// SPDX-License-Identifier: Apache-2.0
#include "client/apps/watch_session.h"

#include "client/apps/session_options.h"

namespace limn {

Result<SessionOutcome> loadWhole(const Source& source) {
  ClientSession::Options options = sessionOptionsOf(source);
  options.session.stop.state = MeshState::kComplete;
  ClientSession session(source.connect, options);
  ProgressLine progress;
  return watchSession(session, progress, [&](std::uint64_t ms) {
    return session.waitUntilDone(ms);
  });
}

}  // namespace limn
