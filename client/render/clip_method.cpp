// SPDX-License-Identifier: Apache-2.0
//
// Based on: P. Sander, X. Gu, S. Gortler, H. Hoppe, J. Snyder, "Silhouette clipping", SIGGRAPH
// 2000. Deviations: winding numbers count up and down in one pass (two-sided stencil); loops are
// spanned by halving (clip_contours.cpp); instead of antialiased lines, the outline's pixels get
// the share of them that contours wind around (contour_coverage.cpp), and the paper over their
// rest.
#include "client/render/clip_method.h"

#include "client/render/image_io.h"
#include "client/render/shaders/clip_shaders.h"
#include "client/render/shaders/shaders.h"

#include "shared/progressive/map_normal.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <span>
#include <utility>

namespace limn {
namespace {

/// Winding number 0: in the middle, since numbers on the way may be negative.
constexpr int kStencilZero = 128;
/// Stencil value of pixels that the outline covers partly.
constexpr int kPartly = 255;
/// Of the fringe: itself and a pixel further to each side.
constexpr GLsizei kFringes = 5;

struct HullCorner {
  glm::vec3 place{0.0F};   // grid units about origin_
  glm::vec3 normal{0.0F};  // the face's, unit
  glm::vec3 along{0.0F};   // its first edge, unit: with the normal mapFrame
  glm::vec2 inMap{0.0F};   // texels
};

/// Of an edge of a face.
struct FringeCorner {
  HullCorner corner;
  glm::vec3 normalAcross{0.0F};  // of the face beyond the edge
};

template <class T>
void fill(const gl::Api& api, GLenum target, const gl::Buffer& buffer, std::span<const T> data) {
  api.bindBuffer(target, buffer.id());
  api.bufferData(target, static_cast<GLsizeiptr>(data.size_bytes()), data.data(), GL_DYNAMIC_DRAW);
}

double millisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

}  // namespace

Result<std::unique_ptr<DrawingMethod>> ClipMethod::create(DrawTools& tools) {
  auto method = make(tools);
  if (!method) return tl::unexpected(method.error());
  return std::unique_ptr<DrawingMethod>(*std::move(method));
}

Result<std::unique_ptr<ClipMethod>> ClipMethod::make(DrawTools& tools) {
  const gl::Api& api = tools.api();
  auto method = std::make_unique<ClipMethod>(tools);
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
  if (ok)
    ok = build(method->pixelProgram_, "clip pixel", s::kClipPixelVertex, s::kClipPixelFragment);
  if (ok) ok = build(method->hullProgram_, "hull", s::kHullVertex, s::kHullFragment);
  if (!ok) return tl::unexpected(ok.error());
  for (gl::VertexArray* array :
       {&method->contourArray_, &method->pixelArray_, &method->hullArray_, &method->fringeArray_})
    *array = gl::VertexArray::create(api);
  for (gl::Buffer* buffer :
       {&method->contourPoints_,
        &method->contourIndices_,
        &method->pixels_,
        &method->hullPoints_,
        &method->fringePoints_})
    *buffer = gl::Buffer::create(api);

  api.bindVertexArray(method->contourArray_.id());
  api.bindBuffer(GL_ARRAY_BUFFER, method->contourPoints_.id());
  api.bindBuffer(GL_ELEMENT_ARRAY_BUFFER, method->contourIndices_.id());
  api.enableVertexAttribArray(0);
  api.vertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
  api.bindVertexArray(method->pixelArray_.id());
  api.bindBuffer(GL_ARRAY_BUFFER, method->pixels_.id());
  api.enableVertexAttribArray(0);
  api.vertexAttribPointer(
      0,
      2,
      GL_UNSIGNED_SHORT,
      GL_FALSE,
      sizeof(CoveredPixel),
      reinterpret_cast<const void*>(offsetof(CoveredPixel, x)));
  api.enableVertexAttribArray(1);
  api.vertexAttribPointer(
      1,
      1,
      GL_UNSIGNED_BYTE,
      GL_TRUE,
      sizeof(CoveredPixel),
      reinterpret_cast<const void*>(offsetof(CoveredPixel, coverage)));
  const auto attribute =
      [&](GLuint location, GLint components, std::size_t offset, std::size_t stride) {
        api.enableVertexAttribArray(location);
        api.vertexAttribPointer(
            location,
            components,
            GL_FLOAT,
            GL_FALSE,
            static_cast<GLsizei>(stride),
            reinterpret_cast<const void*>(offset));
      };
  const auto hullAttributes = [&](std::size_t stride) {
    attribute(0, 3, offsetof(HullCorner, place), stride);
    attribute(1, 3, offsetof(HullCorner, normal), stride);
    attribute(2, 3, offsetof(HullCorner, along), stride);
    attribute(3, 2, offsetof(HullCorner, inMap), stride);
  };
  api.bindVertexArray(method->hullArray_.id());
  api.bindBuffer(GL_ARRAY_BUFFER, method->hullPoints_.id());
  hullAttributes(sizeof(HullCorner));
  api.bindVertexArray(method->fringeArray_.id());
  api.bindBuffer(GL_ARRAY_BUFFER, method->fringePoints_.id());
  hullAttributes(sizeof(FringeCorner));
  attribute(4, 3, offsetof(FringeCorner, normalAcross), sizeof(FringeCorner));
  api.getIntegerv(GL_SUBPIXEL_BITS, &method->subpixelBits_);
  method->subpixelBits_ = std::clamp(method->subpixelBits_, 4, 8);
  return method;
}

Result<void> ClipMethod::uploadHull(const DrawRequest& request) {
  const auto& hull = request.snapshot.outerHull;
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
    const glm::uvec3& t = level->triangles[f];
    const glm::dmat3 frame =
        mapFrame(hullModelPoints_[t.x], hullModelPoints_[t.y], hullModelPoints_[t.z]);
    for (int k = 0; k < 3; ++k) {
      corners.push_back(
          {glm::vec3(model.fromModel(hullModelPoints_[t[k]]) - origin_),
           glm::vec3(frame[2]),
           glm::vec3(frame[0]),
           layout.faces == faces ? layout.corner(f, k) : glm::vec2(0.0F)});
    }
  }
  const auto links =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(level->positions.size()), level->triangles);
  if (!links) return tl::unexpected(links.error());
  std::vector<FringeCorner> fringe;
  fringe.reserve(2 * corners.size());
  for (HalfEdgeId h = 0; h < corners.size(); ++h) {
    const HalfEdgeId twin = links->twin(h);
    const glm::vec3 across = twin == kNone ? glm::vec3(0.0F) : corners[twin].normal;
    fringe.push_back({corners[h], across});
    fringe.push_back({corners[HalfEdgeMesh::next(h)], across});
  }
  hullCorners_ = static_cast<GLsizei>(corners.size());
  fringeCorners_ = static_cast<GLsizei>(fringe.size());
  const gl::Api& api = tools_.api();
  fill(api, GL_ARRAY_BUFFER, hullPoints_, std::span<const HullCorner>(corners));
  fill(api, GL_ARRAY_BUFFER, fringePoints_, std::span<const FringeCorner>(fringe));
  return {};
}

