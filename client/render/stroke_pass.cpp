// SPDX-License-Identifier: Apache-2.0
// Based on: P. Mohr (thesis), 2013, §3.4 for the depth texture and its 8-neighbourhood; F. Cole and
// A. Finkelstein, "Fast High-Quality Line Visibility", I3D 2009, for an atlas with one texel a
// sample of every line, so that visibility can be filtered along lines before it is used.
#include "client/render/stroke_pass.h"

#include "client/render/shaders/halo_shaders.h"
#include "client/render/shaders/shaders.h"
#include "client/stroke/line_density.h"
#include "client/stroke/line_halo.h"
#include "client/stroke/visibility/visibility.h"

#include <algorithm>
#include <cstddef>

namespace limn {
namespace {

const void* offset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);
}

}  // namespace

Result<StrokePass> StrokePass::create(const gl::Api& api) {
  StrokePass pass;
  pass.api_ = &api;
  auto test = gl::Program::build(
      api,
      "line visibility",
      shaders::kScreenVertex,
      shaders::kVisibilityFragment);
  if (!test) return tl::unexpected(test.error());
  auto vote =
      gl::Program::build(api, "visibility votes", shaders::kScreenVertex, shaders::kVoteFragment);
  if (!vote) return tl::unexpected(vote.error());
  auto drawn =
      gl::Program::build(api, "drawn samples", shaders::kScreenVertex, shaders::kDrawnFragment);
  if (!drawn) return tl::unexpected(drawn.error());
  auto shape =
      gl::Program::build(api, "visible runs", shaders::kScreenVertex, shaders::kShapeFragment);
  if (!shape) return tl::unexpected(shape.error());
  auto haloMark =
      gl::Program::build(api, "halo marks", shaders::kHaloMarkVertex, shaders::kHaloMarkFragment);
  if (!haloMark) return tl::unexpected(haloMark.error());
  auto halo = gl::Program::build(api, "halos", shaders::kScreenVertex, shaders::kHaloFragment);
  if (!halo) return tl::unexpected(halo.error());
  auto density =
      gl::Program::build(api, "density", shaders::kDensityVertex, shaders::kDensityFragment);
  if (!density) return tl::unexpected(density.error());
  auto stroke =
      gl::Program::build(api, "strokes", shaders::kStrokeVertex, shaders::kStrokeFragment);
  if (!stroke) return tl::unexpected(stroke.error());
  pass.testProgram_ = *std::move(test);
  pass.voteProgram_ = *std::move(vote);
  pass.drawnProgram_ = *std::move(drawn);
  pass.shapeProgram_ = *std::move(shape);
  pass.haloMarkProgram_ = *std::move(haloMark);
  pass.haloProgram_ = *std::move(halo);
  pass.densityProgram_ = *std::move(density);
  pass.strokeProgram_ = *std::move(stroke);
  pass.noAttributes_ = gl::VertexArray::create(api);
  pass.strokeArray_ = gl::VertexArray::create(api);
  pass.vertices_ = gl::Buffer::create(api);
  pass.indices_ = gl::Buffer::create(api);
  api.bindVertexArray(pass.strokeArray_.id());
  api.bindBuffer(GL_ARRAY_BUFFER, pass.vertices_.id());
  api.bindBuffer(GL_ELEMENT_ARRAY_BUFFER, pass.indices_.id());
  const auto attribute = [&api](GLuint index, GLint size, std::size_t at) {
    api.enableVertexAttribArray(index);
    api.vertexAttribPointer(index, size, GL_FLOAT, GL_FALSE, sizeof(StrokeVertex), offset(at));
  };
  attribute(0, 2, offsetof(StrokeVertex, position));
  attribute(1, 2, offsetof(StrokeVertex, across));
  attribute(2, 2, offsetof(StrokeVertex, visibleU));
  attribute(3, 2, offsetof(StrokeVertex, visibleFade));
  attribute(4, 1, offsetof(StrokeVertex, margin));
  return pass;
}

