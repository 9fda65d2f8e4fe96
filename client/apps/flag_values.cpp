// SPDX-License-Identifier: Apache-2.0
#include "client/apps/flag_values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr int kMaxSize = 8192;

template <class Number>
std::optional<Number> parseNumber(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// X,Y,Z.
std::optional<glm::dvec3> parsePlace(const std::string& text) {
  std::istringstream list(text);
  std::string item;
  std::vector<double> numbers;
  while (std::getline(list, item, ',')) {
    const auto number = parseNumber<double>(item);
    if (!number || !std::isfinite(*number)) break;
    numbers.push_back(*number);
  }
  if (numbers.size() != 3 || !list.eof() || text.back() == ',') return std::nullopt;
  return glm::dvec3(numbers[0], numbers[1], numbers[2]);
}

}  // namespace

tl::unexpected<Error> wrong(const std::string& message) {
  return fail(ErrorCode::kInvalidArgument, message);
}

std::string detectorNames() {
  std::string names;
  for (const DetectorMethod method : allDetectors())
    names += (names.empty() ? "" : ",") + std::string(detectorName(method));
  return names;
}

Result<StopCondition> parseUntil(const std::string& text) {
  StopCondition until;
  for (const MeshState state :
       {MeshState::kBase, MeshState::kSettled, MeshState::kExact, MeshState::kComplete}) {
    if (text != nameOf(state)) continue;
    until.state = state;
    return until;
  }
  const std::string_view view = text;
  if (view.starts_with("bytes:")) {
    if (const auto bytes = parseNumber<std::uint64_t>(view.substr(6)); bytes && *bytes > 0) {
      until.kind = StopCondition::Kind::kBytes;
      until.bytes = *bytes;
      return until;
    }
  } else if (view.starts_with("seconds:")) {
    const auto seconds = parseNumber<double>(view.substr(8));
    if (seconds && *seconds > 0.0 && *seconds <= 1e6) {
      until.kind = StopCondition::Kind::kSeconds;
      until.seconds = *seconds;
      return until;
    }
  }
  return wrong(
      "--until " + text +
      " is unknown: write base, settled, exact, complete, bytes:N or seconds:S");
}

Result<Viewport> parseSize(const std::string& text) {
  const std::size_t x = std::min(text.find('x'), text.size());
  const auto width = parseNumber<int>(std::string_view(text).substr(0, x));
  const auto height =
      x < text.size() ? parseNumber<int>(std::string_view(text).substr(x + 1)) : std::nullopt;
  if (!width || !height || *width < 1 || *height < 1 || *width > kMaxSize || *height > kMaxSize) {
    return wrong("--size " + text + " is no size: write WIDTHxHEIGHT in pixels, each 1 to 8192");
  }
  return Viewport{*width, *height};
}

Result<SilhouetteKind> parseSilhouette(const std::string& text) {
  if (text == "smooth") return SilhouetteKind::kSmooth;
  if (text == "edges") return SilhouetteKind::kEdges;
  return wrong("--silhouette " + text + " is unknown: write smooth or edges");
}

Result<glm::dvec3> parseLight(const std::string& text) {
  if (const auto place = parsePlace(text)) return *place;
  return wrong("--light " + text + " is no place: write X,Y,Z in the model's coordinates");
}

Result<RenderCommandOptions::With> parseWith(const std::string& text) {
  RenderCommandOptions::With with{text, std::nullopt};
  const std::size_t at = text.rfind('@');
  if (at != std::string::npos && at + 1 < text.size()) {
    with.place = parsePlace(text.substr(at + 1));
    if (with.place) with.model = text.substr(0, at);
  }
  if (with.model.empty() || (at != std::string::npos && !with.place)) {
    return wrong("--with " + text + " is no model and place: write MODEL or MODEL@X,Y,Z");
  }
  return with;
}

Result<FeatureChoice> parseFeatures(const std::string& text) {
  FeatureChoice choice{false, false, false, {}};
  if (text == "none") return choice;
  const std::array<std::pair<const char*, bool*>, 7> names = {{
      {"crease", &choice.crease},
      {"border", &choice.border},
      {"seam", &choice.seam},
      {"suggestive", &choice.surface.suggestive},
      {"ridge", &choice.surface.ridge},
      {"valley", &choice.surface.valley},
      {"intersection", &choice.surface.intersection},
  }};
  std::istringstream list(text);
  std::string item;
  bool isKnown = false;
  while (std::getline(list, item, ',')) {
    isKnown = false;
    for (const auto& [name, flag] : names) {
      if (item != name) continue;
      *flag = true;
      isKnown = true;
    }
    if (!isKnown) break;
  }
  if (!isKnown) {
    return wrong(
        "--features " + text +
        " is unknown: write some of crease,border,seam,suggestive,ridge,valley,intersection, or "
        "none");
  }
  return choice;
}

}  // namespace limn
