// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"
#include "client/render/gl_context.h"

#include "shared/core/camera.h"
#include "shared/core/ids.h"
#include "shared/gl/handles.h"
#include "shared/gl/program.h"
#include "shared/gl/target.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace limn {

/// Faces where silhouettes can be picked up, from a picture of the mesh [Mohr13 §3.2.3]: normals as
/// colours and face numbers are drawn, Canny's detector runs on the normals as shader passes, and
/// the faces under its edges are read back. Has a context of its own; threads: its own.
class ImageSeeds {
 public:
  struct Options {
    Viewport viewport;
    /// Of the gradient's L1 norm over bytes, as cv::Canny's.
    int lowThreshold = 60;
    int highThreshold = 150;
    /// Steps of hysteresis: pixels that a weak edge reaches away from a strong one.
    int hysteresisSteps = 24;
  };

  /// Errors: kUnavailable (no GL), kLimitExceeded (a picture that is too large for it).
  [[nodiscard]] static Result<ImageSeeds> create(GlBackend backend, const Options& options);

  ImageSeeds(ImageSeeds&&) noexcept = default;
  ImageSeeds& operator=(ImageSeeds&&) = delete;
  ~ImageSeeds();

  /// Faces under edges, in the order of their first pixel; valid until the next call. Nothing when
  /// the context cannot be made current.
  [[nodiscard]] std::span<const FaceId> find(const MeshSnapshot& snapshot, const Camera& camera);

  /// The pictures of the last call, bytes by row from below: normals (RGBA) and edges (255: yes).
  [[nodiscard]] std::vector<std::uint8_t> normalImage() const;
  [[nodiscard]] std::vector<std::uint8_t> edgeImage() const;

 private:
  ImageSeeds() = default;
  Result<void> makePrograms();
  Result<void> makeTargets();
  void upload(const MeshSnapshot& snapshot);
  void drawMesh(
      const MeshSnapshot& snapshot,
      const Camera& camera,
      const gl::Program& program,
      const gl::Target& target) const;
  void findEdges();
  void drawScreen(const gl::Target& target) const;
  [[nodiscard]] std::vector<std::uint8_t> read(const gl::Target& target) const;

  Options options_;
  std::unique_ptr<GlContext> context_;
  const gl::Api* api_ = nullptr;
  gl::Program faceProgram_, normalProgram_, gradientProgram_, ridgeProgram_, hysteresisProgram_,
      gatherProgram_;
  gl::Target faces_, normals_, gradient_, edges_, otherEdges_, gathered_;
  gl::VertexArray corners_, screen_;
  gl::Buffer cornerData_;
  // Of the mesh that is there.
  Sha256Digest asset_{};
  std::uint64_t revision_ = 0;
  std::size_t cornerCount_ = 0;
  bool hasMesh_ = false;
  glm::ivec3 center_{0};
  std::vector<FaceId> found_;
  std::vector<std::uint8_t> isFound_;  // by face
};

}  // namespace limn
