// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/silhouette/detector.h"

#include <glm/glm.hpp>

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace limn {

/// Which silhouettes are looked for, and how.
struct DetectorChoice {
  SilhouetteKind silhouette = SilhouetteKind::kSmooth;
  std::optional<glm::dvec3> light;  // model coordinates; unset: as the eye sees them
  DetectorOptions parameters;
};

/// --silhouette, --light and the parameters of the detectors of [Mohr13], as flags of a command.
class DetectorFlags {
 public:
  void addTo(CLI::App& app);

  /// Errors: kInvalidArgument.
  [[nodiscard]] Result<DetectorChoice> parse() const;

 private:
  DetectorOptions options_;
  std::string silhouette_ = "smooth", light_, reseedWith_ = "brute";
};

}  // namespace limn
