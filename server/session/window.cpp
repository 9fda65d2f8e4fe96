// SPDX-License-Identifier: Apache-2.0
#include "server/session/window.h"

#include <algorithm>
#include <string>

namespace limn {

Result<void> Window::acknowledge(std::uint64_t totalBytes) {
  if (totalBytes > sentBytes_) {
    return fail(
        ErrorCode::kProtocol,
        "acknowledged " + std::to_string(totalBytes) + " bytes of " + std::to_string(sentBytes_) +
            " sent");
  }
  acknowledgedBytes_ = std::max(acknowledgedBytes_, totalBytes);
  return {};
}

}  // namespace limn
