// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/style.h"

#include "shared/core/toml_errors.h"

// Header only and without exceptions: the packaged library is built with them.
#define TOML_EXCEPTIONS 0
#define TOML_HEADER_ONLY 1
#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace limn {
namespace {

/// How one key is read.
struct Reader {
  std::string wanted;                           // what its value must be
  std::function<bool(const toml::node&)> read;  // false when it will not do
};

using Readers = std::map<std::string, Reader, std::less<>>;

Reader number(float& out, float low, float high) {
  return {tomlNumberFrom(low, high), [&out, low, high](const toml::node& node) {
            const auto value = node.value<double>();
            if (!value || !std::isfinite(*value) || *value < low || *value > high) return false;
            out = static_cast<float>(*value);
            return true;
          }};
}

Reader color(glm::vec3& out) {
  return {"a colour, \"#rrggbb\"", [&out](const toml::node& node) {
            const auto text = node.value<std::string>();
            const auto parsed = text ? parseColor(*text) : fail(ErrorCode::kInvalidArgument, "");
            if (parsed) out = *parsed;
            return parsed.has_value();
          }};
}

Reader fileName(std::string& out) {
  return {"the name of a file beside the style, in quotes", [&out](const toml::node& node) {
            const auto text = node.value<std::string>();
            // A style names files beside it, never elsewhere.
            if (!text || text->empty() || text->find('/') != std::string::npos ||
                text->front() == '.')
              return false;
            out = *text;
            return true;
          }};
}

template <class Map>
std::vector<std::string_view> namesOf(const Map& map) {
  std::vector<std::string_view> names;
  for (const auto& entry : map)
    names.push_back(entry.first);
  return names;
}

Result<void> readTable(const toml::table& table, const std::string& where, const Readers& readers) {
  for (const auto& [key, node] : table) {
    if (node.is_table()) continue;  // read on its own
    const std::string name = where + std::string(key.str());
    const std::size_t line = node.source().begin.line;
    const auto reader = readers.find(key.str());
    if (reader == readers.end())
      return fail(ErrorCode::kCorrupt, unknownTomlKey(line, name, namesOf(readers)));
    if (!reader->second.read(node))
      return fail(ErrorCode::kCorrupt, wrongTomlValue(line, name, reader->second.wanted));
  }
  return {};
}

Readers textureReaders(StrokeTexture& texture) {
  return {
      {"texture", fileName(texture.file)},
      {"length_px", number(texture.lengthPx, 4.0F, 4096.0F)},
      {"color", color(texture.color)},
      {"opacity", number(texture.opacity, 0.0F, 1.0F)}};
}

}  // namespace

Result<glm::vec3> parseColor(std::string_view text) {
  unsigned value = 0;
  const bool hasForm = text.size() == 7 && text.front() == '#';
  if (hasForm) {
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + 7, value, 16);
    if (error == std::errc() && end == text.data() + 7) {
      return glm::vec3((value >> 16U) & 255U, (value >> 8U) & 255U, value & 255U) / 255.0F;
    }
  }
  return fail(
      ErrorCode::kInvalidArgument,
      "'" + std::string(text) + "' is not a colour: write #rrggbb");
}

Result<StrokeStyle> parseStyle(std::string_view text) {
  const toml::parse_result parsed = toml::parse(text);
  if (!parsed) {
    return fail(
        ErrorCode::kCorrupt,
        tomlError(parsed.error().source().begin.line, parsed.error().description()));
  }
  const toml::table& root = parsed.table();
  StrokeStyle style;
  const std::map<std::string, Readers, std::less<>> tables = {
      {"stroke",
       {{"width_px", number(style.widthPx, 0.2F, 64.0F)},
        {"body", number(style.body, 0.1F, 1.0F)},
        {"taper_px", number(style.taperPx, 0.0F, 256.0F)},
        {"overshoot_px", number(style.overshootPx, 0.0F, 64.0F)},
        {"pool", number(style.pool, 0.0F, 2.0F)},
        {"crease_width", number(style.creaseWidth, 0.1F, 2.0F)},
        {"smooth_px", number(style.smoothPx, 0.0F, 8.0F)},
        {"crease_fade", number(style.creaseFade, 0.0F, 16.0F)},
        {"fade_below_px", number(style.fadeBelowPx, 0.0F, 256.0F)},
        {"fade_hidden_below_px", number(style.fadeHiddenBelowPx, 0.0F, 256.0F)}}},
      {"visible", textureReaders(style.visible)},
      {"hidden", textureReaders(style.hidden)},
      {"paper", {{"color", color(style.paper)}, {"grain", number(style.grain, 0.0F, 1.0F)}}}};
  for (const auto& [key, node] : root) {
    const auto readers = tables.find(key.str());
    const std::size_t line = node.source().begin.line;
    if (readers == tables.end())
      return fail(ErrorCode::kCorrupt, unknownTomlKey(line, key.str(), namesOf(tables)));
    if (!node.is_table())
      return fail(
          ErrorCode::kCorrupt,
          wrongTomlValue(line, key.str(), "a table, with a line for each of its keys"));
    const auto read = readTable(*node.as_table(), readers->first + ".", readers->second);
    if (!read) return tl::unexpected(read.error());
  }
  for (const auto& [name, texture] :
       {std::pair{"visible", &style.visible}, {"hidden", &style.hidden}}) {
    if (texture->file.empty()) {
      return fail(
          ErrorCode::kCorrupt,
          std::string(name) + ".texture is missing: name a file beside the style");
    }
  }
  return style;
}

StrokeStyle withTextureSize(StrokeStyle style, double factor) {
  for (StrokeTexture* texture : {&style.visible, &style.hidden})
    texture->lengthPx *= static_cast<float>(factor);
  return style;
}

StrokeStyle enlarged(StrokeStyle style, float factor) {
  for (float* length :
       {&style.widthPx,
        &style.taperPx,
        &style.overshootPx,
        &style.smoothPx,
        &style.fadeBelowPx,
        &style.fadeHiddenBelowPx,
        &style.visible.lengthPx,
        &style.hidden.lengthPx})
    *length *= factor;
  return style;
}

}  // namespace limn
