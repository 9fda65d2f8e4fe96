// SPDX-License-Identifier: Apache-2.0
#include "shared/gl/target.h"

#include <string>

namespace limn::gl {
namespace {

GLenum sizedFormat(TexelFormat format) {
  switch (format) {
    case TexelFormat::kR8:
      return GL_R8;
    case TexelFormat::kRg8:
      return GL_RG8;
    case TexelFormat::kRgba8:
      return GL_RGBA8;
    case TexelFormat::kR32ui:
      return GL_R32UI;
    case TexelFormat::kRgba32f:
      return GL_RGBA32F;
    case TexelFormat::kDepth32f:
      return GL_DEPTH_COMPONENT32F;
    case TexelFormat::kDepth24Stencil8:
      return GL_DEPTH24_STENCIL8;
  }
  return GL_RGBA8;
}

}  // namespace

Texture makeTexture(const Api& api, TexelFormat format, TextureSize size) {
  Texture texture = Texture::create(api);
  api.bindTexture(GL_TEXTURE_2D, texture.id());
  api.texStorage2D(GL_TEXTURE_2D, 1, sizedFormat(format), size.width, size.height);
  api.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  api.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  api.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  api.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

Result<Target> Target::create(const Api& api, std::string_view name, const Options& options) {
  GLint largest = 0;
  api.getIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  const TextureSize size = options.size;
  if (size.width < 1 || size.height < 1 || size.width > largest || size.height > largest) {
    return fail(
        ErrorCode::kLimitExceeded,
        std::string(name) + " of " + std::to_string(size.width) + "x" +
            std::to_string(size.height) + " pixels is outside what this GL draws (up to " +
            std::to_string(largest) + "): ask for a smaller picture");
  }
  Target target;
  target.api_ = &api;
  target.size_ = size;
  target.framebuffer_ = Framebuffer::create(api);
  api.bindFramebuffer(GL_FRAMEBUFFER, target.framebuffer_.id());
  if (options.hasColor) {
    target.color_ = makeTexture(api, options.color, size);
    api.framebufferTexture2D(
        GL_FRAMEBUFFER,
        GL_COLOR_ATTACHMENT0,
        GL_TEXTURE_2D,
        target.color_.id(),
        0);
  }
  if (options.hasDepth || options.hasStencil) {
    target.depth_ = makeTexture(
        api,
        options.hasStencil ? TexelFormat::kDepth24Stencil8 : TexelFormat::kDepth32f,
        size);
    api.framebufferTexture2D(
        GL_FRAMEBUFFER,
        options.hasStencil ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT,
        GL_TEXTURE_2D,
        target.depth_.id(),
        0);
  }
  const GLenum buffer = options.hasColor ? GL_COLOR_ATTACHMENT0 : GL_NONE;
  api.drawBuffers(1, &buffer);
  api.readBuffer(buffer);
  const GLenum status = api.checkFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    return fail(
        ErrorCode::kUnavailable,
        "this GL cannot draw into " + std::string(name) + " (framebuffer status " +
            std::to_string(status) + ")");
  }
  return target;
}

void Target::bind() const {
  api_->bindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  api_->viewport(0, 0, size_.width, size_.height);
}

void bindTexture(const Api& api, int unit, const Texture& texture) {
  api.activeTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  api.bindTexture(GL_TEXTURE_2D, texture.id());
}

}  // namespace limn::gl
