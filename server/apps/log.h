// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <spdlog/common.h>

#include <string>

namespace limn {

enum class LogFormat { kText, kJson };

/// Sends the log to standard error: lines for people, or a JSON object a line with time, level,
/// event, message and the event's fields.
void startLog(LogFormat format);

/// event: a word for machines. fields: an object; `connection` and `job` are the numbers by which
/// all lines about one are found. Threads: any.
void logEvent(
    spdlog::level::level_enum level,
    const std::string& event,
    const std::string& message,
    const nlohmann::json& fields);
void logEvent(
    spdlog::level::level_enum level,
    const std::string& event,
    const std::string& message);

}  // namespace limn
