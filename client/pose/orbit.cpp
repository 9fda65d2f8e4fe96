// SPDX-License-Identifier: Apache-2.0
#include "client/pose/orbit.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string>

namespace limn {
namespace {

tl::unexpected<Error> bad(std::string_view text, const char* why) {
  return fail(
      ErrorCode::kInvalidArgument,
      "camera \"" + std::string(text) + "\" " + why +
          ": write orbit:AZIMUTH,ELEVATION[,DISTANCE], for instance orbit:30,20,3");
}

}  // namespace

Result<Orbit> parseOrbit(std::string_view text) {
  constexpr std::string_view kPrefix = "orbit:";
  if (!text.starts_with(kPrefix)) return bad(text, "does not start with orbit:");
  std::array<double, 3> values{0.0, 0.0, Orbit{}.distanceRadii};
  std::size_t count = 0;
  std::string_view rest = text.substr(kPrefix.size());
  while (true) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const std::string_view part = rest.substr(0, comma);
    if (count == values.size()) return bad(text, "has more than three numbers");
    const auto [end, error] =
        std::from_chars(part.data(), part.data() + part.size(), values[count]);
    if (error != std::errc{} || end != part.data() + part.size() || !std::isfinite(values[count])) {
      return bad(text, "has something that is no number");
    }
    ++count;
    if (comma == rest.size()) break;
    rest.remove_prefix(comma + 1);
  }
  if (count < 2) return bad(text, "lacks the elevation");
  if (std::abs(values[1]) > 90.0) return bad(text, "has an elevation beyond 90 degrees");
  if (!(values[2] > 0.0) || values[2] > 1e6) return bad(text, "has a distance that is not above 0");
  return Orbit{values[0], values[1], values[2]};
}

}  // namespace limn