Result<void>
StrokePass::findVisibility(const SpineSamples& samples, const gl::Texture& depth, int closedGap) {
  const std::size_t count = samples.samples.size();
  const int rows = std::max(1, static_cast<int>((count + kAtlasWidth - 1) / kAtlasWidth));
  if (rows > rows_) {
    int grown = 32;
    while (grown < rows)
      grown *= 2;
    sampleTexture_ =
        gl::makeTexture(*api_, gl::TexelFormat::kRgba32f, {kTexels * kAtlasWidth, grown});
    const gl::Target::Options atlas{
        .size = {kAtlasWidth, grown},
        .hasColor = true,
        .color = gl::TexelFormat::kRg8};
    for (gl::Target* target : {&shaped_, &spare_}) {
      auto created = gl::Target::create(*api_, "the visibility atlas", atlas);
      if (!created) return tl::unexpected(created.error());
      *target = *std::move(created);
    }
    rows_ = grown;
  }
  // Whole rows first, then what is left of the last one.
  api_->activeTexture(GL_TEXTURE0);
  api_->bindTexture(GL_TEXTURE_2D, sampleTexture_.id());
  api_->pixelStorei(GL_UNPACK_ALIGNMENT, 4);
  const int whole = static_cast<int>(count / kAtlasWidth);
  const int rest = static_cast<int>(count % kAtlasWidth);
  const SpineSample* data = samples.samples.data();
  if (whole > 0) {
    api_->texSubImage2D(
        GL_TEXTURE_2D,
        0,
        0,
        0,
        kTexels * kAtlasWidth,
        whole,
        GL_RGBA,
        GL_FLOAT,
        data);
  }
  if (rest > 0) {
    api_->texSubImage2D(
        GL_TEXTURE_2D,
        0,
        0,
        whole,
        kTexels * rest,
        1,
        GL_RGBA,
        GL_FLOAT,
        data + static_cast<std::size_t>(whole) * kAtlasWidth);
  }
  api_->disable(GL_BLEND);
  api_->bindVertexArray(noAttributes_.id());

  gl::bindTexture(*api_, 0, sampleTexture_);
  const auto fill = [&](const gl::Target& target) {
    target.bind();
    api_->viewport(0, 0, kAtlasWidth, rows);
    api_->drawArrays(GL_TRIANGLES, 0, 3);
  };
  testProgram_.use();
  testProgram_.set("samples", 0);
  testProgram_.set("depthMap", 1);
  testProgram_.set("farther", samples.farther);
  gl::bindTexture(*api_, 1, depth);
  fill(spare_);

  voteProgram_.use();
  voteProgram_.set("samples", 0);
  voteProgram_.set("tested", 1);
  voteProgram_.set("radius", kVoteRadius);
  gl::bindTexture(*api_, 1, spare_.color());
  fill(shaped_);

  drawnProgram_.use();
  drawnProgram_.set("samples", 0);
  drawnProgram_.set("voted", 1);
  gl::bindTexture(*api_, 1, shaped_.color());
  fill(spare_);

  shapeProgram_.use();
  shapeProgram_.set("samples", 0);
  shapeProgram_.set("drawn", 1);
  shapeProgram_.set("ramp", static_cast<int>(kRampSamples));
  shapeProgram_.set("closedGap", closedGap);
  shapeProgram_.set("shortRun", kShortRun);
  gl::bindTexture(*api_, 1, spare_.color());
  fill(shaped_);
  return {};
}

