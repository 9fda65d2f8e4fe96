// SPDX-License-Identifier: Apache-2.0
#include "client/svg/svg_drawing.h"

#include "client/stroke/drawn_spines.h"
#include "client/stroke/nested_contours.h"
#include "client/stroke/parameters.h"
#include "client/stroke/spine.h"
#include "client/stroke/stroke_builder.h"
#include "client/stroke/visibility/line_spans.h"
#include "client/stroke/visibility/spine_samples.h"
#include "client/stroke/visibility/visibility.h"
#include "client/svg/clear_runs.h"
#include "client/svg/crowded_runs.h"
#include "client/svg/curve_fit.h"
#include "client/svg/path_data.h"
#include "client/svg/visible_runs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

namespace limn {
namespace {

struct KindName {
  LineKind kind;
  const char* id;
  const char* label;
};

/// From the bottom of the drawing to its top.
constexpr std::array<KindName, 8> kKinds = {{
    {LineKind::kSuggestive, "suggestive-contours", "Suggestive contours"},
    {LineKind::kValley, "valleys", "Valleys"},
    {LineKind::kRidge, "ridges", "Ridges"},
    {LineKind::kIntersection, "intersections", "Intersections"},
    {LineKind::kSeam, "seams", "Seams"},
    {LineKind::kCrease, "creases", "Creases"},
    {LineKind::kBorder, "borders", "Borders"},
    {LineKind::kSilhouette, "silhouettes", "Silhouettes"},
}};

/// Fainter lines are left out; hidden ones sooner: where many that are next to nothing cross, the
/// picture has the darkest of them, but in a drawing they add up.
constexpr float kFaintest = 0.04F;
constexpr float kFaintestHidden = 0.1F;

/// Dashes of a loop are stretched where they would end up farther than this from the picture's, px.
constexpr float kLargestDrift = 0.5F;

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        // XML has no place for control characters.
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return out;
}

/// At most three decimals, no trailing zeros; the same everywhere.
std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", value);
  std::string out = text;
  while (out.back() == '0')
    out.pop_back();
  if (out.back() == '.') out.pop_back();
  return out == "-0" ? "0" : out;
}

/// Every digit: a camera that is read back is the same camera.
std::string exactNumber(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string vector(const glm::dvec3& v) {
  return exactNumber(v.x) + " " + exactNumber(v.y) + " " + exactNumber(v.z);
}

std::string colorText(const glm::vec3& color) {
  const glm::ivec3 c(glm::round(glm::clamp(color, 0.0F, 1.0F) * 255.0F));
  char text[8];
  std::snprintf(
      text,
      sizeof text,
      "#%02x%02x%02x",
      static_cast<unsigned>(c.r) & 255U,
      static_cast<unsigned>(c.g) & 255U,
      static_cast<unsigned>(c.b) & 255U);
  return text;
}

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + value + "\"";
}

std::string head(const LineScene& scene, const StrokeStyle& style, const SvgOptions& options) {
  const Camera& camera = scene.camera;
  const std::string width = std::to_string(scene.viewport.width);
  const std::string height = std::to_string(scene.viewport.height);
  const std::string title = escaped(options.model);
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<svg xmlns=\"http://www.w3.org/2000/svg\"\n"
         "     xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\"\n"
         "     xmlns:sodipodi=\"http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd\"\n"
         "     version=\"1.1\"" +
         attribute("width", width) + attribute("height", height) +
         attribute("viewBox", "0 0 " + width + " " + height) + ">\n<title>" + title +
         "</title>\n<metadata>\n"
         "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\""
         " xmlns:cc=\"http://creativecommons.org/ns#\" xmlns:dc=\"http://purl.org/dc/elements/1.1/"
         "\"><cc:Work rdf:about=\"\"><dc:format>image/svg+xml</dc:format><dc:title>" +
         title + "</dc:title><dc:creator><cc:Agent><dc:title>" + escaped(options.creator) +
         "</dc:title></cc:Agent></dc:creator></cc:Work></rdf:RDF>\n"
         "<limn:view xmlns:limn=\"urn:limn:view\"" +
         attribute("model", title) + attribute("eye", vector(camera.eye)) +
         attribute("target", vector(camera.target)) + attribute("up", vector(camera.up)) +
         attribute("fov", exactNumber(camera.fovDegrees)) +
         attribute("ortho", camera.orthographic ? "true" : "false") +
         "/>\n</metadata>\n"
         "<g inkscape:groupmode=\"layer\" inkscape:label=\"Paper\" id=\"paper\""
         " sodipodi:insensitive=\"true\">\n<rect" +
         attribute("width", width) + attribute("height", height) +
         attribute("fill", colorText(style.paper)) + "/>\n</g>\n";
}

