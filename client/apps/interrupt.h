// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace limn {

/// From now on SIGINT and SIGTERM only set what interrupted() reports, so that temporary files are
/// removed on the way out; a third one ends the program at once.
void watchForInterrupts();
[[nodiscard]] bool interrupted();

}  // namespace limn
