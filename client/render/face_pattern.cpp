// SPDX-License-Identifier: Apache-2.0
#include "client/render/face_pattern.h"

#include <algorithm>
#include <array>
#include <vector>

namespace limn {
namespace {

constexpr std::array<std::uint8_t, 18> kEdgeQuadIndices =
    {0, 1, 2, 2, 1, 3, 4, 5, 6, 6, 5, 7, 8, 9, 10, 10, 9, 11};
constexpr std::array<std::uint8_t, 12> kHexagonIndices = {0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5};
constexpr std::array<std::uint8_t, 6> kQuadIndices = {0, 1, 2, 2, 1, 3};

}  // namespace

const FacePattern::Shape FacePattern::kEdgeQuads = {12, kEdgeQuadIndices};
const FacePattern::Shape FacePattern::kHexagons = {6, kHexagonIndices};
const FacePattern::Shape FacePattern::kQuad = {4, kQuadIndices};

FacePattern FacePattern::create(const gl::Api& api, const Shape& shape) {
  FacePattern pattern;
  pattern.api_ = &api;
  pattern.shapes_ = 0x10000 / shape.vertices;
  pattern.indicesAShape_ = static_cast<int>(shape.triangles.size());
  std::vector<std::uint16_t> indices;
  indices.reserve(static_cast<std::size_t>(pattern.shapes_) * shape.triangles.size());
  for (int i = 0; i < pattern.shapes_; ++i) {
    for (const std::uint8_t corner : shape.triangles)
      indices.push_back(static_cast<std::uint16_t>(i * shape.vertices + corner));
  }
  pattern.array_ = gl::VertexArray::create(api);
  pattern.indices_ = gl::Buffer::create(api);
  api.bindVertexArray(pattern.array_.id());
  api.bindBuffer(GL_ELEMENT_ARRAY_BUFFER, pattern.indices_.id());
  api.bufferData(
      GL_ELEMENT_ARRAY_BUFFER,
      static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint16_t)),
      indices.data(),
      GL_STATIC_DRAW);
  return pattern;
}

void FacePattern::draw(const gl::Program& program, int count) const {
  api_->bindVertexArray(array_.id());
  for (int first = 0; first < count; first += shapes_) {
    program.set("firstFace", first);
    api_->drawElements(
        GL_TRIANGLES,
        indicesAShape_ * std::min(shapes_, count - first),
        GL_UNSIGNED_SHORT,
        nullptr);
  }
}

}  // namespace limn