Result<void> ClipMethod::uploadMap(
    const std::shared_ptr<const HullMap>& map,
    int channels,
    MapTexture& there) const {
  if (map == there.map) return {};
  there = {};
  if (!map) return {};
  const int width = map->layout.width();
  const int height = map->layout.height();
  const auto image = decodePng(map->png, {width, height, channels});
  if (!image) return tl::unexpected(image.error());
  const gl::Api& api = tools_.api();
  there.texture = gl::makeTexture(api, gl::TexelFormat::kRgba8, {width, height});
  gl::bindTexture(api, 0, there.texture);
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
  there.map = map;
  return {};
}

/// Whether a map is there and of the hull's level, to which alone it belongs.
bool ClipMethod::fits(const MapTexture& map) const {
  return map.map && 3 * map.map->layout.faces == static_cast<std::uint32_t>(hullCorners_);
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

/// Where winding numbers say nothing, or the hull has not come, or there is none.
Result<void> ClipMethod::drawMesh(const DrawRequest& request, const gl::Target& picture) {
  const gl::Target::Options options{.size = request.fineSize(), .hasDepth = true};
  if (auto ok = tools_.fit(fine_, "the supersampled picture", options); !ok) return ok;
  tools_.mesh().drawShaded(request.snapshot, request.camera, fine_, {.background = request.paper});
  tools_.reduce(fine_.color(), request.supersample, picture);
  return {};
}

void ClipMethod::setStencil(const ClipContours& contours) const {
  const gl::Api& api = tools_.api();
  api.bindVertexArray(contourArray_.id());
  fill(api, GL_ARRAY_BUFFER, contourPoints_, std::span(contours.points));
  fill(api, GL_ELEMENT_ARRAY_BUFFER, contourIndices_, std::span(contours.triangles));
  api.stencilFunc(GL_ALWAYS, 0, 0xFF);
  api.stencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_INCR_WRAP);
  api.stencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_DECR_WRAP);
  api.drawElements(
      GL_TRIANGLES,
      static_cast<GLsizei>(contours.triangles.size()),
      GL_UNSIGNED_INT,
      nullptr);
}

