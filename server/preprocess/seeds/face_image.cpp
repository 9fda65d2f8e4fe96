// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/seeds/face_image.h"

#include <cstdint>

namespace limn {
namespace {

// GLES 3.0 has no primitive id: corners are drawn without an index buffer, so that each knows its
// face. The id, plus one, goes out as four bytes.
constexpr char kVertexShader[] = R"(#version 300 es
precision highp float;
layout(location = 0) in vec3 position;
uniform mat4 clipFromGrid;
flat out uint face;
void main() {
  face = uint(gl_VertexID) / 3u + 1u;
  gl_Position = clipFromGrid * vec4(position, 1.0);
}
)";

constexpr char kFragmentShader[] = R"(#version 300 es
precision highp float;
precision highp int;
flat in uint face;
out vec4 color;
void main() {
  uvec4 bytes = uvec4(face, face >> 8, face >> 16, face >> 24) & 255u;
  color = vec4(bytes) / 255.0;
}
)";

}  // namespace

Result<FaceImageRenderer> FaceImageRenderer::create(
    const GlContext& context,
    const TriangleMesh& mesh,
    int size,
    BackFaces backFaces) {
  const gl::Api& api = context.api();
  FaceImageRenderer renderer;
  renderer.api_ = &api;
  renderer.backFaces_ = backFaces;
  auto program = gl::Program::build(api, "face image", kVertexShader, kFragmentShader);
  if (!program) return tl::unexpected(program.error());
  renderer.program_ = *std::move(program);
  gl::Target::Options options;
  options.size = {size, size};
  options.hasDepth = true;
  auto target = gl::Target::create(api, "face image", options);
  if (!target) return tl::unexpected(target.error());
  renderer.target_ = *std::move(target);

  std::vector<glm::vec3> corners;
  corners.reserve(3 * mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k)
      corners.emplace_back(mesh.positions[t[k]]);
  }
  renderer.cornerCount_ = static_cast<GLsizei>(corners.size());
  renderer.vertexArray_ = gl::VertexArray::create(api);
  renderer.corners_ = gl::Buffer::create(api);
  api.bindVertexArray(renderer.vertexArray_.id());
  api.bindBuffer(GL_ARRAY_BUFFER, renderer.corners_.id());
  api.bufferData(
      GL_ARRAY_BUFFER,
      static_cast<GLsizeiptr>(corners.size() * sizeof(glm::vec3)),
      corners.data(),
      GL_STATIC_DRAW);
  api.enableVertexAttribArray(0);
  api.vertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
  return renderer;
}

FaceImage FaceImageRenderer::render(const glm::dmat4& clipFromGrid) const {
  const gl::Api& api = *api_;
  target_.bind();
  api.clearColor(0.0F, 0.0F, 0.0F, 0.0F);
  api.clearDepthf(1.0F);
  api.depthMask(GL_TRUE);
  api.enable(GL_DEPTH_TEST);
  api.depthFunc(GL_LESS);
  if (backFaces_ == BackFaces::kLeftOut) {
    api.enable(GL_CULL_FACE);  // GL's defaults: counter-clockwise is front, back is culled
  } else {
    api.disable(GL_CULL_FACE);
  }
  api.disable(GL_BLEND);
  api.disable(GL_DITHER);
  api.clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  program_.use();
  program_.set("clipFromGrid", glm::mat4(clipFromGrid));
  api.bindVertexArray(vertexArray_.id());
  api.drawArrays(GL_TRIANGLES, 0, cornerCount_);

  FaceImage image;
  image.size = target_.size().width;
  const auto pixels = static_cast<std::size_t>(image.size) * static_cast<std::size_t>(image.size);
  std::vector<std::uint8_t> bytes(4 * pixels);
  api.pixelStorei(GL_PACK_ALIGNMENT, 1);
  api.readPixels(0, 0, image.size, image.size, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
  image.faces.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint32_t id = bytes[4 * i] | bytes[4 * i + 1] << 8 | bytes[4 * i + 2] << 16 |
                             static_cast<std::uint32_t>(bytes[4 * i + 3]) << 24;
    image.faces[i] = id - 1;  // 0, the background, becomes kNone
  }
  return image;
}

}  // namespace limn
