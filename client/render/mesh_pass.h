// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"

#include "shared/core/camera.h"
#include "shared/gl/handles.h"
#include "shared/gl/program.h"
#include "shared/gl/target.h"

#include <cstdint>
#include <optional>

namespace limn {

/// The mesh on the GPU, drawn for its depth or lit.
class MeshPass {
 public:
  /// Colour of what is lit.
  static constexpr glm::vec3 kSurface{0.82F, 0.80F, 0.76F};
  /// Towards the light above the viewer's left shoulder, unit, in the mesh's axes.
  [[nodiscard]] static glm::vec3 lightOf(const Camera& camera);

  /// Errors: kUnavailable.
  [[nodiscard]] static Result<MeshPass> create(const gl::Api& api);

  /// Uploads the snapshot's mesh unless it is the one already there (same asset, revision, counts).
  /// Positions are grid units relative to the box's centre, exact in float; returns whether it did.
  bool upload(const MeshSnapshot& snapshot);

  /// Draws depth into target.depth().
  void drawDepth(const MeshSnapshot& snapshot, const Camera& camera, const gl::Target& target)
      const;

  struct Shading {
    enum class Over : std::uint8_t { kBackground, kPicture };  // kPicture: nothing is cleared
    Over over = Over::kBackground;
    glm::vec3 background{1.0F};
    std::optional<glm::dvec3> light = std::nullopt;  // a place, model coordinates; unset: above
                                                     // the viewer's left shoulder
  };

  /// Draws the lit mesh, in its vertices' colours where it has them.
  void drawShaded(
      const MeshSnapshot& snapshot,
      const Camera& camera,
      const gl::Target& target,
      const Shading& shading) const;

  /// Draws the faces, depth-tested, with `program` (of shaders::kMeshVertex, in use) into `target`,
  /// which is bound and cleared.
  void draw(
      const MeshSnapshot& snapshot,
      const Camera& camera,
      const gl::Target& target,
      const gl::Program& program) const;

  /// Grid place that the uploaded positions are relative to.
  [[nodiscard]] const glm::ivec3& center() const { return center_; }

  /// From them to clip space, for a picture of this size.
  [[nodiscard]] glm::mat4
  clipFromCenter(const MeshSnapshot& snapshot, const Camera& camera, gl::TextureSize size) const;

 private:
  const gl::Api* api_ = nullptr;
  gl::Program depthProgram_;
  gl::Program shadedProgram_;
  gl::VertexArray vertexArray_;
  gl::Buffer positions_;
  gl::Buffer colors_;
  gl::Buffer indices_;
  // Of the mesh that is there.
  bool hasMesh_ = false;
  bool hasColors_ = false;
  Sha256Digest asset_{};
  std::uint64_t revision_ = 0;
  std::size_t vertices_ = 0;
  std::size_t indexCount_ = 0;
  glm::ivec3 center_{0};
};

}  // namespace limn