void ClipMethod::drawPixels(GLsizei count) const {
  const gl::Api& api = tools_.api();
  api.bindVertexArray(pixelArray_.id());
  api.drawArrays(GL_POINTS, 0, count);
}

/// The hull where the stencil is positive, and where it is partly but no hull is, as its
/// neighbours.
void ClipMethod::drawHull(
    const DrawRequest& request,
    const glm::mat4& clipFromCenter,
    const gl::Target& picture) const {
  const gl::Api& api = tools_.api();
  const Camera& camera = request.camera;
  const glm::dvec3 eye = request.snapshot.model.grid.fromModel(camera.eye) - origin_;
  hullProgram_.use();
  hullProgram_.set("clipFromCenter", clipFromCenter);
  hullProgram_.set(
      "eye",
      camera.orthographic ? glm::vec4(-camera.forward(), 0.0F) : glm::vec4(eye, 1.0F));
  hullProgram_.set("size", glm::vec2(picture.size().width, picture.size().height));
  hullProgram_.set("light", glm::vec4(MeshPass::lightOf(camera), 0.0F));
  hullProgram_.set("surface", MeshPass::kSurface);
  hullProgram_.set("normals", 0);
  hullProgram_.set("colors", 1);
  hullProgram_.set("mapped", fits(normals_) ? 1.0F : 0.0F);
  hullProgram_.set("painted", fits(colors_) ? 1.0F : 0.0F);
  if (fits(normals_)) gl::bindTexture(api, 0, normals_.texture);
  if (fits(colors_)) gl::bindTexture(api, 1, colors_.texture);
  api.enable(GL_DEPTH_TEST);
  api.depthFunc(GL_LESS);
  api.enable(GL_CULL_FACE);
  api.bindVertexArray(hullArray_.id());
  hullProgram_.set("fringe", 0.0F);
  api.stencilFunc(GL_LESS, kStencilZero, 0xFF);
  api.drawArrays(GL_TRIANGLES, 0, hullCorners_);
  hullProgram_.set("fringe", 1.0F);
  api.stencilFunc(GL_EQUAL, kPartly, 0xFF);
  api.bindVertexArray(fringeArray_.id());
  api.drawArraysInstanced(GL_LINES, 0, fringeCorners_, kFringes);
  api.disable(GL_CULL_FACE);
  api.disable(GL_DEPTH_TEST);
}

Result<void>
ClipMethod::draw(const DrawRequest& request, const gl::Target& picture, FrameTimings& timings) {
  const auto isDrawn = drawClipped(request, Behind::kPaper, picture, timings);
  if (!isDrawn) return tl::unexpected(isDrawn.error());
  return *isDrawn ? Result<void>() : drawMesh(request, picture);
}

