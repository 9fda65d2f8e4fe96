// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace limn {

/// `limn-server inspect ASSET`: where an asset's bytes go and what they buy. argv[0] is "inspect".
/// Returns the exit status.
[[nodiscard]] int inspectCommand(int argc, char** argv);

}  // namespace limn
