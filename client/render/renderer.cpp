// SPDX-License-Identifier: Apache-2.0
#include "client/render/renderer.h"

#include "client/render/assets.h"
#include "client/render/clip_method.h"
#include "client/render/draw_tools.h"
#include "client/render/drawing_method.h"
#include "client/render/shaders/shaders.h"
#include "client/render/style_store.h"

#include "shared/gl/program.h"
#include "shared/gl/target.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace limn {
namespace {

/// Supersampled pixels of a frame, at most: depth and ink together are six bytes each.
constexpr std::int64_t kMaxPixels = std::int64_t{64} << 20;
constexpr int kMaxSide = 16384;
constexpr std::size_t kMostObjects = 16;  // a connection has as many channels

double millisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

}  // namespace

struct Renderer::Impl {
  std::unique_ptr<GlContext> context;  // first in, last out: everything below lives on it
  GlDescription description;
  StyleStore styles;
  std::optional<DrawTools> tools;
  std::map<DrawMode, std::unique_ptr<DrawingMethod>> methods;  // those asked for so far
  std::vector<std::unique_ptr<ClipMethod>> clipMethods;        // of scenes, one a model
  gl::Program depthBitsProgram;
  gl::Target pictureTarget;
  gl::Target fineTarget;  // of scenes
  gl::Target bitsTarget;  // kR32ui

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
    auto made = DrawTools::create(api());
    if (!made) return tl::unexpected(made.error());
    auto bits = gl::Program::build(
        api(),
        "depth read-back",
        shaders::kScreenVertex,
        shaders::kDepthBitsFragment);
    if (!bits) return tl::unexpected(bits.error());
    tools = *std::move(made);
    depthBitsProgram = *std::move(bits);
    return {};
  }

  Result<DrawingMethod*> method(DrawMode mode) {
    std::unique_ptr<DrawingMethod>& slot = methods[mode];
    if (!slot) {
      auto made = makeDrawingMethod(mode, *tools);
      if (!made) return tl::unexpected(made.error());
      slot = *std::move(made);
    }
    return slot.get();
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

  Result<DepthImage> readDepth(const DrawRequest& request) {
    const gl::TextureSize size = request.fineSize();
    const auto depth = tools->depthImage(request.snapshot, request.camera, size);
    if (!depth) return tl::unexpected(depth.error());
    const gl::Target::Options options{.size = size, .color = gl::TexelFormat::kR32ui};
    if (auto ok = tools->fit(bitsTarget, "the depth read-back", options); !ok) {
      return tl::unexpected(ok.error());
    }
    bitsTarget.bind();
    depthBitsProgram.use();
    depthBitsProgram.set("depthMap", 0);
    gl::bindTexture(api(), 0, (*depth)->depth());
    tools->drawScreen();
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

  /// What a frame's options come to.
  struct Setup {
    const LoadedStyle* style = nullptr;
    glm::vec3 paper{1.0F};
    int supersample = 1;
  };

  /// Checks the options, makes the context current and the picture as large as they say.
  Result<Setup> begin(const RenderOptions& options);
  Result<void> checkGl();
  Result<Frame> render(
      const MeshSnapshot& snapshot,
      const PolylineSet& lines,
      const Camera& camera,
      const RenderOptions& options);
  Result<Frame> renderScene(
      std::span<const SceneObject> objects,
      const Camera& camera,
      const RenderOptions& options);
  Result<void> drawMeshes(std::span<const DrawRequest> requests);
};

Result<Renderer::Impl::Setup> Renderer::Impl::begin(const RenderOptions& options) {
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
  if (!(options.textureSize >= 0.1 && options.textureSize <= 10.0)) {
    return fail(ErrorCode::kInvalidArgument, "a texture's size must be 0.1 to 10 times its own");
  }
  if (auto current = context->makeCurrent(); !current) return tl::unexpected(current.error());
  const auto loaded = styles.load(api(), options.style);
  if (!loaded) return tl::unexpected(loaded.error());

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
  const gl::Target::Options picture{
      .size = {viewport.width, viewport.height},
      .color = gl::TexelFormat::kRgba8,
      .hasStencil =
          options.draw == DrawMode::kClip || (options.draw == DrawMode::kShaded && factor == 1)};
  if (auto ok = tools->fit(pictureTarget, "the picture", picture); !ok) {
    return tl::unexpected(ok.error());
  }
  return Setup{*loaded, options.paper.value_or((*loaded)->style.paper), factor};
}

Result<void> Renderer::Impl::checkGl() {
  if (const GLenum error = api().getError(); error != GL_NO_ERROR) {
    return fail(
        ErrorCode::kUnavailable,
        "GL error " + std::to_string(error) + " while drawing with " + description.renderer +
            ": try the other --gl backend or a smaller --size");
  }
  return {};
}

Result<Frame> Renderer::Impl::render(
    const MeshSnapshot& snapshot,
    const PolylineSet& lines,
    const Camera& camera,
    const RenderOptions& options) {
  const auto setup = begin(options);
  if (!setup) return tl::unexpected(setup.error());
  const DrawRequest
      request{snapshot, lines, camera, options, *setup->style, setup->paper, setup->supersample};
  const auto drawing = method(options.draw);
  if (!drawing) return tl::unexpected(drawing.error());

  Frame frame;
  FrameTimings& timings = frame.timings;
  auto start = std::chrono::steady_clock::now();
  if (tools->begin(snapshot)) {
    api().finish();
    timings.uploadMs = millisecondsSince(start);
  }
  start = std::chrono::steady_clock::now();
  if (auto ok = (*drawing)->draw(request, pictureTarget, timings); !ok) {
    return tl::unexpected(ok.error());
  }
  frame.image = readPicture();
  timings.drawMs = millisecondsSince(start) - timings.strokeMs - timings.visibilityMs;
  if (options.keepDepth) {
    auto depth = readDepth(request);
    if (!depth) return tl::unexpected(depth.error());
    frame.depth = *std::move(depth);
  }
  if (auto ok = checkGl(); !ok) return tl::unexpected(ok.error());
  return frame;
}

Result<Frame> Renderer::Impl::renderScene(
    std::span<const SceneObject> objects,
    const Camera& camera,
    const RenderOptions& options) {
  if (options.draw != DrawMode::kClip || objects.empty() || objects.size() > kMostObjects) {
    return fail(
        ErrorCode::kInvalidArgument,
        "a scene is of 1 to " + std::to_string(kMostObjects) + " models, drawn by clip");
  }
  const auto setup = begin(options);
  if (!setup) return tl::unexpected(setup.error());
  while (clipMethods.size() < objects.size()) {
    auto made = ClipMethod::make(*tools);
    if (!made) return tl::unexpected(made.error());
    clipMethods.push_back(*std::move(made));
  }
  std::vector<BoundingSphere> spheres;
  std::vector<Camera> cameras;
  for (const SceneObject& object : objects) {
    spheres.push_back(sphereOf(object));
    cameras.push_back(seenFrom(camera, object.place));
  }
  std::vector<DrawRequest> requests;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    requests.push_back(
        {objects[i].snapshot,
         objects[i].lines,
         cameras[i],
         options,
         *setup->style,
         setup->paper,
         setup->supersample});
  }
  Frame frame;
  const auto start = std::chrono::steady_clock::now();
  auto behind = ClipMethod::Behind::kPaper;
  for (const std::size_t i : farToNear(spheres, camera)) {
    const auto isDrawn =
        clipMethods[i]->drawClipped(requests[i], behind, pictureTarget, frame.timings);
    if (!isDrawn) return tl::unexpected(isDrawn.error());
    behind = ClipMethod::Behind::kPicture;
    if (*isDrawn) continue;
    if (auto ok = drawMeshes(requests); !ok) return tl::unexpected(ok.error());
    break;
  }
  frame.image = readPicture();
  frame.timings.drawMs =
      millisecondsSince(start) - frame.timings.strokeMs - frame.timings.visibilityMs;
  if (auto ok = checkGl(); !ok) return tl::unexpected(ok.error());
  return frame;
}

