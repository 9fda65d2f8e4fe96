// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/gl/handles.h"

#include <string_view>

namespace limn::gl {

/// What a texture that is drawn into or read by texel holds.
enum class TexelFormat {
  kR8,        // one channel, 0 … 1
  kRg8,       // two channels, 0 … 1
  kRgba8,     // four channels, 0 … 1
  kR32ui,     // one 32-bit word
  kRgba32f,   // four floats; not drawn into (GLES 3.0 does not promise it)
  kDepth32f,  // depth, sampled as a float
  kDepth24Stencil8,
};

struct TextureSize {
  int width = 0;
  int height = 0;
  friend bool operator==(const TextureSize&, const TextureSize&) = default;
};

/// An immutable one-level texture, nearest filtering, edges clamped.
[[nodiscard]] Texture makeTexture(const Api& api, TexelFormat format, TextureSize size);

/// A framebuffer with a colour texture, a depth texture, or both.
class Target {
 public:
  Target() = default;

  struct Options {
    TextureSize size;
    bool hasColor = true;
    TexelFormat color = TexelFormat::kRgba8;
    bool hasDepth = false;    // a kDepth32f texture
    bool hasStencil = false;  // a kDepth24Stencil8 texture instead: depth comes with it
  };

  /// Errors: kLimitExceeded (larger than GL_MAX_TEXTURE_SIZE), kUnavailable (incomplete: name says
  /// which).
  [[nodiscard]] static Result<Target>
  create(const Api& api, std::string_view name, const Options& options);

  /// Binds it and sets the viewport to all of it.
  void bind() const;

  [[nodiscard]] const Texture& color() const { return color_; }

  [[nodiscard]] const Texture& depth() const { return depth_; }

  [[nodiscard]] TextureSize size() const { return size_; }

 private:
  const Api* api_ = nullptr;
  TextureSize size_;
  Texture color_;
  Texture depth_;
  Framebuffer framebuffer_;
};

/// Binds `texture` to texture unit `unit`.
void bindTexture(const Api& api, int unit, const Texture& texture);

}  // namespace limn::gl
