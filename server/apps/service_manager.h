// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace limn {

/// Tells the service manager that started this process how it is (systemd's Type=notify and
/// WatchdogSec=). Without one, all of it does nothing. Loop thread only.
class ServiceManager {
 public:
  ServiceManager();

  /// The server accepts connections. status: a line for `systemctl status`.
  void ready(const std::string& status);
  /// Call often: says that the loop is alive, twice a watchdog interval.
  void tick(std::int64_t nowMs);

 private:
  std::int64_t intervalMs_ = 0;  // 0: nobody watches
  std::int64_t nextMs_ = 0;
};

}  // namespace limn
