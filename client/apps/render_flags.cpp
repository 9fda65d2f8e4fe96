// SPDX-License-Identifier: Apache-2.0
#include "client/apps/render_flags.h"

#include "client/apps/flag_values.h"
#include "client/apps/frame_path.h"
#include "client/apps/source_flags.h"
#include "client/stroke/style.h"

#include "protocol/limits.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

namespace limn {
namespace {

constexpr char kExamples[] = R"(
Examples:
  limn-client render --server ws://127.0.0.1:8600 --model dragon --out dragon.png
  limn-client render --mesh bunny.ply --camera orbit:30,20,3 --out bunny.png --report bunny.json
  limn-client render --mesh gears.stl --silhouette edges --style ink --svg gears.svg
  limn-client render --asset store/assets/ID --until base --dump-mesh base.ply
  limn-client view --server ws://127.0.0.1:8600
  limn-client render --server ws://127.0.0.1:8600 --model cow --with bunny --draw clip --out two.png
  limn-client render --mesh cow.obj --path orbit --frames 36 --out 'f%04d.png'
)";

}  // namespace

void RenderFlags::addTo(CLI::App& app) {
  RenderCommandOptions& o = options_;
  app.footer(kExamples);
  addSourceFlags(app, o.source);

  pictureFlags_.addTo(
      app,
      {.camera = "orbit:AZIMUTH,ELEVATION[,DISTANCE], degrees and radii",
       .size = "Picture size (1024x1024)",
       .gl = "egl|osmesa"});
  app.add_option("--camera-file", o.cameraFile, R"(JSON {"eye","target","up","fov","ortho"})");
  app.add_option("--fov", fov_, "Vertical angle of view, degrees (40)");
  app.add_flag("--ortho", o.orthographic, "Orthographic, with the same extent at the target");
  app.add_option(
      "--until",
      until_,
      "base|settled|exact|complete|bytes:N|seconds:S (settled; files: complete)");
  app.add_option("--error-px", o.errorPx, "Error bound of settled, pixels (1)");

  app.add_option(
      "--draw",
      draw_,
      "strokes|shaded|clip|image-edges|geometry-shader|conditional-lines|image-precision:wireframe|"
      "…:"
      "translate|…:z-scale|…:offset|…:fatten|…:"
      "charcoal");
  app.add_option(
      "--detector",
      detector_,
      "exact|brute|cones|random|coherence-a|coherence-b|image|precomputed");
  app.add_option(
      "--features",
      features_,
      "crease,border,seam; suggestive,ridge,valley,intersection; or none");
  app.add_option("--style", o.style, "Texture set (pencil)");
  app.add_option("--brush", brush_, "none|charcoal|lazy|hand|rough");
  app.add_option("--brush-amplitude", brushAmplitude_, "How far it leads off the line, pixels")
      ->check(CLI::Range(0.0, 100.0));
  app.add_option("--brush-frequency", brushFrequency_, "Its waves in 100 pixels")
      ->check(CLI::Range(0.1, 100.0));
  app.add_option("--brush-seed", brushSeed_, "Of its noise (1)");
  app.add_option("--width", width_, "Stroke width, pixels");
  app.add_option("--width-units", widthUnits_, "px|model: of --width");
  app.add_option(
         "--width-falloff",
         widthFalloff_,
         "Strokes thin out with distance: 0 not (the default), 1 as the model does")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--texture-size", o.textureSize, "Times as long as the style's own texture (1)")
      ->check(CLI::Range(0.1, 10.0));
  app.add_option("--hidden", hidden_, "style|off|as-visible");
  app.add_option("--line-color", lineColor_, "#rrggbb (the style's); not of strokes");
  app.add_option(
         "--line-fade",
         o.lineFade,
         "Lines pale with distance: 0 not (the default), 1 to nothing; not of strokes")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option(
      "--first-layer",
      firstLayer_,
      "auto|winding|numbers: how image-precision tells the front from the rest");
  app.add_option("--assets", assets_, "Folder of texture sets");

  app.add_option(
      "--memory",
      o.memoryMib,
      "MiB for the streamed mesh; what no view needs is dropped (no limit)");
  app.add_option(
      "--frames",
      o.frames,
      "Frames to draw; times are medians over them (1; 0: nothing is drawn, only streamed)");
  app.add_option(
      "--path",
      path_,
      "orbit: once around the model in --frames frames; or a file that view has recorded");
  app.add_option("--out", out_, "Picture (PNG); with --path, a pattern like f%04d.png");
  app.add_option("--svg", svg_, "Strokes as vector paths, in layers (SVG); --path: as --out");
  app.add_option("--report", o.report, "Report (JSON)");
  app.add_option("--dump-mesh", o.dumpMesh, "The client's mesh (PLY)");
  app.add_option("--dump-hull", o.dumpHull, "The outer hull with --hull-faces faces (PLY)");
  app.add_option(
      "--dump-inner-hull",
      o.dumpInnerHull,
      "The inner hull with --hull-faces faces (PLY)");
  app.add_option(
      "--contours",
      contours_,
      "client|server: silhouettes of the mesh held here, or of the whole one, found there "
      "(client)");
  app.add_option(
      "--with",
      with_,
      "MODEL[@X,Y,Z]: another model in the picture of --draw clip, its centre at that place "
      "(beside the last); repeated");
  app.add_option("--hull-faces", o.hullFaces, "Faces of the hulls, or as near from below (500)")
      ->check(CLI::Range(4, 1 << 20));
  app.add_option("--dump-lines", o.dumpLines, "The lines, with visibility (JSON)");
  app.add_flag("--check", o.check, "Measure recall against brute force, and contour errors");
  app.add_option(
      "--reference",
      o.reference,
      "Asset directory to compare contours with, for --check");

  detectorFlags_.addTo(app);
}