Result<void> StrokePass::findHalo(const SpineSamples& samples, const DrawOptions& options) {
  if (options.hidden != Hidden::kStyle || samples.samples.empty()) return {};
  const float cellPx = haloCellPx(options.widthPx);
  const gl::TextureSize cells{
      haloCells(options.viewport.width, cellPx),
      haloCells(options.viewport.height, cellPx)};
  if (halo_.size() != cells) {
    auto map = gl::Target::create(
        *api_,
        "the halos of lines",
        {.size = cells, .hasColor = true, .color = gl::TexelFormat::kR8});
    if (!map) return tl::unexpected(map.error());
    halo_ = *std::move(map);
  }
  halo_.bind();
  api_->clearColor(0.0F, 0.0F, 0.0F, 0.0F);
  api_->clear(GL_COLOR_BUFFER_BIT);
  api_->disable(GL_BLEND);
  api_->bindVertexArray(noAttributes_.id());
  const glm::vec2 cellsInPicture =
      glm::vec2(options.viewport.width, options.viewport.height) / cellPx;
  gl::bindTexture(*api_, 0, sampleTexture_);
  gl::bindTexture(*api_, 1, shaped_.color());
  haloMarkProgram_.use();
  haloMarkProgram_.set("samples", 0);
  haloMarkProgram_.set("visibility", 1);
  haloMarkProgram_.set("cellsInPicture", cellsInPicture);
  haloMarkProgram_.set("cellsInMap", glm::vec2(cells.width, cells.height));
  api_->drawArrays(GL_POINTS, 0, static_cast<GLsizei>(samples.samples.size()));

  const auto rows =
      static_cast<int>((samples.samples.size() + kAtlasWidth - 1) / std::size_t{kAtlasWidth});
  spare_.bind();
  api_->viewport(0, 0, kAtlasWidth, rows);
  haloProgram_.use();
  haloProgram_.set("samples", 0);
  haloProgram_.set("visibility", 1);
  haloProgram_.set("marks", 2);
  haloProgram_.set("cellsInPicture", cellsInPicture);
  haloProgram_.set("reach", kHaloCells);
  gl::bindTexture(*api_, 2, halo_.color());
  api_->drawArrays(GL_TRIANGLES, 0, 3);
  return {};
}

Result<void> StrokePass::findDensity(const SpineSamples& samples, const DrawOptions& options) {
  const Viewport& viewport = options.viewport;
  const gl::TextureSize cells{densityCells(viewport.width), densityCells(viewport.height)};
  if (density_.size() != cells) {
    auto map = gl::Target::create(
        *api_,
        "the density of lines",
        {.size = cells, .color = gl::TexelFormat::kRg8});
    if (!map) return tl::unexpected(map.error());
    density_ = *std::move(map);
  }
  density_.bind();
  api_->clearColor(0.0F, 0.0F, 0.0F, 0.0F);
  api_->clear(GL_COLOR_BUFFER_BIT);
  if (samples.samples.empty()) return {};
  api_->bindVertexArray(noAttributes_.id());
  densityProgram_.use();
  densityProgram_.set("samples", 0);
  densityProgram_.set("visibility", 1);
  densityProgram_.set("hiddenMode", static_cast<int>(options.hidden));
  densityProgram_.set(
      "cellsInPicture",
      glm::vec2(viewport.width, viewport.height) / static_cast<float>(kDensityCellPx));
  densityProgram_.set("cellsInMap", glm::vec2(cells.width, cells.height));
  gl::bindTexture(*api_, 0, sampleTexture_);
  gl::bindTexture(*api_, 1, shaped_.color());
  api_->enable(GL_BLEND);
  api_->blendFunc(GL_ONE, GL_ONE);
  api_->drawArrays(GL_POINTS, 0, static_cast<GLsizei>(samples.samples.size()));
  api_->disable(GL_BLEND);
  return {};
}

