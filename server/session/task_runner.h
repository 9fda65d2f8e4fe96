// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace limn {

/// How soon work is wanted; most urgent first.
enum class TaskUrgency : std::uint8_t {
  kMotion,  // a moving camera passes what this is for; many clients share it
  kView,    // somebody waits for it who looks from one place
  kSearch,  // long, and somebody has something to look at meanwhile
};

inline constexpr std::size_t kTaskUrgencies = 3;

/// Runs work off the loop thread. `work` runs on a worker; afterwards `done` runs on the loop
/// thread. Called on the loop thread only. Work in the queue when the runner ends is dropped.
class TaskRunner {
 public:
  virtual ~TaskRunner() = default;
  virtual void
  submit(TaskUrgency urgency, std::function<void()> work, std::function<void()> done) = 0;
  /// Work submitted and not yet done.
  [[nodiscard]] virtual std::size_t pending() const = 0;
};

}  // namespace limn
