// SPDX-License-Identifier: Apache-2.0
#include "client/apps/view_options.h"

#include "client/apps/flag_values.h"
#include "client/apps/render_flags.h"
#include "client/apps/source_flags.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

namespace limn {
namespace {

/// Where the desktop keeps what programs remember (XDG base directories).
std::filesystem::path usualMemoryFile() {
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && *state == '/') return std::filesystem::path(state) / "limn/view.json";
  const char* home = std::getenv("HOME");
  if (home == nullptr || *home == '\0') return {};
  return std::filesystem::path(home) / ".local/state/limn/view.json";
}

}  // namespace

void ViewFlags::addTo(CLI::App& app) {
  ViewCommandOptions& o = options_;
  addSourceFlags(app, o.source);

  pictureFlags_.addTo(
      app,
      {.camera = "orbit:AZIMUTH,ELEVATION[,DISTANCE], degrees and radii",
       .size = "Window size (as last time)",
       .gl = "egl|osmesa: what pictures are drawn with"});
  app.add_option("--error-px", o.errorPx, "Error bound of settled, pixels (1)")
      ->check(CLI::Range(0.1, 64.0));
  app.add_option("--memory", o.memoryMib, "MiB for the streamed mesh (no limit)")
      ->check(CLI::Range(0, 1 << 20));

  constexpr char kLook[] = "To begin with (all of it can be changed in the menus)";
  app.add_option("--draw", o.chosen.draw, "As render's")->group(kLook);
  app.add_option("--detector", o.chosen.detector, "As render's")->group(kLook);
  app.add_option("--silhouette", o.chosen.silhouette, "smooth|edges")->group(kLook);
  app.add_option("--style", o.chosen.style, "Texture set")->group(kLook);
  app.add_option("--brush", o.chosen.brush, "none|charcoal|lazy|hand|rough")->group(kLook);
  app.add_option("--hidden", o.chosen.hidden, "style|off|as-visible")->group(kLook);
  app.add_option("--hull-faces", o.chosen.hullFaces, "Faces of clip's hull (500)")
      ->check(CLI::Range(kLeastHullFaces, kMostHullFaces))
      ->group(kLook);
  app.add_option("--width", o.chosen.widthPx, "Stroke width, pixels")
      ->check(CLI::Range(0.1, 50.0))
      ->group(kLook);
  app.add_option("--fov", o.chosen.fovDegrees, "Vertical angle of view, degrees")
      ->check(CLI::Range(5.0, 120.0))
      ->group(kLook);
  app.add_flag("--ortho", o.chosen.orthographic, "Orthographic")->group(kLook);

  app.add_option("--assets", assets_, "Folder of texture sets");
  app.add_option("--save-to", o.saveFolder, "Folder for saved pictures (the present one)");
  app.add_option("--remember", o.memoryFile, "File of what is remembered");
  app.add_option("--report", o.report, "Report (JSON), written at the end");
}

Result<ViewCommandOptions> ViewFlags::parse() const {
  ViewCommandOptions options = options_;
  SourceOptions source = options.source;
  // The catalogue names a model where the command line does not.
  if (!source.serverUrl.empty() && source.model.empty()) source.model = "model";
  if (auto ok = checkSource(source); !ok) return tl::unexpected(ok.error());
  const auto picture = pictureFlags_.parse();
  if (!picture) return tl::unexpected(picture.error());
  options.orbit = picture->orbit;
  options.size = picture->size;
  options.gl = picture->gl;
  if (!assets_.empty()) options.assets = assets_;
  if (options.memoryFile.empty()) options.memoryFile = usualMemoryFile();
  if (auto ok = understand(chosenBy(options, {}), options); !ok) return tl::unexpected(ok.error());
  return options;
}

ViewChoices chosenBy(const ViewCommandOptions& options, ViewChoices choices) {
  const auto take = [](const auto& from, auto& to) {
    if (from) to = *from;
  };
  const auto& chosen = options.chosen;
  take(chosen.draw, choices.draw);
  take(chosen.detector, choices.detector);
  take(chosen.silhouette, choices.silhouette);
  take(chosen.style, choices.style);
  take(chosen.brush, choices.brush);
  take(chosen.hidden, choices.hidden);
  take(chosen.widthPx, choices.widthPx);
  take(chosen.hullFaces, choices.hullFaces);
  take(chosen.fovDegrees, choices.fovDegrees);
  choices.orthographic = choices.orthographic || chosen.orthographic;
  return choices;
}

Result<RenderCommandOptions> understand(
    const ViewChoices& choices,
    const ViewCommandOptions& options) {
  CLI::App app;
  RenderFlags flags;
  flags.addTo(app);
  std::vector<std::string> words = flagsOf(choices);
  // Any source and output: only the drawing flags are used.
  words.insert(words.end(), {"--asset", ".", "--out", "view.png"});
  std::ranges::reverse(words);
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    return wrong(error.what());
  }
  auto look = flags.parse();
  if (!look) return tl::unexpected(look.error());
  look->gl = options.gl;
  look->assets = options.assets;
  return *std::move(look);
}

}  // namespace limn
