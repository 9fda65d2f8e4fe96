// SPDX-License-Identifier: Apache-2.0
#include "client/render/style_store.h"

#include "client/render/style_files.h"

#include <utility>

namespace limn {
namespace {

Result<gl::Texture> loadStroke(const gl::Api& api, const InkImage& image) {
  GLint largest = 0;
  api.getIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (image.width > largest || image.height > largest) {
    return fail(
        ErrorCode::kLimitExceeded,
        "a stroke's picture is larger than this GL's textures (" + std::to_string(largest) +
            " pixels)");
  }
  gl::Texture texture = gl::Texture::create(api);
  api.bindTexture(GL_TEXTURE_2D, texture.id());
  api.pixelStorei(GL_UNPACK_ALIGNMENT, 1);
  api.texImage2D(
      GL_TEXTURE_2D,
      0,
      GL_R8,
      image.width,
      image.height,
      0,
      GL_RED,
      GL_UNSIGNED_BYTE,
      image.ink.data());
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
  auto files = readStyle(assets_, name);
  if (!files) return tl::unexpected(files.error());
  auto visible = loadStroke(api, files->visible);
  if (!visible) return tl::unexpected(visible.error().within("style " + name));
  auto hidden = loadStroke(api, files->hidden);
  if (!hidden) return tl::unexpected(hidden.error().within("style " + name));
  auto loaded = std::make_unique<LoadedStyle>(
      LoadedStyle{files->style, *std::move(visible), *std::move(hidden)});
  return loaded_.emplace(name, std::move(loaded)).first->second.get();
}

}  // namespace limn
