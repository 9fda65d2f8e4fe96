// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/detector_flags.h"
#include "client/apps/picture_flags.h"
#include "client/apps/render_options.h"
#include "client/pose/orbit.h"
#include "client/render/gl_context.h"

#include "shared/core/result.h"
#include "shared/silhouette/detector.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace limn {

struct SweepCommandOptions {
  std::vector<SourceOptions> sources;  // one a model
  std::vector<DetectorMethod> detectors;
  DetectorOptions parameters;
  SilhouetteKind silhouette = SilhouetteKind::kSmooth;
  std::optional<glm::dvec3> light;  // model coordinates
  Orbit orbit;
  double fovDegrees = 40.0;
  bool orthographic = false;
  std::uint32_t frames = 400;
  std::uint32_t rounds = 1;  // each frame's best time of so many sweeps is kept
  Viewport viewport;         // of what the image detector draws
  GlBackend gl = GlBackend::kEgl;
  std::filesystem::path csv;
  std::filesystem::path plot;
};

/// The flags of `limn-client sweep`.
class SweepFlags {
 public:
  void addTo(CLI::App& app);

  /// Errors: kInvalidArgument, in one line that says what to write instead.
  [[nodiscard]] Result<SweepCommandOptions> parse() const;

 private:
  SweepCommandOptions options_;
  DetectorFlags detectorFlags_;
  SourceOptions server_;
  std::vector<std::string> meshes_;
  std::vector<std::string> assets_;
  int quantizationBits_ = 14;
  std::string detectors_ = "all";
  PictureFlags pictureFlags_;
};

/// Parses `all`, or names of detectors between commas. Errors: kInvalidArgument.
[[nodiscard]] Result<std::vector<DetectorMethod>> parseDetectors(const std::string& text);

}  // namespace limn
