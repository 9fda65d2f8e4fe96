// SPDX-License-Identifier: Apache-2.0
#include "client/render/renderer.h"

#include "client/render/mesh_pass.h"
#include "client/render/shaders/shaders.h"
#include "client/render/stroke_pass.h"
#include "client/render/style_store.h"
#include "client/stroke/stroke_builder.h"

#include "shared/gl/program.h"
#include "shared/gl/target.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <utility>

namespace limn {
namespace {

/// Supersampled pixels of a frame, at most: depth and ink together are six bytes each.
constexpr std::int64_t kMaxPixels = std::int64_t{64} << 20;
constexpr int kMaxSide = 16384;
/// Cells in which the density of hidden lines is measured, pixels a side.
constexpr int kDensityCell = 24;

double millisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

StrokePass::Hidden hiddenMode(HiddenLines hidden) {
  switch (hidden) {
    case HiddenLines::kStyle:
      return StrokePass::Hidden::kStyle;
    case HiddenLines::kOff:
      return StrokePass::Hidden::kOff;
    case HiddenLines::kAsVisible:
      return StrokePass::Hidden::kAsVisible;
  }
  return StrokePass::Hidden::kStyle;
}

}  // namespace

Result<HiddenLines> parseHiddenLines(std::string_view name) {
  if (name == "style") return HiddenLines::kStyle;
  if (name == "off") return HiddenLines::kOff;
  if (name == "as-visible") return HiddenLines::kAsVisible;
  return fail(
      ErrorCode::kInvalidArgument,
      "hidden lines cannot be '" + std::string(name) + "': use style, off or as-visible");
}

struct Renderer::Impl {
  std::unique_ptr<GlContext> context;  // first in, last out: everything below lives on it
  GlDescription description;
  StyleStore styles;
  MeshPass meshPass;
  StrokePass strokePass;
  StrokeBuilder strokeBuilder;
  gl::Program paperProgram;
  gl::Program densityProgram;
  gl::Program reduceProgram;
  gl::Program depthBitsProgram;
  gl::VertexArray noAttributes;
  gl::Target depthTarget;    // supersampled, depth alone
  gl::Target inkTarget;      // supersampled, kRg8
  gl::Target densityTarget;  // kR8, a texel a cell of kDensityCell pixels
  gl::Target shadedTarget;   // supersampled, colour and depth
  gl::Target pictureTarget;  // the picture
  gl::Target bitsTarget;     // kR32ui

  Impl(std::unique_ptr<GlContext> glContext, std::filesystem::path assets)
      : context(std::move(glContext)),
        styles(std::move(assets)) {}

  ~Impl() {
    // GL objects die in their own context; if it is lost, so are they.
    (void)context->makeCurrent();
  }

  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] const gl::Api& api() const { return context->api(); }

  Result<void> compile() {
    const auto text = [this](GLenum name) {
      const auto* bytes = reinterpret_cast<const char*>(api().getString(name));
      return std::string(bytes == nullptr ? "" : bytes);
    };
    description = {text(GL_RENDERER), text(GL_VERSION)};
    auto mesh = MeshPass::create(api());
    if (!mesh) return tl::unexpected(mesh.error());
    auto stroke = StrokePass::create(api());
    if (!stroke) return tl::unexpected(stroke.error());
    auto paper =
        gl::Program::build(api(), "paper", shaders::kScreenVertex, shaders::kPaperFragment);
    if (!paper) return tl::unexpected(paper.error());
    auto reduce =
        gl::Program::build(api(), "reduce", shaders::kScreenVertex, shaders::kReduceFragment);
    if (!reduce) return tl::unexpected(reduce.error());
    auto density =
        gl::Program::build(api(), "density", shaders::kScreenVertex, shaders::kDensityFragment);
    if (!density) return tl::unexpected(density.error());
    auto bits = gl::Program::build(
        api(),
        "depth read-back",
        shaders::kScreenVertex,
        shaders::kDepthBitsFragment);
    if (!bits) return tl::unexpected(bits.error());
    meshPass = *std::move(mesh);
    strokePass = *std::move(stroke);
    paperProgram = *std::move(paper);
    densityProgram = *std::move(density);
    reduceProgram = *std::move(reduce);
    depthBitsProgram = *std::move(bits);
    noAttributes = gl::VertexArray::create(api());
    return {};
  }

  /// Makes `target` anew unless it already has this size.
  Result<void> fit(gl::Target& target, std::string_view name, const gl::Target::Options& options) {
    if (target.size() == options.size) return {};
    target = {};  // free the old one first
    auto made = gl::Target::create(api(), name, options);
    if (!made) return tl::unexpected(made.error());
    target = *std::move(made);
    return {};
  }

  void drawScreen() {
    api().disable(GL_BLEND);
    api().bindVertexArray(noAttributes.id());
    api().drawArrays(GL_TRIANGLES, 0, 3);
  }

