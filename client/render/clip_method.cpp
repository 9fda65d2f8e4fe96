// SPDX-License-Identifier: Apache-2.0
//
// Based on: P. Sander, X. Gu, S. Gortler, H. Hoppe, J. Snyder, "Silhouette clipping", SIGGRAPH
// 2000. Deviations: winding numbers count up and down in one pass (two-sided stencil); loops are
// spanned by halving (clip_contours.cpp); the outline's pixels are antialiased by area, as winding
// numbers are: an edge changes a pixel's mean by the area behind it, so that edges inside the
// outline, and any number of short ones in a pixel, come out right.
#include "client/render/clip_method.h"

#include "client/render/image_io.h"
#include "client/render/shaders/clip_shaders.h"
#include "client/render/shaders/shaders.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace limn {
namespace {

/// Winding number 0: in the middle, since numbers on the way may be negative.
constexpr int kStencilZero = 128;
/// Winding numbers that are told apart: where layers lie behind one another edges may take away
/// more than one of them.
constexpr int kLevels = 4;

struct HullCorner {
  glm::vec3 place{0.0F};  // grid units about origin_
  glm::vec2 inMap{0.0F};  // texels
};

template <class T>
void fill(const gl::Api& api, GLenum target, const gl::Buffer& buffer, const std::vector<T>& data) {
  api.bindBuffer(target, buffer.id());
  api.bufferData(
      target,
      static_cast<GLsizeiptr>(data.size() * sizeof(T)),
      data.data(),
      GL_DYNAMIC_DRAW);
}

}  // namespace

Result<std::unique_ptr<DrawingMethod>> ClipMethod::create(DrawTools& tools) {
  const gl::Api& api = tools.api();
  std::unique_ptr<ClipMethod> method(new ClipMethod(tools));
  const auto build = [&](gl::Program& program,
                         std::string_view name,
                         std::string_view vertex,
                         std::string_view fragment) -> Result<void> {
    auto made = gl::Program::build(api, name, vertex, fragment);
    if (!made) return tl::unexpected(made.error());
    program = *std::move(made);
    return {};
  };
  namespace s = shaders;
  auto ok =
      build(method->stencilProgram_, "clip stencil", s::kClipStencilVertex, s::kDepthFragment);
  if (ok) ok = build(method->levelProgram_, "clip level", s::kScreenVertex, s::kLevelFragment);
  if (ok) ok = build(method->edgeProgram_, "clip edge", s::kClipEdgeVertex, s::kClipEdgeFragment);
  if (ok) ok = build(method->hullProgram_, "hull", s::kMeshVertex, s::kShadedFragment);
  if (ok) ok = build(method->mappedProgram_, "mapped hull", s::kHullVertex, s::kMappedFragment);
  if (ok) ok = build(method->composeProgram_, "clip", s::kScreenVertex, s::kClipFragment);
  if (!ok) return tl::unexpected(ok.error());
  for (gl::VertexArray* array : {&method->contourArray_, &method->edgeArray_, &method->hullArray_})
    *array = gl::VertexArray::create(api);
  for (gl::Buffer* buffer :
       {&method->contourPoints_, &method->contourIndices_, &method->hullPoints_})
    *buffer = gl::Buffer::create(api);

  api.bindVertexArray(method->contourArray_.id());
  api.bindBuffer(GL_ARRAY_BUFFER, method->contourPoints_.id());
  api.bindBuffer(GL_ELEMENT_ARRAY_BUFFER, method->contourIndices_.id());
  api.enableVertexAttribArray(0);
  api.vertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
  // An edge an instance: a point and the one after it.
  api.bindVertexArray(method->edgeArray_.id());
  for (GLuint i = 0; i < 2; ++i) {
    api.enableVertexAttribArray(i);
    api.vertexAttribPointer(
        i,
        3,
        GL_FLOAT,
        GL_FALSE,
        sizeof(glm::vec3),
        reinterpret_cast<const void*>(i * sizeof(glm::vec3)));
    api.vertexAttribDivisor(i, 1);
  }
  api.bindVertexArray(method->hullArray_.id());
  api.bindBuffer(GL_ARRAY_BUFFER, method->hullPoints_.id());
  api.enableVertexAttribArray(0);
  api.vertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(HullCorner), nullptr);
  api.enableVertexAttribArray(1);
  api.vertexAttribPointer(
      1,
      2,
      GL_FLOAT,
      GL_FALSE,
      sizeof(HullCorner),
      reinterpret_cast<const void*>(offsetof(HullCorner, inMap)));
  api.getIntegerv(GL_SUBPIXEL_BITS, &method->subpixelBits_);
  method->subpixelBits_ = std::clamp(method->subpixelBits_, 4, 8);
  return method;
}