/// Of the whole spine: one path has one opacity.
float meanStrength(const PolylineSet& lines, const SpineSet& spines, std::uint32_t index) {
  if (lines.strengths.empty()) return 1.0F;
  const SpineSet::Spine& spine = spines.spines[index];
  float sum = 0.0F;
  for (std::uint32_t i = spine.begin; i < spine.end; ++i)
    sum += lines.strengths[spines.source[i]];
  return sum / static_cast<float>(spine.size());
}

/// How many times as wide as at the camera's target a spine's stroke is, in the mean: one path has
/// one width.
float meanWidthFactor(
    const SpineSet& spines,
    std::uint32_t index,
    const Camera& camera,
    float falloff) {
  const SpineSet::Spine& spine = spines.spines[index];
  float sum = 0.0F;
  for (std::uint32_t i = spine.begin; i < spine.end; ++i)
    sum += widthFactor(camera, spines.depth[i], falloff);
  return sum / static_cast<float>(spine.size());
}

float widthOf(LineKind kind, const SvgPen& pen, const StrokeStyle& style) {
  return pen.widthPx * (isInner(kind) ? style.creaseWidth : 1.0F);
}

std::string dashText(const std::vector<float>& dashPx, float scale) {
  std::string text;
  for (const float dash : dashPx)
    text += (text.empty() ? "" : " ") + number(dash * scale);
  return text;
}

/// Where in the picture's texture a run begins, so that its dashes lie where the picture's do.
std::string dashAttributes(
    const VisibleRun& run,
    const SvgPen& pen,
    const SpineSet& spines,
    const SpineArcs& arcs,
    const SpineParameters& parameters) {
  float pattern = 0.0F;
  for (const float dash : pen.dashPx)
    pattern += dash;
  if (!(pattern > 0.0F)) return {};
  const SpineSet::Spine& spine = spines.spines[run.spine];
  const float length = arcs.length[run.spine];
  const float start = parameters.from[spine.begin];
  // Loops are stretched to whole repeats.
  const float perPx = (parameters.to[spine.end - 1] - start) / length;
  const float offset = start + perPx * run.arc - pen.dashStartPx;
  std::string out;
  if (std::abs(perPx - 1.0F) * length > kLargestDrift)
    out += attribute("stroke-dasharray", dashText(pen.dashPx, 1.0F / perPx));
  const float within = offset - pattern * std::floor(offset / pattern);
  return out + attribute("stroke-dashoffset", number(within / perPx));
}

std::string
layerHead(const KindName& kind, bool visible, const SvgPen& pen, const StrokeStyle& style) {
  const char* suffix = visible ? "visible" : "hidden";
  std::string out = "<g inkscape:groupmode=\"layer\"" +
                    attribute("inkscape:label", std::string(kind.label) + ", " + suffix) +
                    attribute("id", std::string(kind.id) + "-" + suffix) + " fill=\"none\"" +
                    attribute("stroke", colorText(pen.color)) +
                    attribute("stroke-width", number(widthOf(kind.kind, pen, style)));
  // Round caps would close the gaps between dashes.
  out += attribute("stroke-linecap", pen.dashPx.empty() ? "round" : "butt");
  out += attribute("stroke-linejoin", "round");
  if (!pen.dashPx.empty()) out += attribute("stroke-dasharray", dashText(pen.dashPx, 1.0F));
  if (pen.opacity < 1.0F) out += attribute("opacity", number(pen.opacity));
  return out + ">\n";
}

}  // namespace

