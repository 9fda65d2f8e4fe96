// SPDX-License-Identifier: Apache-2.0
#include "client/apps/svg_file.h"

#include "client/apps/drawing_options.h"
#include "client/render/assets.h"
#include "client/render/style_files.h"
#include "client/stroke/tessellate.h"
#include "client/svg/stroke_shape.h"
#include "client/svg/svg_drawing.h"

namespace limn {
namespace {

/// widthPx: of the ink, as `--width` has it; the picture's own ink may be thinner.
SvgPen penOf(
    const StrokeTexture& texture,
    const InkImage& image,
    const StrokeStyle& style,
    float widthPx) {
  const StrokeShape shape = strokeShape(image.ink, image.width);
  SvgPen pen{
      texture.color,
      texture.opacity * shape.strength,
      widthPx * shape.thickness / style.body,
      {},
      0.0F};
  const float repeatPx = texturePeriod(style, widthPx) / repeatsAPeriod(style, texture);
  for (const float share : shape.dashes)
    pen.dashPx.push_back(share * repeatPx);
  pen.dashStartPx = shape.dashStart * repeatPx;
  return pen;
}

}  // namespace

Result<std::string> svgFile(
    const RenderCommandOptions& options,
    const std::string& modelName,
    const MeshSnapshot& snapshot,
    const PolylineSet& lines,
    const VisibilityResolver& resolver,
    const Camera& camera) {
  const auto assets = findAssets(options.assets);
  if (!assets) return tl::unexpected(assets.error());
  const auto files = readStyle(*assets, options.style);
  if (!files) return tl::unexpected(files.error());
  SvgOptions svg;
  // A file has no catalogue name: its own says more.
  svg.model = options.source.meshFile.empty() ? modelName : options.source.meshFile.stem().string();
  svg.creator = std::string("limn-client ") + LIMN_VERSION;
  const StrokeStyle style = withTextureSize(files->style, options.textureSize);
  const RenderOptions render = renderOptionsOf(options);
  const float widthPx = lineWidthPx(render, style, camera);
  svg.widthFalloff = lineWidthFalloff(render);
  svg.inkPx = widthPx;
  svg.periodPx = texturePeriod(style, widthPx);
  svg.visible = penOf(style.visible, files->visible, style, widthPx);
  if (options.hidden == HiddenLines::kStyle) {
    svg.hidden = penOf(style.hidden, files->hidden, style, widthPx);
  } else if (options.hidden == HiddenLines::kAsVisible) {
    svg.hidden = svg.visible;
    svg.hiddenAsVisible = true;
  }
  const LineScene scene{
      snapshot.mesh.mesh(),
      snapshot.mesh.positions(),
      snapshot.model.grid,
      camera,
      options.viewport};
  const auto resolve = [&](std::span<const std::uint8_t> isDrawn) {
    return resolver.resolve(lines, scene, isDrawn);
  };
  return svgDrawing(lines, resolve, scene, style, svg);
}

}  // namespace limn
