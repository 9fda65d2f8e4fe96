// SPDX-License-Identifier: Apache-2.0
#include "client/render/style_files.h"

#include "client/render/assets.h"
#include "client/render/image_io.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

namespace limn {
namespace {

/// How much ink each pixel of a stroke's picture holds: its alpha, or, for a scan of a stroke on
/// paper without alpha, its darkness.
InkImage inkOf(const Image& image) {
  const std::size_t pixels = image.rgba.size() / 4;
  bool hasAlpha = false;
  for (std::size_t i = 0; i < pixels; ++i)
    hasAlpha = hasAlpha || image.rgba[4 * i + 3] != 255;
  InkImage ink{image.width, image.height, {}};
  ink.ink.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t* p = &image.rgba[4 * i];
    ink.ink[i] =
        hasAlpha ? p[3]
                 : static_cast<std::uint8_t>(255 - (299 * p[0] + 587 * p[1] + 114 * p[2]) / 1000);
  }
  return ink;
}

}  // namespace

Result<StyleFiles> readStyle(const std::filesystem::path& assets, const std::string& name) {
  const std::vector<std::string> names = listStyles(assets);
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    std::string choices;
    for (const std::string& choice : names)
      choices += (choices.empty() ? "" : ", ") + choice;
    return fail(
        ErrorCode::kInvalidArgument,
        "there is no style '" + name + "': use one of " + (choices.empty() ? "none" : choices));
  }
  const std::filesystem::path folder = assets / name;
  const std::filesystem::path file = folder / "style.toml";
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  auto style = parseStyle(text);
  if (!style) return tl::unexpected(style.error().within(file.string()));
  const auto visible = readPng(folder / style->visible.file);
  if (!visible) return tl::unexpected(visible.error());
  const auto hidden = readPng(folder / style->hidden.file);
  if (!hidden) return tl::unexpected(hidden.error());
  return StyleFiles{*std::move(style), inkOf(*visible), inkOf(*hidden)};
}

}  // namespace limn
