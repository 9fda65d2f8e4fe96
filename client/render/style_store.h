// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/style.h"

#include "shared/gl/handles.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>

namespace limn {

/// A style with its textures on the GPU: one channel of ink, repeated along u, clamped across.
struct LoadedStyle {
  StrokeStyle style;
  gl::Texture visible;
  gl::Texture hidden;
};

/// The texture sets of an assets folder, each loaded when first asked for.
class StyleStore {
 public:
  explicit StyleStore(std::filesystem::path assets) : assets_(std::move(assets)) {}

  /// The context of `api` is current. The pointer stays valid as long as the store.
  /// Errors: kInvalidArgument (no such style, naming those there are), kCorrupt, kLimitExceeded.
  [[nodiscard]] Result<const LoadedStyle*> load(const gl::Api& api, const std::string& name);

 private:
  std::filesystem::path assets_;
  std::map<std::string, std::unique_ptr<LoadedStyle>> loaded_;
};

}  // namespace limn