/// Where the eye is inside of one of them: all, with one depth buffer.
Result<void> Renderer::Impl::drawMeshes(std::span<const DrawRequest> requests) {
  const gl::Target::Options fine{.size = requests.front().fineSize(), .hasDepth = true};
  if (auto ok = tools->fit(fineTarget, "the supersampled picture", fine); !ok) return ok;
  for (const DrawRequest& request : requests) {
    tools->begin(request.snapshot);
    MeshPass::Shading shading{.background = request.paper};
    if (&request != &requests.front()) shading.over = MeshPass::Shading::Over::kPicture;
    tools->mesh().drawShaded(request.snapshot, request.camera, fineTarget, shading);
  }
  tools->reduce(fineTarget.color(), requests.front().supersample, pictureTarget);
  return {};
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

Result<Renderer> Renderer::open(
    GlBackend backend,
    const std::optional<std::filesystem::path>& assets) {
  auto folder = findAssets(assets);
  if (!folder) return tl::unexpected(folder.error());
  auto context = createGlContext(backend);
  if (!context) return tl::unexpected(context.error());
  return create(std::move(*context), std::move(*folder));
}

Result<Frame> Renderer::render(
    const MeshSnapshot& snapshot,
    const PolylineSet& lines,
    const Camera& camera,
    const RenderOptions& options) {
  return impl_->render(snapshot, lines, camera, options);
}

Result<Frame> Renderer::renderScene(
    std::span<const SceneObject> objects,
    const Camera& camera,
    const RenderOptions& options) {
  return impl_->renderScene(objects, camera, options);
}

const GlDescription& Renderer::gl() const {
  return impl_->description;
}

}  // namespace limn
