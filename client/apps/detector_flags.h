// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/silhouette/detector.h"

#include <string>

namespace CLI {
class App;
}

namespace limn {

/// The parameters of the detectors of [Mohr13] as flags of a command.
class DetectorFlags {
 public:
  void addTo(CLI::App& app);

  /// Errors: kInvalidArgument.
  [[nodiscard]] Result<DetectorOptions> parse() const;

 private:
  DetectorOptions options_;
  std::string reseedWith_ = "brute";
};

}  // namespace limn
