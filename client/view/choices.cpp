// SPDX-License-Identifier: Apache-2.0
#include "client/view/choices.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <string>
#include <type_traits>

namespace limn {
namespace {

using Json = nlohmann::ordered_json;

// Both directions of remembering, so that no member is kept in one and forgotten in the other.
template <class Memory, class Visit>
void visitMembers(Memory& memory, Visit visit) {
  auto& c = memory.choices;
  visit("draw", c.draw);
  visit("detector", c.detector);
  visit("silhouette", c.silhouette);
  visit("features", c.features);
  visit("style", c.style);
  visit("brush", c.brush);
  visit("hidden", c.hidden);
  visit("hull_faces", c.hullFaces);
  visit("width_px", c.widthPx);
  visit("texture_size", c.textureSize);
  visit("orthographic", c.orthographic);
  visit("fov", c.fovDegrees);
  visit("light", c.hasLight);
  visit("light_azimuth", c.lightAzimuth);
  visit("light_elevation", c.lightElevation);
  visit("menu", c.showsMenu);
  visit("timings", c.showsTimings);
  visit("window_width", memory.width);
  visit("window_height", memory.height);
}

template <class Member>
bool isSame(const Json& value) {
  if constexpr (std::is_same_v<Member, bool>) return value.is_boolean();
  if constexpr (std::is_same_v<Member, std::string>) return value.is_string();
  if constexpr (std::is_same_v<Member, int>) return value.is_number_integer();
  return value.is_number();
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace

std::vector<std::string> flagsOf(const ViewChoices& choices) {
  std::vector<std::string> flags = {"--draw",         choices.draw,
                                    "--detector",     choices.detector,
                                    "--silhouette",   choices.silhouette,
                                    "--features",     choices.features,
                                    "--style",        choices.style,
                                    "--brush",        choices.brush,
                                    "--hidden",       choices.hidden,
                                    "--hull-faces",   std::to_string(choices.hullFaces),
                                    "--fov",          number(choices.fovDegrees),
                                    "--texture-size", number(choices.textureSize)};
  if (choices.widthPx > 0.0) flags.insert(flags.end(), {"--width", number(choices.widthPx)});
  if (choices.orthographic) flags.emplace_back("--ortho");
  return flags;
}

bool hasWord(std::string_view list, std::string_view word) {
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(','), list.size());
    if (list.substr(0, end) == word) return true;
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return false;
}

std::string toggled(const std::string& list, std::string_view word) {
  const bool has = hasWord(list, word);
  std::string result;
  const auto append = [&](std::string_view next) {
    if (next.empty() || next == "none") return;
    result += (result.empty() ? "" : ",") + std::string(next);
  };
  std::string_view rest = list;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    if (rest.substr(0, end) != word) append(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  if (!has) append(word);
  return result.empty() ? "none" : result;
}

std::string toJson(const ViewMemory& memory) {
  Json json;
  visitMembers(memory, [&](const char* name, const auto& member) { json[name] = member; });
  return json.dump(2) + "\n";
}

ViewMemory viewMemoryFromJson(std::string_view text) {
  ViewMemory memory;
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return memory;
  visitMembers(memory, [&](const char* name, auto& member) {
    using Member = std::remove_reference_t<decltype(member)>;
    const auto found = json.find(name);
    if (found != json.end() && isSame<Member>(*found)) member = found->template get<Member>();
  });
  ViewChoices& choices = memory.choices;
  choices.fovDegrees = std::clamp(choices.fovDegrees, 5.0, 120.0);
  choices.widthPx = std::clamp(choices.widthPx, 0.0, 50.0);
  choices.hullFaces = std::clamp(choices.hullFaces, kLeastHullFaces, kMostHullFaces);
  choices.textureSize = std::clamp(choices.textureSize, 0.1, 10.0);
  memory.width = std::clamp(memory.width, 320, 8192);
  memory.height = std::clamp(memory.height, 240, 8192);
  return memory;
}

}  // namespace limn
