// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <ctime>
#include <utility>
#include <vector>

/// What the benches measure with, and from where they look.
namespace limn {

/// Milliseconds of a clock of clock_gettime().
[[nodiscard]] inline double clockMs(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Processor time of this thread, and of all threads of this process, in milliseconds since some
/// moment: what else runs on the machine counts less.
[[nodiscard]] inline double threadCpuMs() {
  return clockMs(CLOCK_THREAD_CPUTIME_ID);
}

[[nodiscard]] inline double processCpuMs() {
  return clockMs(CLOCK_PROCESS_CPUTIME_ID);
}

/// The upper one of two in the middle. values: not empty.
[[nodiscard]] inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Azimuths and elevations in degrees of six views from all around, off a model's axes but for one.
inline constexpr std::array<std::pair<double, double>, 6> kSixViews = {
    {{30.0, 20.0}, {150.0, -10.0}, {260.0, 50.0}, {75.0, 0.0}, {200.0, 35.0}, {330.0, -40.0}}};

}  // namespace limn