void StrokePass::draw(
    const StrokeMesh& strokes,
    const LoadedStyle& style,
    const DrawOptions& options,
    const gl::Target& target) const {
  target.bind();
  api_->clearColor(0.0F, 0.0F, 0.0F, 0.0F);
  api_->clear(GL_COLOR_BUFFER_BIT);
  if (strokes.indices.empty()) return;
  api_->bindVertexArray(strokeArray_.id());
  api_->bindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  api_->bufferData(
      GL_ARRAY_BUFFER,
      static_cast<GLsizeiptr>(strokes.vertices.size() * sizeof(StrokeVertex)),
      strokes.vertices.data(),
      GL_STREAM_DRAW);
  api_->bufferData(
      GL_ELEMENT_ARRAY_BUFFER,
      static_cast<GLsizeiptr>(strokes.indices.size() * sizeof(std::uint32_t)),
      strokes.indices.data(),
      GL_STREAM_DRAW);
  strokeProgram_.use();
  strokeProgram_.set("pictureSize", glm::vec2(options.viewport.width, options.viewport.height));
  strokeProgram_.set("visibility", 0);
  strokeProgram_.set("visibleStroke", 1);
  strokeProgram_.set("hiddenStroke", 2);
  strokeProgram_.set("hiddenMode", static_cast<int>(options.hidden));
  strokeProgram_.set("body", style.style.body);
  strokeProgram_.set("rampPx", 2.0F * kRampSamples / options.samplesPerPx);
  strokeProgram_.set("densityMap", 3);
  strokeProgram_.set("cellPx", static_cast<float>(kDensityCellPx));
  strokeProgram_.set(
      "perCount",
      1.0F / (options.samplesPerPx * static_cast<float>(kDensityCellPx * kDensityCellPx)));
  strokeProgram_.set("inkShare", style.style.body);
  strokeProgram_.set("inkPx", options.widthPx);
  strokeProgram_.set("crowding", glm::vec3(kLargestShare, kLeastWidth, kLeastOpacity));
  strokeProgram_.set("paling", glm::vec2(kPaleFrom, kPalest));
  const bool hasHalo = options.hidden == Hidden::kStyle;
  gl::bindTexture(*api_, 0, (hasHalo ? spare_ : shaped_).color());
  gl::bindTexture(*api_, 1, style.visible);
  gl::bindTexture(*api_, 2, style.hidden);
  gl::bindTexture(*api_, 3, density_.color());
  api_->enable(GL_BLEND);
  api_->blendEquation(GL_MAX);
  api_->blendFunc(GL_ONE, GL_ONE);
  api_->drawElements(
      GL_TRIANGLES,
      static_cast<GLsizei>(strokes.indices.size()),
      GL_UNSIGNED_INT,
      nullptr);
  api_->blendEquation(GL_FUNC_ADD);
  api_->disable(GL_BLEND);
}

std::vector<float> StrokePass::readVisibility(std::size_t samples) const {
  return readAtlas(shaped_, 0, samples);
}

std::vector<float> StrokePass::readClear(std::size_t samples) const {
  return readAtlas(spare_, 1, samples);
}

std::vector<float>
StrokePass::readAtlas(const gl::Target& atlas, std::size_t channel, std::size_t samples) const {
  if (rows_ == 0) return {};
  atlas.bind();
  std::vector<std::uint8_t> texels(
      4 * static_cast<std::size_t>(kAtlasWidth) * static_cast<std::size_t>(rows_));
  api_->pixelStorei(GL_PACK_ALIGNMENT, 1);
  api_->readPixels(0, 0, kAtlasWidth, rows_, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  std::vector<float> values(samples);
  for (std::size_t i = 0; i < samples; ++i)
    values[i] = static_cast<float>(texels[4 * i + channel]) / 255.0F;
  return values;
}

std::vector<glm::ivec2> StrokePass::readDensity() const {
  const gl::TextureSize size = density_.size();
  density_.bind();
  const std::size_t cells =
      static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
  std::vector<std::uint8_t> texels(4 * cells);
  api_->pixelStorei(GL_PACK_ALIGNMENT, 1);
  api_->readPixels(0, 0, size.width, size.height, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  std::vector<glm::ivec2> counts(cells);
  for (std::size_t i = 0; i < cells; ++i)
    counts[i] = {texels[4 * i], texels[4 * i + 1]};
  return counts;
}

}  // namespace limn
