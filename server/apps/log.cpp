// SPDX-License-Identifier: Apache-2.0
#include "server/apps/log.h"

#include <nlohmann/json.hpp>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace limn {
namespace {

using nlohmann::json;

LogFormat& format() {
  static LogFormat value = LogFormat::kText;
  return value;
}

std::string dump(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

void startLog(LogFormat wanted) {
  format() = wanted;
  spdlog::set_default_logger(spdlog::stderr_logger_mt("limn-server"));
  const char* pattern = wanted == LogFormat::kJson
                            ? R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l",%v})"
                            : "%Y-%m-%dT%H:%M:%S.%eZ %l %v";
  spdlog::set_pattern(pattern, spdlog::pattern_time_type::utc);
}

void logEvent(
    spdlog::level::level_enum level,
    const std::string& event,
    const std::string& message,
    const json& fields) {
  if (!spdlog::should_log(level)) return;
  if (format() == LogFormat::kJson) {
    std::string line = "\"event\":" + dump(event) + ",\"message\":" + dump(message);
    for (const auto& [name, value] : fields.items())
      line += "," + dump(name) + ":" + dump(value);
    spdlog::log(level, "{}", line);
    return;
  }
  std::string line = message;
  for (const auto& [name, value] : fields.items())
    line += " " + name + "=" + dump(value);
  spdlog::log(level, "{}", line);
}

void logEvent(
    spdlog::level::level_enum level,
    const std::string& event,
    const std::string& message) {
  logEvent(level, event, message, json::object());
}

}  // namespace limn
