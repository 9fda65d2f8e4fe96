// SPDX-License-Identifier: Apache-2.0
#include "client/render/style_store.h"

#include "client/render/assets.h"
#include "client/render/image_io.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <utility>
#include <vector>

namespace limn {
namespace {

/// How much ink each pixel of a stroke's picture holds: its alpha, or, for a scan of a stroke on
/// paper without alpha, its darkness.
std::vector<std::uint8_t> inkOf(const Image& image) {
  const std::size_t pixels = image.rgba.size() / 4;
  bool hasAlpha = false;
  for (std::size_t i = 0; i < pixels; ++i)
    hasAlpha = hasAlpha || image.rgba[4 * i + 3] != 255;
  std::vector<std::uint8_t> ink(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t* p = &image.rgba[4 * i];
    ink[i] = hasAlpha
                 ? p[3]
                 : static_cast<std::uint8_t>(255 - (299 * p[0] + 587 * p[1] + 114 * p[2]) / 1000);
  }
  return ink;
}

Result<gl::Texture> loadStroke(const gl::Api& api, const std::filesystem::path& path) {
  const auto image = readPng(path);
  if (!image) return tl::unexpected(image.error());
  GLint largest = 0;
  api.getIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (image->width > largest || image->height > largest) {
    return fail(
        ErrorCode::kLimitExceeded,
        path.string() + " is larger than this GL's textures (" + std::to_string(largest) +
            " pixels)");
  }
  const std::vector<std::uint8_t> ink = inkOf(*image);
  gl::Texture texture = gl::Texture::create(api);
  api.bindTexture(GL_TEXTURE_2D, texture.id());
  api.pixelStorei(GL_UNPACK_ALIGNMENT, 1);
  api.texImage2D(
      GL_TEXTURE_2D,
      0,
      GL_R8,
      image->width,
      image->height,
      0,
      GL_RED,
      GL_UNSIGNED_BYTE,
      ink.data());
  api.generateMipmap(GL_TEXTURE_2D);
  api.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  api.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  api.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
  api.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

}  // namespace

Result<const LoadedStyle*> StyleStore::load(const gl::Api& api, const std::string& name) {
  if (const auto found = loaded_.find(name); found != loaded_.end()) return found->second.get();
  const std::vector<std::string> names = listStyles(assets_);
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    std::string choices;
    for (const std::string& choice : names)
      choices += (choices.empty() ? "" : ", ") + choice;
    return fail(
        ErrorCode::kInvalidArgument,
        "there is no style '" + name + "': use one of " + (choices.empty() ? "none" : choices));
  }
  const std::filesystem::path folder = assets_ / name;
  const std::filesystem::path file = folder / "style.toml";
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  auto style = parseStyle(text);
  if (!style) return tl::unexpected(style.error().within(file.string()));
  auto visible = loadStroke(api, folder / style->visible.file);
  if (!visible) return tl::unexpected(visible.error());
  auto hidden = loadStroke(api, folder / style->hidden.file);
  if (!hidden) return tl::unexpected(hidden.error());
  auto loaded = std::make_unique<LoadedStyle>(
      LoadedStyle{*std::move(style), *std::move(visible), *std::move(hidden)});
  return loaded_.emplace(name, std::move(loaded)).first->second.get();
}

}  // namespace limn
