// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/mesh_pass.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"
#include "shared/gl/handles.h"
#include "shared/gl/program.h"
#include "shared/gl/target.h"

#include <string_view>

namespace limn {

/// What the drawing methods of one renderer share: the mesh on the GPU, its depth image, and
/// full-screen passes. Threads: the renderer's.
class DrawTools {
 public:
  /// api outlives the tools. Errors: kUnavailable.
  [[nodiscard]] static Result<DrawTools> create(const gl::Api& api);

  [[nodiscard]] const gl::Api& api() const { return *api_; }

  [[nodiscard]] const MeshPass& mesh() const { return mesh_; }

  /// A frame begins: its mesh goes to the GPU unless it is there. Returns whether it went.
  bool begin(const MeshSnapshot& snapshot);

  /// The depth image of this frame's mesh, drawn when it is first asked for.
  /// Errors: kLimitExceeded, kUnavailable.
  [[nodiscard]] Result<const gl::Target*>
  depthImage(const MeshSnapshot& snapshot, const Camera& camera, gl::TextureSize size);

  /// Makes `target` anew unless it already has this size and the stencil buffer asked for. Errors:
  /// kLimitExceeded, kUnavailable.
  [[nodiscard]] Result<void>
  fit(gl::Target& target, std::string_view name, const gl::Target::Options& options) const;

  /// One fragment a pixel of the bound target, with the program in use; no blending.
  void drawScreen() const;

  /// Averages supersample² texels of `fine` into each pixel of `picture`.
  void reduce(const gl::Texture& fine, int supersample, const gl::Target& picture) const;

 private:
  const gl::Api* api_ = nullptr;
  MeshPass mesh_;
  gl::Program reduceProgram_;
  gl::VertexArray noAttributes_;
  gl::Target depth_;  // depth alone
  bool hasDepth_ = false;
};

}  // namespace limn