Result<void> ClipMethod::uploadHull(const DrawRequest& request) {
  const auto& hull = request.snapshot.outerHull;
  if (!hull) return fail(ErrorCode::kUnavailable, "the hull has not arrived: allow more");
  const std::size_t splits = hull->splitsFor(request.options.hullFaces);
  if (hull_ == hull && hullSplits_ == splits) return {};
  const auto level = hullAfter(*hull, splits);
  if (!level) return tl::unexpected(level.error());
  hull_ = hull;
  hullSplits_ = splits;
  const Grid& model = request.snapshot.model.grid;
  origin_ = model.fromModel(request.snapshot.model.sphere.center);
  hullModelPoints_.clear();
  for (const glm::ivec3& p : level->positions)
    hullModelPoints_.push_back(level->grid.toModel(p));
  const auto faces = static_cast<std::uint32_t>(level->triangles.size());
  const MapLayout layout = request.snapshot.model.maps.value_or(MapLayout{});
  std::vector<HullCorner> corners;
  corners.reserve(3 * std::size_t{faces});
  for (std::uint32_t f = 0; f < faces; ++f) {
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3& place = hullModelPoints_[level->triangles[f][k]];
      const glm::vec2 inMap = layout.faces == faces ? layout.corner(f, k) : glm::vec2(0.0F);
      corners.push_back({glm::vec3(model.fromModel(place) - origin_), inMap});
    }
  }
  hullCorners_ = static_cast<GLsizei>(corners.size());
  tools_.api().bindVertexArray(hullArray_.id());
  fill(tools_.api(), GL_ARRAY_BUFFER, hullPoints_, corners);
  return {};
}

Result<void> ClipMethod::uploadMap(const DrawRequest& request) {
  const auto& map = request.snapshot.normalMap;
  if (map == mapThere_) return {};
  mapThere_ = nullptr;
  map_ = {};
  if (!map) return {};
  const int width = map->layout.width();
  const int height = map->layout.height();
  const auto image = decodePng(map->png, width, height);
  if (!image) return tl::unexpected(image.error());
  const gl::Api& api = tools_.api();
  map_ = gl::makeTexture(api, gl::TexelFormat::kRgba8, {width, height});
  gl::bindTexture(api, 0, map_);
  api.pixelStorei(GL_UNPACK_ALIGNMENT, 1);
  api.texSubImage2D(
      GL_TEXTURE_2D,
      0,
      0,
      0,
      width,
      height,
      GL_RGBA,
      GL_UNSIGNED_BYTE,
      image->rgba.data());
  api.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  api.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  mapThere_ = map;
  return {};
}

/// The camera with its depth range about the hull, which is larger than the model.
Camera ClipMethod::fitted(const Camera& camera) const {
  Camera result = camera;
  const glm::dvec3 forward = camera.forward();
  double least = 1e300;
  double most = -1e300;
  for (const glm::dvec3& p : hullModelPoints_) {
    const double depth = glm::dot(p - camera.eye, forward);
    least = std::min(least, depth);
    most = std::max(most, depth);
  }
  const double slack = 0.01 * (most - least) + 1e-9 * std::abs(most);
  result.nearPlane = least - slack;
  result.farPlane = most + slack;
  if (!camera.orthographic) {
    result.farPlane = std::max(result.farPlane, 1e-6 * glm::distance(camera.eye, camera.target));
    result.nearPlane = std::max(result.nearPlane, 1e-4 * result.farPlane);
  }
  return result;
}

Result<void> ClipMethod::drawMesh(const DrawRequest& request, const gl::Target& picture) {
  const gl::Target::Options options{.size = request.fineSize(), .hasDepth = true};
  if (auto ok = tools_.fit(fine_, "the supersampled picture", options); !ok) return ok;
  tools_.mesh().drawShaded(request.snapshot, request.camera, fine_, {.background = request.paper});
  tools_.reduce(fine_.color(), request.supersample, picture);
  return {};
}

void ClipMethod::drawWinding(const ClipContours& contours) const {
  const gl::Api& api = tools_.api();
  winding_.bind();
  api.clearColor(0.0F, 0.0F, 0.0F, 0.0F);
  api.clearStencil(kStencilZero);
  api.clear(GL_COLOR_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  stencilProgram_.use();
  stencilProgram_.set("size", glm::vec2(winding_.size().width, winding_.size().height));
  api.enable(GL_STENCIL_TEST);
  api.stencilFunc(GL_ALWAYS, 0, 0xFF);
  api.stencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_INCR_WRAP);
  api.stencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_DECR_WRAP);
  api.colorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  api.bindVertexArray(contourArray_.id());
  api.drawElements(
      GL_TRIANGLES,
      static_cast<GLsizei>(contours.triangles.size()),
      GL_UNSIGNED_INT,
      nullptr);
  api.colorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  // Stencil values cannot be sampled in GLES 3.0: a few levels of them, as colour.
  api.stencilOpSeparate(GL_FRONT_AND_BACK, GL_KEEP, GL_KEEP, GL_KEEP);
  levelProgram_.use();
  for (int level = 1; level <= kLevels; ++level) {
    api.stencilFunc(GL_LEQUAL, kStencilZero + level, 0xFF);
    levelProgram_.set("level", static_cast<float>(level) / kLevels);
    tools_.drawScreen();
  }
  api.disable(GL_STENCIL_TEST);
}

