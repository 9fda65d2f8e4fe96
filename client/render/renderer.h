// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"
#include "client/render/draw_options.h"
#include "client/render/gl_context.h"
#include "client/render/image.h"
#include "client/render/scene.h"
#include "client/stroke/chain/polyline.h"
#include "client/stroke/visibility/depth_image.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace limn {

struct Frame {
  Image image;
  FrameTimings timings;
  DepthImage depth;  // empty unless RenderOptions::keepDepth
};

struct GlDescription {
  std::string renderer;  // GL_RENDERER
  std::string version;   // GL_VERSION
};

/// Draws meshes and their lines. Owns its context and everything on the GPU; the mesh of the last
/// snapshot stays there until a snapshot of another asset or revision comes.
/// Threads: made, used and destroyed on one thread.
class Renderer {
 public:
  /// assets: the folder of texture sets, see findAssets(). Compiles what every method
  /// needs; a method's own shaders are compiled when it is first asked for.
  /// Errors: kUnavailable (the context lacks something, or a shader does not compile).
  [[nodiscard]] static Result<Renderer> create(
      std::unique_ptr<GlContext> context,
      std::filesystem::path assets);

  /// With a context of its own. assets: as findAssets() takes it. Errors: also those of
  /// createGlContext() and findAssets().
  [[nodiscard]] static Result<Renderer> open(
      GlBackend backend,
      const std::optional<std::filesystem::path>& assets = std::nullopt);

  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  /// lines: chained lines of snapshot.mesh, in its grid units; halfEdges and faces index its mesh.
  /// Looked at only if needsLines(options.draw).
  /// Errors: kInvalidArgument (size, supersample, unknown style), kLimitExceeded (picture larger
  /// than the GPU allows), kCorrupt (a damaged texture set).
  /// Cost: O(vertices + faces + pixels + length of the lines in pixels).
  [[nodiscard]] Result<Frame> render(
      const MeshSnapshot& snapshot,
      const PolylineSet& lines,
      const Camera& camera,
      const RenderOptions& options);

  /// Several models by silhouette clipping (options.draw: kClip), each over those behind it
  /// [Sander00 §3]. camera: of the scene, its depth range fitted to all of it. Where the eye is
  /// inside of a hull, all are drawn as meshes. Models whose spheres meet may be drawn in the wrong
  /// order. Errors: also kInvalidArgument (no model, or more than 16).
  [[nodiscard]] Result<Frame> renderScene(
      std::span<const SceneObject> objects,
      const Camera& camera,
      const RenderOptions& options);

  [[nodiscard]] const GlDescription& gl() const;

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace limn
