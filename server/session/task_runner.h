// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace limn {

/// Runs work off the loop thread. `work` runs on a worker; afterwards `done` runs on the loop
/// thread. Called on the loop thread only. Work in the queue when the runner ends is dropped.
class TaskRunner {
 public:
  virtual ~TaskRunner() = default;
  virtual void submit(std::function<void()> work, std::function<void()> done) = 0;
  /// Work submitted and not yet done.
  [[nodiscard]] virtual std::size_t pending() const = 0;
};

}  // namespace limn
