// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"

#include "shared/gl/handles.h"
#include "shared/gl/target.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// A mesh as textures, so that a vertex shader can look at whole faces by their number: GLES 3.0
/// has no storage buffers. Rows of kRow texels; entry i is texel (i mod kRow, i / kRow).
class FaceTextures {
 public:
  static constexpr int kRow = 2048;  // every GLES 3.0 has textures so wide

  /// Uploads the snapshot's mesh unless it is there; returns whether it did. center:
  /// MeshPass::center().
  /// Errors: kLimitExceeded (more corners than a texture of this GL holds).
  [[nodiscard]] Result<bool>
  upload(const gl::Api& api, const MeshSnapshot& snapshot, const glm::ivec3& center);

  /// The same of unit vertex normals, the mean of the faces' by area, for the mesh uploaded last.
  void uploadNormals(const MeshSnapshot& snapshot);

  /// A byte a face, for the mesh uploaded last.
  void uploadMarks(std::span<const std::uint8_t> marks);

  [[nodiscard]] const gl::Texture& positions() const { return positions_; }  // kRgba32f

  [[nodiscard]] const gl::Texture& corners() const { return corners_; }  // kR32ui

  [[nodiscard]] const gl::Texture& normals() const { return normals_; }  // kRgba32f

  [[nodiscard]] const gl::Texture& marks() const { return marks_; }  // kR8

  [[nodiscard]] int faceCount() const { return faces_; }

 private:
  const gl::Api* api_ = nullptr;
  gl::Texture positions_;
  gl::Texture corners_;
  gl::Texture normals_;
  gl::Texture marks_;
  // Of the mesh that is there.
  Sha256Digest asset_{};
  std::uint64_t revision_ = 0;
  std::size_t vertices_ = 0;
  int faces_ = 0;
  bool hasNormals_ = false;
};

/// Any other indices in the same rows, kR32ui. Errors: kLimitExceeded.
[[nodiscard]] Result<gl::Texture> makeIndexTexture(
    const gl::Api& api,
    std::vector<std::uint32_t> indices);

}  // namespace limn