  Image readPicture() {
    const auto [width, height] = pictureTarget.size();
    pictureTarget.bind();
    Image image{width, height, {}};
    const std::size_t row = 4 * static_cast<std::size_t>(width);
    std::vector<std::uint8_t> upsideDown(row * static_cast<std::size_t>(height));
    api().pixelStorei(GL_PACK_ALIGNMENT, 1);
    api().readPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, upsideDown.data());
    image.rgba.resize(upsideDown.size());
    for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
      std::memcpy(
          &image.rgba[y * row],
          &upsideDown[(static_cast<std::size_t>(height) - 1 - y) * row],
          row);
    }
    return image;
  }

  Result<DepthImage> readDepth() {
    const gl::TextureSize size = depthTarget.size();
    const gl::Target::Options options{.size = size, .color = gl::TexelFormat::kR32ui};
    if (auto fitted = fit(bitsTarget, "the depth read-back", options); !fitted) {
      return tl::unexpected(fitted.error());
    }
    bitsTarget.bind();
    depthBitsProgram.use();
    depthBitsProgram.set("depthMap", 0);
    gl::bindTexture(api(), 0, depthTarget.depth());
    drawScreen();
    const auto width = static_cast<std::size_t>(size.width);
    const auto height = static_cast<std::size_t>(size.height);
    DepthImage image{size.width, size.height, {}};
    image.depth.resize(width * height);
    // Four words a pixel are all that GLES promises to read; a few rows at a time.
    constexpr int kRows = 32;
    std::vector<std::uint32_t> words(4 * width * kRows);
    for (int y = 0; y < size.height; y += kRows) {
      const int rows = std::min(kRows, size.height - y);
      api().readPixels(0, y, size.width, rows, GL_RGBA_INTEGER, GL_UNSIGNED_INT, words.data());
      for (int r = 0; r < rows; ++r) {
        float* out = &image.depth[static_cast<std::size_t>(size.height - 1 - (y + r)) * width];
        const std::uint32_t* in = &words[4 * width * static_cast<std::size_t>(r)];
        for (std::size_t x = 0; x < width; ++x)
          out[x] = std::bit_cast<float>(in[4 * x]);
      }
    }
    return image;
  }

  Result<Frame> render(
      const MeshSnapshot& snapshot,
      const PolylineSet& lines,
      const Camera& camera,
      const RenderOptions& options);
};

