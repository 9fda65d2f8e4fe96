// SPDX-License-Identifier: Apache-2.0
#include "server/apps/service_manager.h"

#include <systemd/sd-daemon.h>

namespace limn {

ServiceManager::ServiceManager() {
  std::uint64_t watchdogUs = 0;
  if (sd_watchdog_enabled(0, &watchdogUs) > 0) {
    intervalMs_ = static_cast<std::int64_t>(watchdogUs / 2000);
  }
}

void ServiceManager::ready(const std::string& status) {
  sd_notify(0, ("READY=1\nSTATUS=" + status).c_str());
}

void ServiceManager::tick(std::int64_t nowMs) {
  if (intervalMs_ == 0 || nowMs < nextMs_) return;
  nextMs_ = nowMs + intervalMs_;
  sd_notify(0, "WATCHDOG=1");
}

}  // namespace limn
