// SPDX-License-Identifier: Apache-2.0
#include "client/render/draw_tools.h"

#include "client/render/shaders/shaders.h"

#include <utility>

namespace limn {

Result<DrawTools> DrawTools::create(const gl::Api& api) {
  DrawTools tools;
  tools.api_ = &api;
  auto mesh = MeshPass::create(api);
  if (!mesh) return tl::unexpected(mesh.error());
  auto reduce = gl::Program::build(api, "reduce", shaders::kScreenVertex, shaders::kReduceFragment);
  if (!reduce) return tl::unexpected(reduce.error());
  tools.mesh_ = *std::move(mesh);
  tools.reduceProgram_ = *std::move(reduce);
  tools.noAttributes_ = gl::VertexArray::create(api);
  return tools;
}

bool DrawTools::begin(const MeshSnapshot& snapshot) {
  hasDepth_ = false;
  return mesh_.upload(snapshot);
}

Result<const gl::Target*>
DrawTools::depthImage(const MeshSnapshot& snapshot, const Camera& camera, gl::TextureSize size) {
  if (hasDepth_ && depth_.size() == size) return &depth_;
  const gl::Target::Options options{.size = size, .hasColor = false, .hasDepth = true};
  if (auto ok = fit(depth_, "the depth image", options); !ok) return tl::unexpected(ok.error());
  mesh_.drawDepth(snapshot, camera, depth_);
  hasDepth_ = true;
  return &depth_;
}

Result<void> DrawTools::fit(
    gl::Target& target,
    std::string_view name,
    const gl::Target::Options& options) const {
  if (target.size() == options.size && (!options.hasStencil || target.depth())) return {};
  target = {};  // free the old one first
  auto made = gl::Target::create(*api_, name, options);
  if (!made) return tl::unexpected(made.error());
  target = *std::move(made);
  return {};
}

void DrawTools::drawScreen() const {
  api_->disable(GL_BLEND);
  api_->bindVertexArray(noAttributes_.id());
  api_->drawArrays(GL_TRIANGLES, 0, 3);
}

void DrawTools::reduce(const gl::Texture& fine, int supersample, const gl::Target& picture) const {
  picture.bind();
  reduceProgram_.use();
  reduceProgram_.set("picture", 0);
  reduceProgram_.set("supersample", supersample);
  gl::bindTexture(*api_, 0, fine);
  drawScreen();
}

}  // namespace limn