Result<Frame> Renderer::Impl::render(
    const MeshSnapshot& snapshot,
    const PolylineSet& lines,
    const Camera& camera,
    const RenderOptions& options) {
  const Viewport& viewport = options.viewport;
  if (viewport.width < 1 || viewport.height < 1 || viewport.width > kMaxSide ||
      viewport.height > kMaxSide) {
    return fail(
        ErrorCode::kInvalidArgument,
        "a picture of " + std::to_string(viewport.width) + "x" + std::to_string(viewport.height) +
            " pixels cannot be drawn: use 1x1 to 16384x16384");
  }
  if (options.supersample < 1 || options.supersample > 4) {
    return fail(ErrorCode::kInvalidArgument, "supersampling must be 1 to 4");
  }
  if (options.widthPx && !(*options.widthPx >= 0.1 && *options.widthPx <= 256.0)) {
    return fail(ErrorCode::kInvalidArgument, "a line's width must be 0.1 to 256 pixels");
  }
  if (auto current = context->makeCurrent(); !current) return tl::unexpected(current.error());
  const auto loaded = styles.load(api(), options.style);
  if (!loaded) return tl::unexpected(loaded.error());
  const StrokeStyle& style = (*loaded)->style;
  const glm::vec3 paper = options.paper.value_or(style.paper);

  // A very large picture is its own supersampling.
  GLint largest = 0;
  api().getIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  int factor = options.supersample;
  const auto tooLarge = [&](int n) {
    return std::max(viewport.width, viewport.height) * n > largest ||
           std::int64_t{viewport.width} * viewport.height * n * n > kMaxPixels;
  };
  while (factor > 1 && tooLarge(factor))
    --factor;
  const gl::TextureSize fine{viewport.width * factor, viewport.height * factor};

  Frame frame;
  auto start = std::chrono::steady_clock::now();
  if (meshPass.upload(snapshot)) {
    api().finish();
    frame.timings.uploadMs = millisecondsSince(start);
  }
  const auto fitted =
      fit(pictureTarget,
          "the picture",
          {.size = {viewport.width, viewport.height}, .color = gl::TexelFormat::kRgba8});
  if (!fitted) return tl::unexpected(fitted.error());

  if (options.draw == DrawMode::kShaded) {
    start = std::chrono::steady_clock::now();
    if (auto ok =
            fit(shadedTarget,
                "the supersampled picture",
                {.size = fine, .color = gl::TexelFormat::kRgba8, .hasDepth = true});
        !ok) {
      return tl::unexpected(ok.error());
    }
    meshPass.drawShaded(snapshot, camera, shadedTarget, paper);
    pictureTarget.bind();
    reduceProgram.use();
    reduceProgram.set("picture", 0);
    reduceProgram.set("supersample", factor);
    gl::bindTexture(api(), 0, shadedTarget.color());
    drawScreen();
    frame.image = readPicture();
    frame.timings.drawMs = millisecondsSince(start);
  }

  if (options.draw == DrawMode::kStrokes || options.keepDepth) {
    start = std::chrono::steady_clock::now();
    if (auto ok =
            fit(depthTarget,
                "the depth image",
                {.size = fine, .hasColor = false, .hasDepth = true});
        !ok) {
      return tl::unexpected(ok.error());
    }
    meshPass.drawDepth(snapshot, camera, depthTarget);
    api().finish();
    frame.timings.visibilityMs += millisecondsSince(start);
  }

  if (options.draw == DrawMode::kStrokes) {
    start = std::chrono::steady_clock::now();
    const LineScene scene{
        snapshot.mesh.mesh(),
        snapshot.mesh.positions(),
        snapshot.model.grid,
        camera,
        viewport};
    const float widthPx =
        options.widthModelUnits
            ? std::clamp(widthInPixels(*options.widthModelUnits, camera, viewport), 0.1F, 256.0F)
            : static_cast<float>(options.widthPx.value_or(style.widthPx));
    const BuiltStrokes strokes = strokeBuilder.build(
        lines,
        scene,
        style,
        {.widthPx = widthPx,
         .widthFalloff = options.widthModelUnits ? 1.0F : static_cast<float>(options.widthFalloff),
         .brush = options.brush,
         .samples = {.spacingPx = 1.0F, .maxSamples = StrokePass::kMaxSamples}});
    frame.timings.strokeMs = millisecondsSince(start);

    start = std::chrono::steady_clock::now();
    if (auto found = strokePass.findVisibility(strokes.samples, depthTarget.depth()); !found) {
      return tl::unexpected(found.error());
    }
    api().finish();
    frame.timings.visibilityMs += millisecondsSince(start);

    start = std::chrono::steady_clock::now();
    if (auto ok = fit(inkTarget, "the ink", {.size = fine, .color = gl::TexelFormat::kRg8}); !ok) {
      return tl::unexpected(ok.error());
    }
    strokePass.draw(
        strokes.mesh,
        **loaded,
        {.viewport = viewport, .hidden = hiddenMode(options.hidden)},
        inkTarget);
    const gl::TextureSize cells{
        (viewport.width + kDensityCell - 1) / kDensityCell,
        (viewport.height + kDensityCell - 1) / kDensityCell};
    if (auto ok =
            fit(densityTarget,
                "the density of lines",
                {.size = cells, .color = gl::TexelFormat::kR8});
        !ok) {
      return tl::unexpected(ok.error());
    }
    densityTarget.bind();
    densityProgram.use();
    densityProgram.set("inkMap", 0);
    densityProgram.set("cell", kDensityCell * factor);
    gl::bindTexture(api(), 0, inkTarget.color());
    drawScreen();
    pictureTarget.bind();
    paperProgram.use();
    paperProgram.set("densityMap", 1);
    paperProgram.set("cell", static_cast<float>(kDensityCell));
    gl::bindTexture(api(), 1, densityTarget.color());
    paperProgram.set("inkMap", 0);
    paperProgram.set("supersample", factor);
    paperProgram.set("paper", paper);
    paperProgram.set("visibleColor", style.visible.color);
    paperProgram.set("hiddenColor", style.hidden.color);
    paperProgram.set("opacities", glm::vec2(style.visible.opacity, style.hidden.opacity));
    paperProgram.set("grain", style.grain);
    paperProgram.set("pictureHeight", viewport.height);
    gl::bindTexture(api(), 0, inkTarget.color());
    drawScreen();
    frame.image = readPicture();
    frame.timings.drawMs = millisecondsSince(start);
  }

  if (options.keepDepth) {
    auto depth = readDepth();
    if (!depth) return tl::unexpected(depth.error());
    frame.depth = *std::move(depth);
  }
  if (const GLenum error = api().getError(); error != GL_NO_ERROR) {
    return fail(
        ErrorCode::kUnavailable,
        "GL error " + std::to_string(error) + " while drawing with " + description.renderer +
            ": try the other --gl backend or a smaller --size");
  }
  return frame;
}

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

Result<Renderer> Renderer::create(
    std::unique_ptr<GlContext> context,
    std::filesystem::path assets) {
  if (auto current = context->makeCurrent(); !current) return tl::unexpected(current.error());
  auto impl = std::make_unique<Impl>(std::move(context), std::move(assets));
  if (auto compiled = impl->compile(); !compiled) return tl::unexpected(compiled.error());
  return Renderer(std::move(impl));
}

Result<Frame> Renderer::render(
    const MeshSnapshot& snapshot,
    const PolylineSet& lines,
    const Camera& camera,
    const RenderOptions& options) {
  return impl_->render(snapshot, lines, camera, options);
}

const GlDescription& Renderer::gl() const {
  return impl_->description;
}

}  // namespace limn
