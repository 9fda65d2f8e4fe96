// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace limn {

/// `limn-server token`: prints a token that a server with that key file takes, or a new key.
/// argv[0] is "token". Returns the exit status.
[[nodiscard]] int tokenCommand(int argc, char** argv);

}  // namespace limn