void ClipMethod::drawChange(const ClipContours& contours) const {
  const gl::Api& api = tools_.api();
  change_.bind();
  api.clearColor(0.0F, 0.0F, 0.0F, 0.0F);
  api.clear(GL_COLOR_BUFFER_BIT);
  if (contours.points.empty()) return;
  edgeProgram_.use();
  edgeProgram_.set("size", glm::vec2(change_.size().width, change_.size().height));
  api.enable(GL_BLEND);
  api.blendEquation(GL_FUNC_ADD);
  api.blendFunc(GL_ONE, GL_ONE);
  api.bindVertexArray(edgeArray_.id());
  api.drawArraysInstanced(
      GL_TRIANGLE_STRIP,
      0,
      4,
      static_cast<GLsizei>(contours.points.size() - 1));
  api.disable(GL_BLEND);
}

void ClipMethod::drawHull(const DrawRequest& request, const glm::mat4& clipFromCenter) const {
  const gl::Api& api = tools_.api();
  // A map belongs to one level.
  const bool isMapped =
      mapThere_ && 3 * mapThere_->layout.faces == static_cast<std::uint32_t>(hullCorners_);
  const gl::Program& program = isMapped ? mappedProgram_ : hullProgram_;
  program.use();
  program.set("clipFromCenter", clipFromCenter);
  program.set("light", glm::vec4(MeshPass::lightOf(request.camera), 0.0F));
  program.set("surface", MeshPass::kSurface);
  program.set("normals", 0);
  if (isMapped) gl::bindTexture(api, 0, map_);
  api.enable(GL_DEPTH_TEST);
  api.depthFunc(GL_LESS);
  api.enable(GL_CULL_FACE);
  api.bindVertexArray(hullArray_.id());
  api.drawArrays(GL_TRIANGLES, 0, hullCorners_);
  api.disable(GL_CULL_FACE);
  api.disable(GL_DEPTH_TEST);
}

Result<void>
ClipMethod::draw(const DrawRequest& request, const gl::Target& picture, FrameTimings&) {
  if (auto ok = uploadHull(request); !ok) return ok;
  if (auto ok = uploadMap(request); !ok) return ok;
  const Camera& from = request.camera;
  if (!from.orthographic && !isOutsideConvexHull(from.eye, hullModelPoints_))
    return drawMesh(request, picture);
  const Grid& grid = request.snapshot.model.grid;
  const Camera camera = fitted(from);
  const glm::dmat4 clipFromWorld = camera.clipFromWorld(request.options.viewport.aspect());
  const auto clipFrom = [&](const glm::dvec3& place) {
    glm::dmat4 matrix = clipFromWorld * grid.step;
    matrix[3] = clipFromWorld * glm::dvec4(place, 1.0);
    return matrix;
  };
  const ClipScreen screen{clipFrom(grid.origin), request.options.viewport, subpixelBits_};
  const auto& exact = request.snapshot.contour;
  const auto contours =
      exact ? clipContoursOf(exact->lines, screen) : clipContoursOf(request.lines, screen);
  if (!contours) return drawMesh(request, picture);

  const gl::TextureSize size{request.options.viewport.width, request.options.viewport.height};
  using gl::TexelFormat;
  const gl::Target::Options winding{.size = size, .color = TexelFormat::kR8, .hasStencil = true};
  const gl::Target::Options change{.size = size, .color = TexelFormat::kRgb10A2};
  const gl::Target::Options surface{.size = size, .hasDepth = true};
  auto ok = tools_.fit(winding_, "the winding numbers", winding);
  if (ok) ok = tools_.fit(change_, "the outline's coverage", change);
  if (ok) ok = tools_.fit(surface_, "the lit hull", surface);
  if (!ok) return ok;

  const gl::Api& api = tools_.api();
  api.bindVertexArray(contourArray_.id());
  fill(api, GL_ARRAY_BUFFER, contourPoints_, contours->points);
  fill(api, GL_ELEMENT_ARRAY_BUFFER, contourIndices_, contours->triangles);
  drawWinding(*contours);
  drawChange(*contours);

  surface_.bind();
  api.clearColor(0.0F, 0.0F, 0.0F, 0.0F);
  api.clearDepthf(1.0F);
  api.clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  drawHull(request, glm::mat4(clipFrom(request.snapshot.model.sphere.center)));

  picture.bind();
  composeProgram_.use();
  composeProgram_.set("winding", 0);
  composeProgram_.set("change", 1);
  composeProgram_.set("surface", 2);
  composeProgram_.set("paper", request.paper);
  gl::bindTexture(api, 0, winding_.color());
  gl::bindTexture(api, 1, change_.color());
  gl::bindTexture(api, 2, surface_.color());
  tools_.drawScreen();
  return {};
}

}  // namespace limn
