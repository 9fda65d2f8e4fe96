// SPDX-License-Identifier: Apache-2.0
// Based on: M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 3.2.3
// (face numbers and normals rendered, Canny's detector as a shader). J. Canny, "A Computational
// Approach to Edge Detection", PAMI 8(6), 1986.
// Deviations: hysteresis is a fixed number of steps; the gathering of faces under edges is a pass,
// too, so that one picture is read back.
#include "client/render/image_seeds.h"

#include "client/render/shaders/canny_shaders.h"
#include "client/render/shaders/shaders.h"

#include "shared/silhouette/field.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace limn {

ImageSeeds::~ImageSeeds() {
  if (context_) (void)context_->makeCurrent();  // handles delete what they own
}

Result<ImageSeeds> ImageSeeds::create(GlBackend backend, const Options& options) {
  ImageSeeds seeds;
  seeds.options_ = options;
  auto context = createGlContext(backend);
  if (!context) return tl::unexpected(context.error());
  seeds.context_ = *std::move(context);
  seeds.api_ = &seeds.context_->api();
  if (auto ok = seeds.makePrograms(); !ok) return tl::unexpected(ok.error());
  if (auto ok = seeds.makeTargets(); !ok) return tl::unexpected(ok.error());
  seeds.corners_ = gl::VertexArray::create(*seeds.api_);
  seeds.screen_ = gl::VertexArray::create(*seeds.api_);
  seeds.cornerData_ = gl::Buffer::create(*seeds.api_);
  return seeds;
}

Result<void> ImageSeeds::makePrograms() {
  struct Wanted {
    gl::Program* program;
    const char* name;
    std::string_view vertex;
    std::string_view fragment;
  };

  const Wanted all[] = {
      {&faceProgram_, "face numbers", shaders::kSeedVertex, shaders::kFaceIdFragment},
      {&normalProgram_, "normals", shaders::kSeedVertex, shaders::kNormalFragment},
      {&gradientProgram_, "gradient", shaders::kScreenVertex, shaders::kGradientFragment},
      {&ridgeProgram_, "ridges", shaders::kScreenVertex, shaders::kRidgeFragment},
      {&hysteresisProgram_, "hysteresis", shaders::kScreenVertex, shaders::kHysteresisFragment},
      {&gatherProgram_,
       "faces under edges",
       shaders::kScreenVertex,
       shaders::kFacesUnderEdgesFragment}};
  for (const Wanted& wanted : all) {
    auto program = gl::Program::build(*api_, wanted.name, wanted.vertex, wanted.fragment);
    if (!program) return tl::unexpected(program.error());
    *wanted.program = *std::move(program);
  }
  return {};
}

Result<void> ImageSeeds::makeTargets() {
  const gl::TextureSize size{options_.viewport.width, options_.viewport.height};
  const gl::Target::Options picture{size, true, gl::TexelFormat::kRgba8, true};
  const gl::Target::Options bytes{size, true, gl::TexelFormat::kRgba8, false};
  const gl::Target::Options marks{size, true, gl::TexelFormat::kR8, false};
  const std::pair<gl::Target*, gl::Target::Options> all[] = {
      {&faces_, picture},
      {&normals_, picture},
      {&gradient_, bytes},
      {&edges_, marks},
      {&otherEdges_, marks},
      {&gathered_, bytes}};
  for (const auto& [target, options] : all) {
    auto made = gl::Target::create(*api_, "image seeds", options);
    if (!made) return tl::unexpected(made.error());
    *target = *std::move(made);
  }
  return {};
}

void ImageSeeds::upload(const MeshSnapshot& snapshot) {
  const HalfEdgeMesh& mesh = snapshot.mesh.mesh();
  if (hasMesh_ && asset_ == snapshot.model.asset && revision_ == snapshot.revision &&
      cornerCount_ == mesh.origins.size()) {
    return;
  }
  hasMesh_ = true;
  asset_ = snapshot.model.asset;
  revision_ = snapshot.revision;
  cornerCount_ = mesh.origins.size();
  // The field's vertex planes are the normals that smooth silhouettes are made of.
  const SilhouetteField field(mesh, snapshot.mesh.positions(), SilhouetteKind::kSmooth);
  center_ = field.center();
  std::vector<glm::vec3> data;
  data.reserve(2 * cornerCount_);
  for (const std::uint32_t v : mesh.origins) {
    data.emplace_back(snapshot.mesh.positions()[v] - center_);
    data.emplace_back(field.plane(v));
  }
  api_->bindVertexArray(corners_.id());
  api_->bindBuffer(GL_ARRAY_BUFFER, cornerData_.id());
  api_->bufferData(
      GL_ARRAY_BUFFER,
      static_cast<GLsizeiptr>(data.size() * sizeof(glm::vec3)),
      data.data(),
      GL_DYNAMIC_DRAW);
  for (const GLuint attribute : {0U, 1U}) {
    api_->enableVertexAttribArray(attribute);
    api_->vertexAttribPointer(
        attribute,
        3,
        GL_FLOAT,
        GL_FALSE,
        2 * sizeof(glm::vec3),
        reinterpret_cast<const void*>(attribute * sizeof(glm::vec3)));
  }
}