std::string svgDrawing(
    const PolylineSet& lines,
    const ResolveDrawn& resolve,
    const LineScene& scene,
    const StrokeStyle& style,
    const SvgOptions& options) {
  // The picture's own steps, so that its strokes run where these do.
  DrawnSpines drawn;
  drawn.find(lines, scene, style, options.inkPx);
  SpineSet& spines = drawn.spines;
  const std::vector<LineFade>& fades = drawn.fades;
  std::vector<std::uint8_t> isDrawn;
  markDrawn(spines, lines.points.size(), isDrawn);
  const ResolvedLines resolved = resolve(isDrawn);
  smoothSpines(style.smoothPx, spines);
  const SpineArcs arcs = measureSpines(spines);
  LineSpans spans;
  LineSpanFinder().find(lines, isDrawn, scene, spans);
  SpineSamples samples = sampleSpines(spines, arcs, spans, scene.viewport);
  NestedContours().find(scene.viewport, options.inkPx, fades, samples);
  SpineParameters parameters;
  freshParameters(spines, arcs, lines, options.periodPx, parameters);
  std::vector<VisibleRun> runs =
      cutAtVisibility(spines, arcs, lines, resolved, scene, samples, closedGap(options.inkPx));

  const LineDensity density = densityOf(runs, scene.viewport, options.hiddenAsVisible);
  if (options.hidden && !options.hiddenAsVisible) {
    std::vector<VisibleRun> parts;
    for (VisibleRun& run : clearOfVisible(runs, scene.viewport, options.inkPx)) {
      if (run.visible) {
        parts.push_back(std::move(run));
      } else {
        cutWherePaler(run, density, options.inkPx, parts);
      }
    }
    runs = std::move(parts);
  }

  std::string out = head(scene, style, options);
  for (const bool visible : {false, true}) {
    if (!visible && !options.hidden) continue;
    const SvgPen& pen = visible ? options.visible : *options.hidden;
    for (const KindName& kind : kKinds) {
      bool isEmpty = true;
      for (const VisibleRun& run : runs) {
        if (run.visible != visible || spines.spines[run.spine].kind != kind.kind) continue;
        const bool isVisible = visible || options.hiddenAsVisible;
        const float fade = isVisible ? fades[run.spine].visible : fades[run.spine].hidden;
        const float strength = meanStrength(lines, spines, run.spine);
        const float usual = widthOf(kind.kind, pen, style);
        const float width =
            usual * meanWidthFactor(spines, run.spine, scene.camera, options.widthFalloff);
        Crowding crowding = crowdingOf(run, isVisible, density, isVisible ? width : options.inkPx);
        if (isVisible) {
          crowding = faded(crowding, fade);
        } else {
          crowding.opacity *= fade;
        }
        const float opacity = strength * crowding.opacity;
        if (opacity < (isVisible ? kFaintest : kFaintestHidden)) continue;
        if (isEmpty) out += layerHead(kind, visible, pen, style);
        isEmpty = false;
        out += "<path";
        if (std::abs(width * crowding.width - usual) > 0.05F * usual)
          out += attribute("stroke-width", number(width * crowding.width));
        if (opacity < 0.995F) out += attribute("opacity", number(opacity));
        out += dashAttributes(run, pen, spines, arcs, parameters);
        const PathEnds ends = run.closed ? PathEnds::kClosed : PathEnds::kOpen;
        out += attribute("d", pathData(fitPath(run.points, ends), ends)) + "/>\n";
      }
      if (!isEmpty) out += "</g>\n";
    }
  }
  return out + "</svg>\n";
}

}  // namespace limn
