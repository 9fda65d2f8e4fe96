// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/client_session.h"

#include <string>

namespace limn {

/// Tells on stderr how far a session is: a bar that redraws itself on a terminal, otherwise a plain
/// line whenever there is news worth one. Threads: one at a time.
class ProgressLine {
 public:
  ProgressLine();
  void show(const ClientSession::Progress& progress);
  /// Removes the bar, so that the next line begins at the margin.
  void clear();

 private:
  bool terminal_;
  bool drawn_ = false;
  std::string notice_;
};

}  // namespace limn
