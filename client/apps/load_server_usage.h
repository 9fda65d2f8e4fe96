// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/load/report.h"

#include <sys/types.h>

#include <optional>

namespace limn::load {

/// The process that listens on a TCP port of this machine, if the user may see it.
[[nodiscard]] std::optional<pid_t> findListener(int port);

/// Watches a process through /proc.
class ServerWatch {
 public:
  /// Takes the first sample: before the load. nullopt when there is no such process.
  [[nodiscard]] static std::optional<ServerWatch> start(pid_t pid);

  /// Call a few times a second. False once the process is gone.
  bool sample();

  [[nodiscard]] const ServerUsage& usage() const { return usage_; }

 private:
  explicit ServerWatch(pid_t pid) : pid_(pid) {}

  [[nodiscard]] std::optional<double> rssMib() const;
  [[nodiscard]] std::optional<double> cpuSeconds() const;

  pid_t pid_;
  double cpuBefore_ = 0.0;
  ServerUsage usage_;
};

}  // namespace limn::load
