// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/gl/handles.h"
#include "shared/gl/program.h"

#include <cstdint>
#include <span>

namespace limn {

/// The same few triangles over and over, one set a face (or edge), without attributes: the vertex
/// shader makes the vertices from gl_VertexID, and an index buffer saves it from making one twice.
/// Meshes of any size take turns with one small buffer.
class FacePattern {
 public:
  struct Shape {
    int vertices;
    std::span<const std::uint8_t> triangles;  // indices of its vertices
  };

  static const Shape kEdgeQuads;  // three quads: corners 4e … 4e + 3 as a strip
  static const Shape kHexagons;   // a fan over six corners
  static const Shape kQuad;       // one quad, corners as a strip

  FacePattern() = default;
  [[nodiscard]] static FacePattern create(const gl::Api& api, const Shape& shape);

  [[nodiscard]] explicit operator bool() const { return api_ != nullptr; }

  /// Draws the shape `count` times with the program in use; sets its uniform `firstFace`, the
  /// number of the first one of a draw call.
  void draw(const gl::Program& program, int count) const;

 private:
  const gl::Api* api_ = nullptr;
  gl::VertexArray array_;
  gl::Buffer indices_;
  int shapes_ = 0;  // in the buffer
  int indicesAShape_ = 0;
};

}  // namespace limn
