// SPDX-License-Identifier: Apache-2.0
#include "client/render/strokes_method.h"

#include "client/render/shaders/shaders.h"
#include "client/stroke/visibility/visibility.h"

#include <chrono>
#include <utility>

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
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

Result<std::unique_ptr<DrawingMethod>> StrokesMethod::create(DrawTools& tools) {
  std::unique_ptr<StrokesMethod> method(new StrokesMethod(tools));
  auto pass = StrokePass::create(tools.api());
  if (!pass) return tl::unexpected(pass.error());
  auto paper =
      gl::Program::build(tools.api(), "paper", shaders::kScreenVertex, shaders::kPaperFragment);
  if (!paper) return tl::unexpected(paper.error());
  method->pass_ = *std::move(pass);
  method->paperProgram_ = *std::move(paper);
  return method;
}

Result<void>
StrokesMethod::draw(const DrawRequest& request, const gl::Target& picture, FrameTimings& timings) {
  auto start = Clock::now();
  const auto depth = tools_.depthImage(request.snapshot, request.camera, request.fineSize());
  if (!depth) return tl::unexpected(depth.error());
  tools_.api().finish();
  timings.visibilityMs = millisecondsSince(start);

  start = Clock::now();
  const RenderOptions& options = request.options;
  const LineScene scene{
      request.snapshot.mesh.mesh(),
      request.snapshot.mesh.positions(),
      request.snapshot.model.grid,
      request.camera,
      options.viewport};
  const auto scale = static_cast<float>(options.pixelScale);
  const StrokeStyle style =
      enlarged(withTextureSize(request.style.style, options.textureSize), scale);
  Brush brush = options.brush;
  brush.amplitudePx *= scale;
  brush.wavelengthPx *= scale;
  const BuiltStrokes strokes = builder_.build(
      request.lines,
      scene,
      style,
      {.widthPx = request.lineWidthPx(),
       .widthFalloff = lineWidthFalloff(options),
       .brush = brush,
       .samples = {.spacingPx = 1.0F, .maxSamples = StrokePass::kMaxSamples}});
  timings.strokeMs = millisecondsSince(start);

  start = Clock::now();
  if (auto found = pass_.findVisibility(
          strokes.samples,
          (*depth)->depth(),
          closedGap(request.lineWidthPx()));
      !found)
    return found;
  const StrokePass::DrawOptions drawing{
      .viewport = options.viewport,
      .hidden = hiddenMode(options.hidden),
      .widthPx = request.lineWidthPx()};
  if (auto found = pass_.findHalo(strokes.samples, drawing); !found) return found;
  if (auto found = pass_.findDensity(strokes.samples, drawing); !found) return found;
  tools_.api().finish();
  timings.visibilityMs += millisecondsSince(start);

  const gl::Target::Options ink{.size = request.fineSize(), .color = gl::TexelFormat::kRg8};
  if (auto ok = tools_.fit(ink_, "the ink", ink); !ok) return ok;
  pass_.draw(strokes.mesh, request.style, drawing, ink_);
  layOnPaper(request, picture);
  return {};
}

void StrokesMethod::layOnPaper(const DrawRequest& request, const gl::Target& picture) const {
  const StrokeStyle& style = request.style.style;
  picture.bind();
  paperProgram_.use();
  paperProgram_.set("inkMap", 0);
  paperProgram_.set("supersample", request.supersample);
  paperProgram_.set("paper", request.paper);
  paperProgram_.set("visibleColor", style.visible.color);
  paperProgram_.set("hiddenColor", style.hidden.color);
  paperProgram_.set("opacities", glm::vec2(style.visible.opacity, style.hidden.opacity));
  paperProgram_.set("grain", style.grain);
  paperProgram_.set("pictureHeight", request.options.viewport.height);
  gl::bindTexture(tools_.api(), 0, ink_.color());
  tools_.drawScreen();
}

}  // namespace limn
