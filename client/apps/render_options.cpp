// SPDX-License-Identifier: Apache-2.0
#include "client/apps/render_options.h"

#include "client/apps/detector_flags.h"
#include "client/apps/picture_flags.h"
#include "client/apps/source_flags.h"
#include "client/apps/sweep_options.h"
#include "client/apps/view_options.h"
#include "client/net/server_url.h"
#include "client/stroke/style.h"

#include "protocol/limits.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

namespace limn {
namespace {

constexpr int kMaxSize = 8192;

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

tl::unexpected<Error> wrong(const std::string& message) {
  return fail(ErrorCode::kInvalidArgument, message);
}

template <class Number>
std::optional<Number> parseNumber(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Flags as the command line has them, before they are understood.
struct RawFlags {
  std::string until, draw = "strokes", detector = "exact", silhouette = "smooth";
  std::string features = "crease,border,seam", hidden = "style", path, brush = "none";
  std::string assets, out, svg, light, lineColor, firstLayer = "auto";
  std::string widthUnits = "px", contours = "client";
  std::vector<std::string> with;
  std::optional<double> fov, width, brushAmplitude, brushFrequency;
  double widthFalloff = 0.0;
  std::uint32_t brushSeed = 1;
  DetectorFlags detectorFlags;
  PictureFlags pictureFlags;
};

/// Where silhouettes come from, and what that needs.
Result<void> understandContours(const RawFlags& raw, RenderCommandOptions& options) {
  if (raw.contours != "client" && raw.contours != "server") {
    return wrong("--contours " + raw.contours + " is unknown: write client or server");
  }
  if (options.draw == DrawMode::kClip) {
    if (options.light)
      return wrong("--draw clip cuts where the eye sees the outline, not a --light");
    // The outline of a mesh is that of its edges.
    options.silhouette = SilhouetteKind::kEdges;
  }
  if (raw.contours == "client") return {};
  options.contours = SessionMachine::Options::Contours::kServer;
  if (options.source.serverUrl.empty()) {
    return wrong("--contours server needs a --server; files bring the whole mesh");
  }
  if (options.draw != DrawMode::kClip && options.draw != DrawMode::kStrokes) {
    return wrong(
        "--contours server is for --draw clip and strokes: other ways to draw need the mesh");
  }
  if (!raw.until.empty()) {
    return wrong("--contours server holds no mesh, so there is no --until to wait for");
  }
  if (options.check || !raw.svg.empty() || !options.dumpLines.empty()) {
    return wrong("--contours server finds no lines: leave out --check, --svg, --dump-lines");
  }
  return {};
}

/// More models than one.
Result<void> understandScene(const RawFlags& raw, RenderCommandOptions& options) {
  for (const std::string& text : raw.with) {
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

Result<void> understandStrokes(const RawFlags& raw, RenderCommandOptions& options) {
  const auto kind = parseBrushKind(raw.brush);
  if (!kind) return tl::unexpected(kind.error().within("--brush"));
  options.brush = usualBrush(*kind);
  if (raw.brushAmplitude) options.brush.amplitudePx = static_cast<float>(*raw.brushAmplitude);
  if (raw.brushFrequency) {
    options.brush.wavelengthPx = static_cast<float>(100.0 / *raw.brushFrequency);
  }
  options.brush.seed = raw.brushSeed;
  options.widthFalloff = raw.widthFalloff;
  if (raw.widthUnits == "model") {
    if (!raw.width) return wrong("--width-units model needs --width, in the model's units");
    if (!(*raw.width > 0.0)) return wrong("--width is a stroke's width, above 0");
    options.widthModelUnits = raw.width;
    return {};
  }
  if (raw.widthUnits != "px") {
    return wrong("--width-units " + raw.widthUnits + " is unknown: write px or model");
  }
  if (raw.width && !(*raw.width > 0.0 && *raw.width <= 200.0)) {
    return wrong("--width is a stroke's width in pixels, above 0 and up to 200");
  }
  options.widthPx = raw.width;
  return {};
}

Result<void> understandDrawing(const RawFlags& raw, RenderCommandOptions& options) {
  if (const auto mode = parseDrawMode(raw.draw)) {
    options.draw = *mode;
  } else {
    return tl::unexpected(mode.error().within("--draw"));
  }
  options.detectorName = raw.detector;
  if (const auto method = detectorFromName(raw.detector)) {
    options.detector = *method;
  } else {
    return wrong(
        "--detector " + raw.detector +
        " is unknown: write exact, brute, cones, random, coherence-a, coherence-b, image or "
        "precomputed");
  }
  const auto parameters = raw.detectorFlags.parse();
  if (!parameters) return tl::unexpected(parameters.error());
  options.detectorParameters = *parameters;
  if (raw.silhouette == "edges") {
    options.silhouette = SilhouetteKind::kEdges;
  } else if (raw.silhouette != "smooth") {
    return wrong("--silhouette " + raw.silhouette + " is unknown: write smooth or edges");
  }
  if (!raw.light.empty()) {
    const auto light = parseLight(raw.light);
    if (!light) return tl::unexpected(light.error());
    options.light = *light;
    if (options.detector == DetectorMethod::kImage) {
      return wrong("--detector image looks with the camera: give --light another detector");
    }
  }
  if (auto ok = understandStrokes(raw, options); !ok) return ok;
  const auto features = parseFeatures(raw.features);
  if (!features) return tl::unexpected(features.error());
  options.features = *features;
  const auto hidden = parseHiddenLines(raw.hidden);
  if (!hidden) return tl::unexpected(hidden.error());
  options.hidden = *hidden;
  if (!raw.lineColor.empty()) {
    const auto color = parseColor(raw.lineColor);
    if (!color) return tl::unexpected(color.error().within("--line-color"));
    options.lineColor = *color;
  }
  const auto firstLayer = parseFirstLayer(raw.firstLayer);
  if (!firstLayer) return tl::unexpected(firstLayer.error().within("--first-layer"));
  options.firstLayer = *firstLayer;
  if (!raw.assets.empty()) options.assets = raw.assets;
  return {};
}

Result<void> understandView(const RawFlags& raw, RenderCommandOptions& options) {
  const auto picture = raw.pictureFlags.parse();
  if (!picture) return tl::unexpected(picture.error());
  options.orbit = picture->orbit;
  options.viewport = picture->size.value_or(options.viewport);
  options.gl = picture->gl;
  if (options.orbit && !options.cameraFile.empty()) {
    return wrong("give --camera or --camera-file, not both");
  }
  if (raw.fov && !(*raw.fov >= 1.0 && *raw.fov <= 170.0)) {
    return wrong("--fov is the vertical angle of view in degrees, 1 to 170");
  }
  options.fovDegrees = raw.fov;
  if (!raw.until.empty()) {
    const auto until = parseUntil(raw.until);
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
  if (options.frames < 1 || options.frames > 100'000) return wrong("--frames is 1 to 100000");
  if (!raw.path.empty()) {
    options.orbitPath = raw.path == "orbit";
    if (!options.orbitPath) options.recordedPath = raw.path;
    if (std::error_code error; !options.orbitPath && !std::filesystem::exists(raw.path, error)) {
      return wrong("--path " + raw.path + " is no file: write orbit, or a path that view recorded");
    }
    if (options.orbitPath && !options.cameraFile.empty()) {
      return wrong("--path orbit starts at --camera orbit:…, not at a --camera-file");
    }
    if (!options.orbitPath && (!options.cameraFile.empty() || options.orbit)) {
      return wrong(
          "--path " + raw.path + " has its own cameras: leave --camera and --camera-file out");
    }
    if (!raw.out.empty() && options.frames > 1 && !hasFrameNumber(raw.out)) {
      return wrong(
          "--out needs a place for the frame's number: write for instance --out 'f%04d.png'");
    }
    if (!raw.svg.empty() && options.frames > 1 && !hasFrameNumber(raw.svg)) {
      return wrong(
          "--svg needs a place for the frame's number: write for instance --svg 'f%04d.svg'");
    }
  }
  options.out = raw.out;
  options.svg = raw.svg;
  return {};
}

void addRender(CLI::App& app, RenderCommandOptions& o, RawFlags& raw) {
  const auto path = [&app](const char* flag, std::filesystem::path& target, const char* help) {
    return app.add_option(flag, target, help);
  };
  addSourceFlags(app, o.source);

  raw.pictureFlags.addTo(
      app,
      {.camera = "orbit:AZIMUTH,ELEVATION[,DISTANCE], degrees and radii",
       .size = "Picture size (1024x1024)",
       .gl = "egl|osmesa"});
  path("--camera-file", o.cameraFile, R"(JSON {"eye","target","up","fov","ortho"})");
  app.add_option("--fov", raw.fov, "Vertical angle of view, degrees (40)");
  app.add_flag("--ortho", o.orthographic, "Orthographic, with the same extent at the target");
  app.add_option(
      "--until",
      raw.until,
      "base|settled|exact|complete|bytes:N|seconds:S (settled; files: complete)");
  app.add_option("--error-px", o.errorPx, "Error bound of settled, pixels (1)");

  app.add_option(
      "--draw",
      raw.draw,
      "strokes|shaded|clip|image-edges|geometry-shader|conditional-lines|image-precision:wireframe|"
      "…:"
      "translate|…:z-scale|…:offset|…:fatten|…:"
      "charcoal");
  app.add_option(
      "--detector",
      raw.detector,
      "exact|brute|cones|random|coherence-a|coherence-b|image|precomputed");
  app.add_option("--silhouette", raw.silhouette, "smooth|edges");
  app.add_option("--light", raw.light, "X,Y,Z: silhouettes as a light there sees them");
  app.add_option(
      "--features",
      raw.features,
      "crease,border,seam; suggestive,ridge,valley,intersection; or none");
  app.add_option("--style", o.style, "Texture set (pencil)");
  app.add_option("--brush", raw.brush, "none|charcoal|lazy|hand|rough");
  app.add_option("--brush-amplitude", raw.brushAmplitude, "How far it leads off the line, pixels")
      ->check(CLI::Range(0.0, 100.0));
  app.add_option("--brush-frequency", raw.brushFrequency, "Its waves in 100 pixels")
      ->check(CLI::Range(0.1, 100.0));
  app.add_option("--brush-seed", raw.brushSeed, "Of its noise (1)");
  app.add_option("--width", raw.width, "Stroke width, pixels");
  app.add_option("--width-units", raw.widthUnits, "px|model: of --width");
  app.add_option(
         "--width-falloff",
         raw.widthFalloff,
         "Strokes thin out with distance: 0 not (the default), 1 as the model does")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--texture-size", o.textureSize, "Times as long as the style's own texture (1)")
      ->check(CLI::Range(0.1, 10.0));
  app.add_option("--hidden", raw.hidden, "style|off|as-visible");
  app.add_option("--line-color", raw.lineColor, "#rrggbb (the style's); not of strokes");
  app.add_option(
         "--line-fade",
         o.lineFade,
         "Lines pale with distance: 0 not (the default), 1 to nothing; not of strokes")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option(
      "--first-layer",
      raw.firstLayer,
      "auto|winding|numbers: how image-precision tells the front from the rest");
  app.add_option("--assets", raw.assets, "Folder of texture sets");

  app.add_option(
      "--memory",
      o.memoryMib,
      "MiB for the streamed mesh; what no view needs is dropped (no limit)");
  app.add_option("--frames", o.frames, "Frames to draw; times are medians over them (1)");
  app.add_option(
      "--path",
      raw.path,
      "orbit: once around the model in --frames frames; or a file that view has recorded");
  app.add_option("--out", raw.out, "Picture (PNG); with --path, a pattern like f%04d.png");
  app.add_option("--svg", raw.svg, "Strokes as vector paths, in layers (SVG); --path: as --out");
  path("--report", o.report, "Report (JSON)");
  path("--dump-mesh", o.dumpMesh, "The client's mesh (PLY)");
  path("--dump-hull", o.dumpHull, "The outer hull with --hull-faces faces (PLY)");
  path("--dump-inner-hull", o.dumpInnerHull, "The inner hull with --hull-faces faces (PLY)");
  app.add_option(
      "--contours",
      raw.contours,
      "client|server: silhouettes of the mesh held here, or of the whole one, found there "
      "(client)");
  app.add_option(
      "--with",
      raw.with,
      "MODEL[@X,Y,Z]: another model in the picture of --draw clip, its centre at that place "
      "(beside the last); repeated");
  app.add_option("--hull-faces", o.hullFaces, "Faces of the hulls, or as near from below (500)")
      ->check(CLI::Range(4, 1 << 20));
  path("--dump-lines", o.dumpLines, "The lines, with visibility (JSON)");
  app.add_flag("--check", o.check, "Measure recall against brute force, and contour errors");
  path("--reference", o.reference, "Asset directory to compare contours with, for --check");

  raw.detectorFlags.addTo(app);
}

}  // namespace

Result<void> checkSource(const SourceOptions& source) {
  const int sources = (source.serverUrl.empty() ? 0 : 1) + (source.assetDirectory.empty() ? 0 : 1) +
                      (source.meshFile.empty() ? 0 : 1);
  if (sources != 1) {
    return wrong(
        "give one source: --server URL --model NAME, or --asset DIRECTORY, or --mesh FILE");
  }
  if (source.serverUrl.empty()) {
    if (!source.model.empty()) return wrong("--model goes with --server");
    if (!source.tokenFile.empty()) return wrong("--token-file goes with --server");
    if (!source.caFile.empty()) return wrong("--ca-file goes with --server");
    return {};
  }
  if (const auto url = parseServerUrl(source.serverUrl); !url) return tl::unexpected(url.error());
  if (source.model.empty()) return wrong("--server needs --model NAME");
  if (!protocol::isValidModelName(source.model)) {
    return wrong("--model is no name that a model can have");
  }
  return {};
}

Result<CommandLine> parseCommandLine(const std::vector<std::string>& arguments) {
  RenderCommandOptions options;
  RawFlags raw;

  CLI::App app(
      "Draws a mesh as stylised lines, streamed from a server or from a file.",
      "limn-client");
  app.footer(kExamples);
  app.set_version_flag("--version", std::string("limn-client ") + LIMN_VERSION);
  app.require_subcommand(1);
  CLI::App* render = app.add_subcommand("render", "Draw a picture, write reports and dumps");
  render->footer(kExamples);
  addRender(*render, options, raw);
  CLI::App* view = app.add_subcommand("view", "Show a model in a window");
  ViewFlags viewFlags;
  viewFlags.addTo(*view);
  CLI::App* sweep = app.add_subcommand("sweep", "Compare detectors over a camera path");
  SweepFlags sweepFlags;
  sweepFlags.addTo(*sweep);

  try {
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    app.parse(reversed);
  } catch (const CLI::Success& done) {  // --help, --version
    std::ostringstream text;
    std::ostringstream ignored;
    app.exit(done, text, ignored);
    CommandLine line;
    line.print = text.str();
    return line;
  } catch (const CLI::ParseError& error) {
    std::string what = error.what();
    std::replace(what.begin(), what.end(), '\n', ' ');
    if (arguments.empty()) what = "say what to do, for instance render";
    const std::string command = sweep->parsed() ? "sweep" : view->parsed() ? "view" : "render";
    return wrong(what + "; limn-client " + command + " --help has the flags and examples");
  }
  if (view->parsed()) {
    auto parsed = viewFlags.parse();
    if (!parsed) return tl::unexpected(parsed.error());
    CommandLine line;
    line.view = std::make_shared<const ViewCommandOptions>(std::move(*parsed));
    return line;
  }
  if (sweep->parsed()) {
    auto parsed = sweepFlags.parse();
    if (!parsed) return tl::unexpected(parsed.error());
    CommandLine line;
    line.sweep = std::make_shared<const SweepCommandOptions>(std::move(*parsed));
    return line;
  }

  if (auto ok = checkSource(options.source); !ok) return tl::unexpected(ok.error());
  if (auto ok = understandView(raw, options); !ok) return tl::unexpected(ok.error());
  if (auto ok = understandDrawing(raw, options); !ok) return tl::unexpected(ok.error());
  if (auto ok = understandContours(raw, options); !ok) return tl::unexpected(ok.error());
  if (auto ok = understandScene(raw, options); !ok) return tl::unexpected(ok.error());
  if (!options.reference.empty() && !options.check) return wrong("--reference goes with --check");
  if (options.out.empty() && options.svg.empty() && options.report.empty() &&
      options.dumpMesh.empty() && options.dumpLines.empty() && options.dumpHull.empty() &&
      options.dumpInnerHull.empty()) {
    return wrong(
        "nothing to write: give --out, --svg, --report, --dump-mesh, --dump-lines, --dump-hull or "
        "--dump-inner-hull");
  }
  CommandLine line;
  line.render = std::move(options);
  return line;
}

Result<StopCondition> parseUntil(const std::string& text) {
  StopCondition until;
  for (const MeshState state :
       {MeshState::kBase, MeshState::kSettled, MeshState::kExact, MeshState::kComplete}) {
    if (text != nameOf(state)) continue;
    until.state = state;
    return until;
  }
  const std::string_view view = text;
  if (view.starts_with("bytes:")) {
    if (const auto bytes = parseNumber<std::uint64_t>(view.substr(6)); bytes && *bytes > 0) {
      until.kind = StopCondition::Kind::kBytes;
      until.bytes = *bytes;
      return until;
    }
  } else if (view.starts_with("seconds:")) {
    const auto seconds = parseNumber<double>(view.substr(8));
    if (seconds && *seconds > 0.0 && *seconds <= 1e6) {
      until.kind = StopCondition::Kind::kSeconds;
      until.seconds = *seconds;
      return until;
    }
  }
  return wrong(
      "--until " + text +
      " is unknown: write base, settled, exact, complete, bytes:N or seconds:S");
}

Result<Viewport> parseSize(const std::string& text) {
  const std::size_t x = std::min(text.find('x'), text.size());
  const auto width = parseNumber<int>(std::string_view(text).substr(0, x));
  const auto height =
      x < text.size() ? parseNumber<int>(std::string_view(text).substr(x + 1)) : std::nullopt;
  if (!width || !height || *width < 1 || *height < 1 || *width > kMaxSize || *height > kMaxSize) {
    return wrong("--size " + text + " is no size: write WIDTHxHEIGHT in pixels, each 1 to 8192");
  }
  return Viewport{*width, *height};
}

namespace {

/// X,Y,Z.
std::optional<glm::dvec3> parsePlace(const std::string& text) {
  std::istringstream list(text);
  std::string item;
  std::vector<double> numbers;
  while (std::getline(list, item, ',')) {
    const auto number = parseNumber<double>(item);
    if (!number || !std::isfinite(*number)) break;
    numbers.push_back(*number);
  }
  if (numbers.size() != 3 || !list.eof() || text.back() == ',') return std::nullopt;
  return glm::dvec3(numbers[0], numbers[1], numbers[2]);
}

}  // namespace

Result<glm::dvec3> parseLight(const std::string& text) {
  if (const auto place = parsePlace(text)) return *place;
  return wrong("--light " + text + " is no place: write X,Y,Z in the model's coordinates");
}

Result<RenderCommandOptions::With> parseWith(const std::string& text) {
  RenderCommandOptions::With with{text, std::nullopt};
  const std::size_t at = text.rfind('@');
  if (at != std::string::npos && at + 1 < text.size()) {
    with.place = parsePlace(text.substr(at + 1));
    if (with.place) with.model = text.substr(0, at);
  }
  if (with.model.empty() || (at != std::string::npos && !with.place)) {
    return wrong("--with " + text + " is no model and place: write MODEL or MODEL@X,Y,Z");
  }
  return with;
}

Result<FeatureChoice> parseFeatures(const std::string& text) {
  FeatureChoice choice{false, false, false, {}};
  if (text == "none") return choice;
  const std::array<std::pair<const char*, bool*>, 7> names = {{
      {"crease", &choice.crease},
      {"border", &choice.border},
      {"seam", &choice.seam},
      {"suggestive", &choice.surface.suggestive},
      {"ridge", &choice.surface.ridge},
      {"valley", &choice.surface.valley},
      {"intersection", &choice.surface.intersection},
  }};
  std::istringstream list(text);
  std::string item;
  bool isKnown = false;
  while (std::getline(list, item, ',')) {
    isKnown = false;
    for (const auto& [name, flag] : names) {
      if (item != name) continue;
      *flag = true;
      isKnown = true;
    }
    if (!isKnown) break;
  }
  if (!isKnown) {
    return wrong(
        "--features " + text +
        " is unknown: write some of crease,border,seam,suggestive,ridge,valley,intersection, or "
        "none");
  }
  return choice;
}

namespace {

struct NumberPlace {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t digits = 0;
};

/// Finds `%d` or `%0Nd`; the pattern comes from the command line, so it never reaches printf.
std::optional<NumberPlace> findNumber(const std::string& pattern) {
  for (std::size_t i = pattern.find('%'); i != std::string::npos; i = pattern.find('%', i + 1)) {
    if (i + 1 < pattern.size() && pattern[i + 1] == 'd') return NumberPlace{i, i + 2, 0};
    if (i + 3 < pattern.size() && pattern[i + 1] == '0' && pattern[i + 2] >= '1' &&
        pattern[i + 2] <= '9' && pattern[i + 3] == 'd') {
      return NumberPlace{i, i + 4, static_cast<std::size_t>(pattern[i + 2] - '0')};
    }
  }
  return std::nullopt;
}

}  // namespace

bool hasFrameNumber(const std::string& pattern) {
  return findNumber(pattern).has_value();
}

std::string framePath(const std::string& pattern, std::uint32_t index) {
  const auto place = findNumber(pattern);
  if (!place) return pattern;
  std::string number = std::to_string(index);
  if (number.size() < place->digits) number.insert(0, place->digits - number.size(), '0');
  return pattern.substr(0, place->begin) + number + pattern.substr(place->end);
}

}  // namespace limn
