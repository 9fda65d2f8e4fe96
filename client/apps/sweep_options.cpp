// SPDX-License-Identifier: Apache-2.0
#include "client/apps/sweep_options.h"

#include "client/apps/flag_values.h"
#include "client/apps/source_flags.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <sstream>

namespace limn {
namespace {

constexpr char kExamples[] = R"(
Examples:
  limn-client sweep --mesh horse.ply --csv horse.csv --plot horse.svg
  limn-client sweep --mesh torus-2304.off --mesh torus-8192.ply --detectors brute,cones,random
    --frames 400 --csv tori.csv --plot tori.svg
)";

}  // namespace

void SweepFlags::addTo(CLI::App& app) {
  app.footer(kExamples);
  addServerFlags(app, server_);
  app.add_option("--asset", assets_, "Directories of prepared assets")->group(kSourceGroup);
  app.add_option("--mesh", meshes_, "Mesh files, prepared into a temporary store")
      ->group(kSourceGroup);
  app.add_option("--quantization", quantizationBits_, "Grid bits for --mesh")
      ->check(CLI::Range(11, 18))
      ->group(kSourceGroup);
  app.add_option("--frames", options_.frames, "Frames once around the model (400)")
      ->check(CLI::Range(2U, 100'000U));
  app.add_option("--rounds", options_.rounds, "Sweeps; each frame's best time counts (1)")
      ->check(CLI::Range(1U, 100U));
  app.add_option("--detectors", detectors_, "all, or names between commas (all)");
  app.add_option("--fov", options_.fovDegrees, "Vertical angle of view, degrees (40)")
      ->check(CLI::Range(1.0, 170.0));
  app.add_flag("--ortho", options_.orthographic, "Orthographic");
  pictureFlags_.addTo(
      app,
      {.camera = "orbit:AZIMUTH,ELEVATION[,DISTANCE] of the first frame",
       .size = "Size of the image detector's pictures (1024x1024)",
       .gl = "egl|osmesa, for the image detector"});
  app.add_option("--csv", options_.csv, "Table: a row a mesh, detector and frame");
  app.add_option("--plot", options_.plot, "Plots (SVG)");
  detectorFlags_.addTo(app);
}

Result<SweepCommandOptions> SweepFlags::parse() const {
  SweepCommandOptions options = options_;
  for (const std::string& mesh : meshes_) {
    SourceOptions source;
    source.meshFile = mesh;
    source.quantizationBits = quantizationBits_;
    options.sources.push_back(source);
  }
  for (const std::string& asset : assets_) {
    SourceOptions source;
    source.assetDirectory = asset;
    options.sources.push_back(source);
  }
  if (options.sources.empty() || !server_.serverUrl.empty() || !server_.model.empty()) {
    if (!options.sources.empty()) {
      return wrong("give --mesh and --asset, or --server and --model, not both");
    }
    options.sources.push_back(server_);
  }
  for (const SourceOptions& source : options.sources) {
    if (auto ok = checkSource(source); !ok) return tl::unexpected(ok.error());
  }
  const auto detectors = parseDetectors(detectors_);
  if (!detectors) return tl::unexpected(detectors.error());
  options.detectors = *detectors;
  const auto choice = detectorFlags_.parse();
  if (!choice) return tl::unexpected(choice.error());
  options.parameters = choice->parameters;
  options.silhouette = choice->silhouette;
  options.light = choice->light;
  const auto picture = pictureFlags_.parse();
  if (!picture) return tl::unexpected(picture.error());
  options.orbit = picture->orbit.value_or(options.orbit);
  options.viewport = picture->size.value_or(options.viewport);
  options.gl = picture->gl;
  return options;
}

Result<std::vector<DetectorMethod>> parseDetectors(const std::string& text) {
  const auto all = allDetectors();
  if (text == "all") return std::vector<DetectorMethod>(all.begin(), all.end());
  std::vector<DetectorMethod> detectors;
  std::istringstream list(text + ",");
  std::string name;
  while (std::getline(list, name, ',')) {
    const auto method = detectorFromName(name);
    if (!method)
      return wrong("--detectors " + text + " is unknown: write all, or some of " + detectorNames());
    if (std::find(detectors.begin(), detectors.end(), *method) == detectors.end()) {
      detectors.push_back(*method);
    }
  }
  return detectors;
}

}  // namespace limn
