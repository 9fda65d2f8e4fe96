// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/session_machine.h"
#include "client/core/session_state.h"
#include "client/pose/orbit.h"
#include "client/render/gl_context.h"
#include "client/render/renderer.h"
#include "client/stroke/chain/surface_lines.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"
#include "shared/silhouette/detector.h"
#include "shared/silhouette/field.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace limn {

/// Where the model comes from: exactly one of the three.
struct SourceOptions {
  std::string serverUrl;
  std::string model;
  std::filesystem::path tokenFile;
  std::filesystem::path caFile;
  std::filesystem::path assetDirectory;
  std::filesystem::path meshFile;
  int quantizationBits = 14;  // of meshFile
  std::string cache;          // of what a server sends: a directory, none, or empty: the usual one
};

/// Which feature lines are drawn.
struct FeatureChoice {
  bool crease = true;
  bool border = true;
  bool seam = true;
  SurfaceLineChoice surface;
};

struct RenderCommandOptions {
  SourceOptions source;

  /// More models in the picture, from the same kind of source.
  struct With {
    std::string model;                // name on the server, asset directory, or mesh file
    std::optional<glm::dvec3> place;  // of its centre, the first model's coordinates; unset: beside
  };

  std::vector<With> with;

  std::optional<Orbit> orbit;  // unset: cameraFile, or Orbit's defaults
  std::filesystem::path cameraFile;
  std::optional<double> fovDegrees;
  bool orthographic = false;
  Viewport viewport;

  std::optional<StopCondition> until;  // unset: settled from a server, complete otherwise
  double errorPx = 1.0;
  std::uint64_t memoryMib = 0;  // for the streamed mesh; 0: no limit

  DrawMode draw = DrawMode::kStrokes;
  std::string detectorName = "exact";  // as reported
  DetectorMethod detector = DetectorMethod::kExact;
  DetectorOptions detectorParameters;
  SilhouetteKind silhouette = SilhouetteKind::kSmooth;
  SessionMachine::Options::Contours contours = SessionMachine::Options::Contours::kOwnMesh;
  std::optional<glm::dvec3> light;  // model coordinates; unset: silhouettes are the eye's
  FeatureChoice features;
  std::string style = "pencil";
  std::optional<double> widthPx;
  std::optional<double> widthModelUnits;
  double widthFalloff = 0.0;
  double textureSize = 1.0;
  Brush brush;
  HiddenLines hidden = HiddenLines::kStyle;
  std::optional<glm::vec3> lineColor;
  double lineFade = 0.0;
  FirstLayer firstLayer = FirstLayer::kAuto;
  GlBackend gl = GlBackend::kEgl;
  std::optional<std::filesystem::path> assets;

  std::uint32_t frames = 1;
  bool orbitPath = false;
  std::filesystem::path recordedPath;  // instead: a camera path that was recorded

  /// Frames differ by their cameras.
  [[nodiscard]] bool moves() const { return orbitPath || !recordedPath.empty(); }

  std::filesystem::path out;
  std::filesystem::path svg;
  std::filesystem::path report;
  std::filesystem::path dumpMesh;
  std::filesystem::path dumpHull;
  std::filesystem::path dumpInnerHull;
  std::uint32_t hullFaces = 500;
  std::filesystem::path dumpLines;
  bool check = false;
  std::filesystem::path reference;  // an asset directory to compare contours with
};

}  // namespace limn
