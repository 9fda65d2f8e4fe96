// SPDX-License-Identifier: Apache-2.0
#include "client/render/mesh_pass.h"

#include "client/render/shaders/shaders.h"

#include <vector>

namespace limn {

Result<MeshPass> MeshPass::create(const gl::Api& api) {
  MeshPass pass;
  pass.api_ = &api;
  auto depth = gl::Program::build(api, "mesh depth", shaders::kMeshVertex, shaders::kDepthFragment);
  if (!depth) return tl::unexpected(depth.error());
  auto shaded =
      gl::Program::build(api, "shaded mesh", shaders::kMeshVertex, shaders::kShadedFragment);
  if (!shaded) return tl::unexpected(shaded.error());
  pass.depthProgram_ = *std::move(depth);
  pass.shadedProgram_ = *std::move(shaded);
  pass.vertexArray_ = gl::VertexArray::create(api);
  pass.positions_ = gl::Buffer::create(api);
  pass.colors_ = gl::Buffer::create(api);
  pass.indices_ = gl::Buffer::create(api);
  return pass;
}

glm::vec3 MeshPass::lightOf(const Camera& camera) {
  const glm::dmat3 worldFromView = glm::transpose(glm::dmat3(camera.viewFromWorld()));
  return glm::vec3(worldFromView * glm::normalize(glm::dvec3(-0.4, 0.6, 0.7)));
}

bool MeshPass::upload(const MeshSnapshot& snapshot) {
  const auto positions = snapshot.mesh.positions();
  const std::vector<std::uint32_t>& origins = snapshot.mesh.mesh().origins;
  if (hasMesh_ && asset_ == snapshot.model.asset && revision_ == snapshot.revision &&
      vertices_ == positions.size() && indexCount_ == origins.size()) {
    return false;
  }
  hasMesh_ = true;
  asset_ = snapshot.model.asset;
  revision_ = snapshot.revision;
  vertices_ = positions.size();
  indexCount_ = origins.size();

  glm::ivec3 low(0);
  glm::ivec3 high(0);
  if (!positions.empty()) low = high = positions[0];
  for (const glm::ivec3& p : positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  center_ = (low + high) / 2;
  std::vector<glm::vec3> relative;
  relative.reserve(positions.size());
  for (const glm::ivec3& p : positions)
    relative.emplace_back(p - center_);

  // A new one: the last mesh may have had colours where this one has none.
  vertexArray_ = gl::VertexArray::create(*api_);
  api_->bindVertexArray(vertexArray_.id());
  api_->bindBuffer(GL_ARRAY_BUFFER, positions_.id());
  api_->bufferData(
      GL_ARRAY_BUFFER,
      static_cast<GLsizeiptr>(relative.size() * sizeof(glm::vec3)),
      relative.data(),
      GL_DYNAMIC_DRAW);
  api_->enableVertexAttribArray(0);
  api_->vertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
  const std::vector<SrgbColor>& colors = snapshot.mesh.attributes().colors;
  hasColors_ = !colors.empty();
  if (hasColors_) {
    api_->bindBuffer(GL_ARRAY_BUFFER, colors_.id());
    api_->bufferData(
        GL_ARRAY_BUFFER,
        static_cast<GLsizeiptr>(colors.size() * sizeof(SrgbColor)),
        colors.data(),
        GL_DYNAMIC_DRAW);
    api_->enableVertexAttribArray(1);
    api_->vertexAttribPointer(1, 3, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(SrgbColor), nullptr);
  }
  api_->bindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  api_->bufferData(
      GL_ELEMENT_ARRAY_BUFFER,
      static_cast<GLsizeiptr>(origins.size() * sizeof(std::uint32_t)),
      origins.data(),
      GL_DYNAMIC_DRAW);
  return true;
}

glm::mat4 MeshPass::clipFromCenter(
    const MeshSnapshot& snapshot,
    const Camera& camera,
    gl::TextureSize size) const {
  // In double up to the last step: the float matrix only sees numbers about the model's centre.
  const Grid& grid = snapshot.model.grid;
  const glm::dmat4 clipFromWorld =
      camera.clipFromWorld(static_cast<double>(size.width) / size.height);
  glm::dmat4 clip = clipFromWorld * grid.step;
  clip[3] = clipFromWorld * glm::dvec4(grid.toModel(center_), 1.0);
  return glm::mat4(clip);
}

void MeshPass::draw(
    const MeshSnapshot& snapshot,
    const Camera& camera,
    const gl::Target& target,
    const gl::Program& program) const {
  program.set("clipFromCenter", clipFromCenter(snapshot, camera, target.size()));
  api_->enable(GL_DEPTH_TEST);
  api_->depthFunc(GL_LESS);
  api_->depthMask(GL_TRUE);
  // Inside of a closed mesh nothing but its front faces can be nearest.
  if (snapshot.model.closed) api_->enable(GL_CULL_FACE);
  api_->bindVertexArray(vertexArray_.id());
  api_->drawElements(GL_TRIANGLES, static_cast<GLsizei>(indexCount_), GL_UNSIGNED_INT, nullptr);
  api_->disable(GL_CULL_FACE);
  api_->disable(GL_DEPTH_TEST);
}

void MeshPass::drawDepth(
    const MeshSnapshot& snapshot,
    const Camera& camera,
    const gl::Target& target) const {
  target.bind();
  api_->clearDepthf(1.0F);
  api_->depthMask(GL_TRUE);
  api_->clear(GL_DEPTH_BUFFER_BIT);
  depthProgram_.use();
  draw(snapshot, camera, target, depthProgram_);
}

void MeshPass::drawShaded(
    const MeshSnapshot& snapshot,
    const Camera& camera,
    const gl::Target& target,
    const Shading& shading) const {
  target.bind();
  const glm::vec3& background = shading.background;
  api_->clearColor(background.x, background.y, background.z, 1.0F);
  api_->clearDepthf(1.0F);
  api_->depthMask(GL_TRUE);
  if (shading.over == Shading::Over::kBackground)
    api_->clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  shadedProgram_.use();
  glm::vec4 light(lightOf(camera), 0.0F);
  if (shading.light) {
    const Grid& grid = snapshot.model.grid;
    light = glm::dvec4((*shading.light - grid.toModel(center_)) / grid.step, 1.0);
  }
  shadedProgram_.set("light", light);
  shadedProgram_.set("surface", kSurface);
  shadedProgram_.set("painted", hasColors_ ? 1.0F : 0.0F);
  draw(snapshot, camera, target, shadedProgram_);
}

}  // namespace limn
