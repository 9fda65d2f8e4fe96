// SPDX-License-Identifier: Apache-2.0
#include "client/apps/frame_path.h"

#include <cstddef>
#include <optional>

namespace limn {
namespace {

struct NumberPlace {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t digits = 0;
};

/// Finds `%d` or `%0Nd`; the pattern comes from the command line, so it never reaches printf.
std::optional<NumberPlace> findNumber(const std::string& pattern) {
  for (std::size_t i = pattern.find('%'); i != std::string::npos; i = pattern.find('%', i + 1)) {
    if (i + 1 < pattern.size() && pattern[i + 1] == 'd') return NumberPlace{i, i + 2, 0};
    if (i + 3 < pattern.size() && pattern[i + 1] == '0' && pattern[i + 2] >= '1' &&
        pattern[i + 2] <= '9' && pattern[i + 3] == 'd') {
      return NumberPlace{i, i + 4, static_cast<std::size_t>(pattern[i + 2] - '0')};
    }
  }
  return std::nullopt;
}

}  // namespace

bool hasFrameNumber(const std::string& pattern) {
  return findNumber(pattern).has_value();
}

std::string framePath(const std::string& pattern, std::uint32_t index) {
  const auto place = findNumber(pattern);
  if (!place) return pattern;
  std::string number = std::to_string(index);
  if (number.size() < place->digits) number.insert(0, place->digits - number.size(), '0');
  return pattern.substr(0, place->begin) + number + pattern.substr(place->end);
}

}  // namespace limn
