// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace limn {

/// What a preparation may take; a hostile file gets no more. 0: no limit.
struct PrepareLimits {
  std::uint64_t memoryBytes = std::uint64_t{8} << 30;  // address space
  std::uint64_t cpuSeconds = 3600;                     // of all its threads together
};

/// One run of limn-prepare as a child process, in its own address space so that no input can hurt
/// the server. Polled; never blocks. Destroyed while it runs: killed and waited for.
class PrepareProcess {
 public:
  struct Outcome {
    bool succeeded = false;
    std::string report;  // its standard output: one JSON object
    std::string reason;  // the last line it wrote on standard error, when it failed
  };

  /// arguments: the program's path first. Errors: kIo.
  [[nodiscard]] static Result<PrepareProcess> start(
      const std::vector<std::string>& arguments,
      const PrepareLimits& limits = {0, 0});
  PrepareProcess(PrepareProcess&& other) noexcept;
  PrepareProcess& operator=(PrepareProcess&& other) noexcept;
  PrepareProcess(const PrepareProcess&) = delete;
  PrepareProcess& operator=(const PrepareProcess&) = delete;
  ~PrepareProcess();

  /// Reads what it wrote; the outcome once it has ended.
  [[nodiscard]] std::optional<Outcome> poll();

  /// 0 to 1, as far as it said.
  [[nodiscard]] double progress() const { return progress_; }

  /// Asks it to end.
  void stop();

 private:
  PrepareProcess() = default;
  void readErrors();

  int pid_ = -1;
  int out_ = -1;
  int err_ = -1;
  std::string output_;
  std::string line_;      // of standard error, so far
  std::string lastLine_;  // that was no progress
  double progress_ = 0.0;
};

}  // namespace limn