Result<RenderCommandOptions> RenderFlags::parse() const {
  RenderCommandOptions options = options_;
  if (auto ok = checkSource(options.source); !ok) return tl::unexpected(ok.error());
  if (auto ok = parseView(options); !ok) return tl::unexpected(ok.error());
  if (auto ok = parseDrawing(options); !ok) return tl::unexpected(ok.error());
  if (auto ok = parseContours(options); !ok) return tl::unexpected(ok.error());
  if (auto ok = parseScene(options); !ok) return tl::unexpected(ok.error());
  if (!options.reference.empty() && !options.check) return wrong("--reference goes with --check");
  if (options.out.empty() && options.svg.empty() && options.report.empty() &&
      options.dumpMesh.empty() && options.dumpLines.empty() && options.dumpHull.empty() &&
      options.dumpInnerHull.empty()) {
    return wrong(
        "nothing to write: give --out, --svg, --report, --dump-mesh, --dump-lines, --dump-hull or "
        "--dump-inner-hull");
  }
  return options;
}

Result<void> RenderFlags::parseView(RenderCommandOptions& options) const {
  const auto picture = pictureFlags_.parse();
  if (!picture) return tl::unexpected(picture.error());
  options.orbit = picture->orbit;
  options.viewport = picture->size.value_or(options.viewport);
  options.gl = picture->gl;
  if (options.orbit && !options.cameraFile.empty()) {
    return wrong("give --camera or --camera-file, not both");
  }
  if (fov_ && !(*fov_ >= 1.0 && *fov_ <= 170.0)) {
    return wrong("--fov is the vertical angle of view in degrees, 1 to 170");
  }
  options.fovDegrees = fov_;
  if (!until_.empty()) {
    const auto until = parseUntil(until_);
    if (!until) return tl::unexpected(until.error());
    options.until = *until;
  }
  if (!(options.errorPx >= limits::kMinErrorPx && options.errorPx <= limits::kMaxErrorPx)) {
    return wrong("--error-px is 0.1 to 64");
  }
  if (options.memoryMib > 0 && options.source.serverUrl.empty()) {
    return wrong("--memory bounds what is streamed from a --server; files are read whole");
  }
  if (options.memoryMib > (1U << 20)) return wrong("--memory is at most 1048576 (MiB)");
  if (options.frames > 100'000) return wrong("--frames is 0 to 100000");
  if (options.frames == 0 && (!out_.empty() || !svg_.empty() || !options.dumpLines.empty() ||
                              options.check || !with_.empty())) {
    return wrong("--frames 0 draws nothing: leave out --out, --svg, --dump-lines, --check, --with");
  }
  if (!path_.empty()) {
    options.orbitPath = path_ == "orbit";
    if (!options.orbitPath) options.recordedPath = path_;
    if (std::error_code error; !options.orbitPath && !std::filesystem::exists(path_, error)) {
      return wrong("--path " + path_ + " is no file: write orbit, or a path that view recorded");
    }
    if (options.orbitPath && !options.cameraFile.empty()) {
      return wrong("--path orbit starts at --camera orbit:…, not at a --camera-file");
    }
    if (!options.orbitPath && (!options.cameraFile.empty() || options.orbit)) {
      return wrong(
          "--path " + path_ + " has its own cameras: leave --camera and --camera-file out");
    }
    if (!out_.empty() && options.frames > 1 && !hasFrameNumber(out_)) {
      return wrong(
          "--out needs a place for the frame's number: write for instance --out 'f%04d.png'");
    }
    if (!svg_.empty() && options.frames > 1 && !hasFrameNumber(svg_)) {
      return wrong(
          "--svg needs a place for the frame's number: write for instance --svg 'f%04d.svg'");
    }
  }
  options.out = out_;
  options.svg = svg_;
  return {};
}

Result<void> RenderFlags::parseDrawing(RenderCommandOptions& options) const {
  if (const auto mode = parseDrawMode(draw_)) {
    options.draw = *mode;
  } else {
    return tl::unexpected(mode.error().within("--draw"));
  }
  options.detectorName = detector_;
  const auto method = detectorFromName(detector_);
  if (!method) return wrong("--detector " + detector_ + " is unknown: write " + detectorNames());
  options.detector = *method;
  const auto choice = detectorFlags_.parse();
  if (!choice) return tl::unexpected(choice.error());
  options.detectorParameters = choice->parameters;
  options.silhouette = choice->silhouette;
  options.light = choice->light;
  if (options.light && options.detector == DetectorMethod::kImage)
    return wrong("--detector image looks with the camera: give --light another detector");
  if (auto ok = parseStrokes(options); !ok) return ok;
  const auto features = parseFeatures(features_);
  if (!features) return tl::unexpected(features.error());
  options.features = *features;
  const auto hidden = parseHiddenLines(hidden_);
  if (!hidden) return tl::unexpected(hidden.error());
  options.hidden = *hidden;
  if (!lineColor_.empty()) {
    const auto color = parseColor(lineColor_);
    if (!color) return tl::unexpected(color.error().within("--line-color"));
    options.lineColor = *color;
  }
  const auto firstLayer = parseFirstLayer(firstLayer_);
  if (!firstLayer) return tl::unexpected(firstLayer.error().within("--first-layer"));
  options.firstLayer = *firstLayer;
  if (!assets_.empty()) options.assets = assets_;
  return {};
}

Result<void> RenderFlags::parseStrokes(RenderCommandOptions& options) const {
  const auto kind = parseBrushKind(brush_);
  if (!kind) return tl::unexpected(kind.error().within("--brush"));
  options.brush = usualBrush(*kind);
  if (brushAmplitude_) options.brush.amplitudePx = static_cast<float>(*brushAmplitude_);
  if (brushFrequency_) {
    options.brush.wavelengthPx = static_cast<float>(100.0 / *brushFrequency_);
  }
  options.brush.seed = brushSeed_;
  options.widthFalloff = widthFalloff_;
  if (widthUnits_ == "model") {
    if (!width_) return wrong("--width-units model needs --width, in the model's units");
    if (!(*width_ > 0.0)) return wrong("--width is a stroke's width, above 0");
    options.widthModelUnits = width_;
    return {};
  }
  if (widthUnits_ != "px") {
    return wrong("--width-units " + widthUnits_ + " is unknown: write px or model");
  }
  if (width_ && !(*width_ > 0.0 && *width_ <= 200.0)) {
    return wrong("--width is a stroke's width in pixels, above 0 and up to 200");
  }
  options.widthPx = width_;
  return {};
}

Result<void> RenderFlags::parseContours(RenderCommandOptions& options) const {
  if (contours_ != "client" && contours_ != "server") {
    return wrong("--contours " + contours_ + " is unknown: write client or server");
  }
  if (options.draw == DrawMode::kClip) {
    if (options.light)
      return wrong("--draw clip cuts where the eye sees the outline, not a --light");
    // The outline of a mesh is that of its edges.
    options.silhouette = SilhouetteKind::kEdges;
  }
  if (contours_ == "client") return {};
  options.contours = SessionMachine::Options::Contours::kServer;
  if (options.source.serverUrl.empty()) {
    return wrong("--contours server needs a --server; files bring the whole mesh");
  }
  if (options.draw != DrawMode::kClip && options.draw != DrawMode::kStrokes) {
    return wrong(
        "--contours server is for --draw clip and strokes: other ways to draw need the mesh");
  }
  if (!until_.empty()) {
    return wrong("--contours server holds no mesh, so there is no --until to wait for");
  }
  if (options.check || !svg_.empty() || !options.dumpLines.empty()) {
    return wrong("--contours server finds no lines: leave out --check, --svg, --dump-lines");
  }
  return {};
}

Result<void> RenderFlags::parseScene(RenderCommandOptions& options) const {
  for (const std::string& text : with_) {
    auto with = parseWith(text);
    if (!with) return tl::unexpected(with.error());
    options.with.push_back(*std::move(with));
  }
  if (options.with.empty()) return {};
  if (options.with.size() > 15) return wrong("--with: a picture has 16 models at most");
  if (options.draw != DrawMode::kClip) return wrong("--with is for --draw clip");
  if (options.until && options.until->kind != StopCondition::Kind::kState) {
    return wrong("--with waits for states: --until base, settled, exact or complete");
  }
  if (options.check || !options.svg.empty() || !options.dumpLines.empty() ||
      !options.dumpMesh.empty() || !options.dumpHull.empty() || !options.dumpInnerHull.empty()) {
    return wrong("--with draws pictures: leave out --check, --svg and --dump-…");
  }
  return {};
}

}  // namespace limn