void ImageSeeds::drawMesh(
    const MeshSnapshot& snapshot,
    const Camera& camera,
    const gl::Program& program,
    const gl::Target& target) const {
  const Grid& grid = snapshot.model.grid;
  const glm::dmat4 clipFromWorld = camera.clipFromWorld(options_.viewport.aspect());
  glm::dmat4 clipFromCenter = clipFromWorld * grid.step;
  clipFromCenter[3] = clipFromWorld * glm::dvec4(grid.toModel(center_), 1.0);
  target.bind();
  api_->clearColor(0.0F, 0.0F, 0.0F, 0.0F);
  api_->clearDepthf(1.0F);
  api_->depthMask(GL_TRUE);
  api_->disable(GL_BLEND);
  api_->disable(GL_DITHER);
  api_->enable(GL_DEPTH_TEST);
  api_->depthFunc(GL_LESS);
  api_->clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  program.use();
  program.set("clipFromCenter", glm::mat4(clipFromCenter));
  program.set("viewFromWorld", glm::mat4(camera.viewFromWorld()));
  if (snapshot.model.closed) api_->enable(GL_CULL_FACE);
  api_->bindVertexArray(corners_.id());
  api_->drawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(cornerCount_));
  api_->disable(GL_CULL_FACE);
  api_->disable(GL_DEPTH_TEST);
}

void ImageSeeds::drawScreen(const gl::Target& target) const {
  target.bind();
  api_->bindVertexArray(screen_.id());
  api_->drawArrays(GL_TRIANGLES, 0, 3);
}

// From normals_ to edges_.
void ImageSeeds::findEdges() {
  gradientProgram_.use();
  gradientProgram_.set("image", 0);
  gl::bindTexture(*api_, 0, normals_.color());
  drawScreen(gradient_);
  ridgeProgram_.use();
  ridgeProgram_.set("gradient", 0);
  ridgeProgram_.set("low", options_.lowThreshold);
  ridgeProgram_.set("high", options_.highThreshold);
  gl::bindTexture(*api_, 0, gradient_.color());
  drawScreen(edges_);
  hysteresisProgram_.use();
  hysteresisProgram_.set("edges", 0);
  for (int step = 0; step < options_.hysteresisSteps; ++step) {
    gl::bindTexture(*api_, 0, edges_.color());
    drawScreen(otherEdges_);
    std::swap(edges_, otherEdges_);
  }
}

std::span<const FaceId> ImageSeeds::find(const MeshSnapshot& snapshot, const Camera& camera) {
  found_.clear();
  if (!context_->makeCurrent()) return found_;
  upload(snapshot);
  drawMesh(snapshot, camera, faceProgram_, faces_);
  drawMesh(snapshot, camera, normalProgram_, normals_);
  findEdges();
  gatherProgram_.use();
  gatherProgram_.set("edges", 0);
  gatherProgram_.set("faces", 1);
  gl::bindTexture(*api_, 0, edges_.color());
  gl::bindTexture(*api_, 1, faces_.color());
  drawScreen(gathered_);

  const std::vector<std::uint8_t> bytes = read(gathered_);
  isFound_.assign(snapshot.mesh.mesh().faceCount(), 0);
  for (std::size_t i = 0; i < bytes.size(); i += 4) {
    const std::uint32_t id = bytes[i] | bytes[i + 1] << 8 | bytes[i + 2] << 16 |
                             static_cast<std::uint32_t>(bytes[i + 3]) << 24;
    if (id == 0 || id > isFound_.size() || isFound_[id - 1] != 0) continue;
    isFound_[id - 1] = 1;
    found_.push_back(id - 1);
  }
  return found_;
}

std::vector<std::uint8_t> ImageSeeds::read(const gl::Target& target) const {
  const auto [width, height] = target.size();
  std::vector<std::uint8_t> bytes(
      4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  target.bind();
  api_->pixelStorei(GL_PACK_ALIGNMENT, 1);
  api_->readPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
  return bytes;
}

std::vector<std::uint8_t> ImageSeeds::normalImage() const {
  return read(normals_);
}

std::vector<std::uint8_t> ImageSeeds::edgeImage() const {
  const std::vector<std::uint8_t> rgba = read(edges_);
  std::vector<std::uint8_t> edges;
  for (std::size_t i = 0; i < rgba.size(); i += 4)
    edges.push_back(rgba[i] > 191 ? 255 : 0);
  return edges;
}

}  // namespace limn