Result<bool> ClipMethod::drawClipped(
    const DrawRequest& request,
    Behind behind,
    const gl::Target& picture,
    FrameTimings& timings) {
  const auto failed = [](const Result<void>& result) { return tl::unexpected(result.error()); };
  if (!request.snapshot.outerHull) return false;
  if (auto ok = uploadHull(request); !ok) return failed(ok);
  if (auto ok = uploadMap(request.snapshot.normalMap, 2, normals_); !ok) return failed(ok);
  if (auto ok = uploadMap(request.snapshot.colorMap, 3, colors_); !ok) return failed(ok);
  const Camera& from = request.camera;
  if (!from.orthographic && !isOutsideConvexHull(from.eye, hullModelPoints_)) return false;
  const Grid& grid = request.snapshot.model.grid;
  const Camera camera = fitted(from);
  const glm::dmat4 clipFromWorld = camera.clipFromWorld(request.options.viewport.aspect());
  const auto clipFrom = [&](const glm::dvec3& place) {
    glm::dmat4 matrix = clipFromWorld * grid.step;
    matrix[3] = clipFromWorld * glm::dvec4(place, 1.0);
    return matrix;
  };
  auto start = std::chrono::steady_clock::now();
  const ClipScreen screen{clipFrom(grid.origin), request.options.viewport, subpixelBits_};
  const auto& exact = request.snapshot.contour;
  const auto contours =
      exact ? clipContoursOf(exact->lines, screen) : clipContoursOf(request.lines, screen);
  if (!contours) return false;
  const auto partly = coverage_.find(*contours, request.options.viewport);
  timings.strokeMs += millisecondsSince(start);

  start = std::chrono::steady_clock::now();
  const gl::Api& api = tools_.api();
  const bool isPaper = behind == Behind::kPaper;
  const glm::vec2 size(picture.size().width, picture.size().height);
  const auto pixelCount = static_cast<GLsizei>(partly.size());
  pixelProgram_.use();
  pixelProgram_.set("size", size);
  pixelProgram_.set("paper", request.paper);
  pixelProgram_.set("picture", 0);
  pixelProgram_.set("isPaper", isPaper ? 1.0F : 0.0F);
  api.bindVertexArray(pixelArray_.id());
  fill(api, GL_ARRAY_BUFFER, pixels_, partly);
  if (!isPaper) {
    const gl::Target::Options options{.size = picture.size(), .color = gl::TexelFormat::kRgba8};
    if (auto ok = tools_.fit(behind_, "what is behind a model", options); !ok) return failed(ok);
    behind_.bind();
    gl::bindTexture(api, 0, picture.color());
    drawPixels(pixelCount);
    gl::bindTexture(api, 0, behind_.color());
  }
  picture.bind();
  api.clearColor(request.paper.x, request.paper.y, request.paper.z, 1.0F);
  api.clearDepthf(1.0F);
  api.clearStencil(kStencilZero);
  api.clear(
      (isPaper ? GL_COLOR_BUFFER_BIT : 0U) | static_cast<GLbitfield>(GL_DEPTH_BUFFER_BIT) |
      static_cast<GLbitfield>(GL_STENCIL_BUFFER_BIT));
  api.enable(GL_STENCIL_TEST);
  api.colorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  stencilProgram_.use();
  stencilProgram_.set("size", size);
  setStencil(*contours);
  pixelProgram_.use();
  api.stencilFunc(GL_ALWAYS, kPartly, 0xFF);
  api.stencilOpSeparate(GL_FRONT_AND_BACK, GL_KEEP, GL_KEEP, GL_REPLACE);
  drawPixels(pixelCount);
  api.finish();
  timings.visibilityMs += millisecondsSince(start);

  api.colorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  api.stencilOpSeparate(GL_FRONT_AND_BACK, GL_KEEP, GL_KEEP, GL_KEEP);
  drawHull(request, glm::mat4(clipFrom(request.snapshot.model.sphere.center)), picture);
  api.disable(GL_STENCIL_TEST);
  pixelProgram_.use();
  if (!isPaper) gl::bindTexture(api, 0, behind_.color());
  api.colorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
  api.enable(GL_BLEND);
  api.blendEquation(GL_FUNC_ADD);
  api.blendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  drawPixels(pixelCount);
  api.disable(GL_BLEND);
  api.colorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  return true;
}

}  // namespace limn
