// SPDX-License-Identifier: Apache-2.0
// Based on: OGLdev tutorial 39, "Silhouette Detection" (triangles with adjacency, a geometry shader
// that emits the edges of front faces whose neighbour is none). M. McGuire and J. Hughes,
// "Hardware-Determined Feature Edges", NPAR 2004 (all edges through a vertex shader).
// Deviations: quads instead of wide lines; an edge's visibility is asked at its middle line, not by
// the depth test of each of its pixels; concave edges are left out, since their own faces hide
// them.
#include "client/render/edge_lines_method.h"

#include "client/render/face_uniforms.h"
#include "client/render/shaders/back_face_shaders.h"
#include "client/render/shaders/edge_line_shaders.h"
#include "client/stroke/visibility/visibility.h"

#include "shared/mesh/adjacency.h"

#include <string>
#include <string_view>
#include <utility>

namespace limn {
namespace {

constexpr std::string_view kEs320 = "#version 320 es\n";

template <class... Parts>
std::string join(const Parts&... parts) {
  std::string text;
  (text.append(parts), ...);
  return text;
}

}  // namespace

Result<std::unique_ptr<DrawingMethod>> EdgeLinesMethod::create(DrawMode mode, DrawTools& tools) {
  std::unique_ptr<EdgeLinesMethod> method(new EdgeLinesMethod(tools));
  method->usesGeometryShader_ =
      mode == DrawMode::kGeometryShader && method->compileGeometryShader().has_value();
  if (!method->usesGeometryShader_) {
    if (auto ok = method->compileConditionalLines(); !ok) return tl::unexpected(ok.error());
  }
  return method;
}

Result<void> EdgeLinesMethod::compileGeometryShader() {
  using namespace shaders;
  const std::string vertex = join(kEs320, kFaceCommon, kAdjacencyVertexMain);
  const std::string geometry =
      join(kEs320, kEdgeGeometryLayout, kFaceCommon, kEdgeCommon, kEdgeCorner, kEdgeGeometryMain);
  const std::string fragment = join(kEs320, kEdgeFragment);
  auto program = gl::Program::build(
      tools_.api(),
      "silhouette edges",
      {.vertex = vertex, .geometry = geometry, .fragment = fragment});
  if (!program) return tl::unexpected(program.error());
  program_ = *std::move(program);
  triangles_ = gl::VertexArray::create(tools_.api());
  adjacency_ = gl::Buffer::create(tools_.api());
  return {};
}

Result<void> EdgeLinesMethod::compileConditionalLines() {
  using namespace shaders;
  const std::string vertex =
      join(kEs300, kFaceCommon, kEdgeCommon, kEdgeCorner, kConditionalLineMain);
  const std::string fragment = join(kEs300, kEdgeFragment);
  auto program = gl::Program::build(tools_.api(), "conditional lines", vertex, fragment);
  if (!program) return tl::unexpected(program.error());
  program_ = *std::move(program);
  quads_ = FacePattern::create(tools_.api(), FacePattern::kQuad);
  return {};
}

Result<void> EdgeLinesMethod::upload(const MeshSnapshot& snapshot) {
  const gl::Api& api = tools_.api();
  const auto isNew = faces_.upload(api, snapshot, tools_.mesh().center());
  if (!isNew) return tl::unexpected(isNew.error());
  if (!*isNew) return {};
  const HalfEdgeMesh& mesh = snapshot.mesh.mesh();
  const std::vector<std::uint32_t> adjacency =
      trianglesWithAdjacency(mesh, snapshot.mesh.positions());
  if (!usesGeometryShader_) {
    std::vector<std::uint32_t> edges = edgesWithOpposites(mesh, adjacency);
    count_ = static_cast<int>(edges.size() / 4);
    auto texture = makeIndexTexture(api, std::move(edges));
    if (!texture) return tl::unexpected(texture.error());
    edges_ = *std::move(texture);
    return {};
  }
  count_ = static_cast<int>(adjacency.size());
  api.bindVertexArray(triangles_.id());
  api.bindBuffer(GL_ELEMENT_ARRAY_BUFFER, adjacency_.id());
  api.bufferData(
      GL_ELEMENT_ARRAY_BUFFER,
      static_cast<GLsizeiptr>(adjacency.size() * sizeof(std::uint32_t)),
      adjacency.data(),
      GL_DYNAMIC_DRAW);
  return {};
}

Result<void>
EdgeLinesMethod::draw(const DrawRequest& request, const gl::Target& picture, FrameTimings&) {
  const gl::Api& api = tools_.api();
  if (auto ok = upload(request.snapshot); !ok) return ok;
  const auto depth = tools_.depthImage(request.snapshot, request.camera, request.fineSize());
  if (!depth) return tl::unexpected(depth.error());
  const gl::Target::Options options{.size = request.fineSize(), .hasDepth = true};
  if (auto ok = tools_.fit(fine_, "the supersampled picture", options); !ok) return ok;
  if (request.options.light) {
    tools_.mesh().drawShaded(
        request.snapshot,
        request.camera,
        fine_,
        {.background = request.paper, .light = request.options.light});
  } else {
    fine_.bind();
    api.clearColor(request.paper.x, request.paper.y, request.paper.z, 1.0F);
    api.clear(GL_COLOR_BUFFER_BIT);
  }
  drawLines(request, (*depth)->depth());
  tools_.reduce(fine_.color(), request.supersample, picture);
  return {};
}

void EdgeLinesMethod::drawLines(const DrawRequest& request, const gl::Texture& depth) const {
  const gl::Api& api = tools_.api();
  const Grid& grid = request.snapshot.model.grid;
  useFaceProgram(program_, request, tools_, faces_);
  glm::dvec4 light(0.0);
  if (request.options.light) {
    light = {(*request.options.light - grid.toModel(tools_.mesh().center())) / grid.step, 1.0};
  }
  program_.set("light", glm::vec4(light));
  program_.set("freeNeighbours", static_cast<int>(kFreeNeighbours));
  program_.set("depthMap", 4);
  gl::bindTexture(api, 4, depth);
  if (!usesGeometryShader_) {
    gl::bindTexture(api, 1, edges_);
    quads_.draw(program_, count_);
    return;
  }
  api.bindVertexArray(triangles_.id());
  api.drawElements(GL_TRIANGLES_ADJACENCY, count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace limn
