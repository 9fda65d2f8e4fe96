// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/detector_flags.h"
#include "client/apps/picture_flags.h"
#include "client/apps/render_options.h"

#include "shared/core/result.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace limn {

/// The flags of `limn-client render`.
class RenderFlags {
 public:
  void addTo(CLI::App& app);

  /// Errors: kInvalidArgument and kUnsupported, in one line that says what to write instead.
  [[nodiscard]] Result<RenderCommandOptions> parse() const;

 private:
  // Each fills in what it is named after; parse() calls them in this order.
  [[nodiscard]] Result<void> parseView(RenderCommandOptions& options) const;
  [[nodiscard]] Result<void> parseDrawing(RenderCommandOptions& options) const;
  [[nodiscard]] Result<void> parseStrokes(RenderCommandOptions& options) const;
  /// Where silhouettes come from, and what that needs.
  [[nodiscard]] Result<void> parseContours(RenderCommandOptions& options) const;
  /// More models than one.
  [[nodiscard]] Result<void> parseScene(RenderCommandOptions& options) const;

  RenderCommandOptions options_;  // what needs no understanding

  // As the command line has them.
  std::string until_, draw_ = "strokes", detector_ = "exact";
  std::string features_ = "crease,border,seam", hidden_ = "style", path_, brush_ = "none";
  std::string assets_, out_, svg_, lineColor_, firstLayer_ = "auto";
  std::string widthUnits_ = "px", contours_ = "client";
  std::vector<std::string> with_;
  std::optional<double> fov_, width_, brushAmplitude_, brushFrequency_;
  double widthFalloff_ = 0.0;
  std::uint32_t brushSeed_ = 1;
  DetectorFlags detectorFlags_;
  PictureFlags pictureFlags_;
};

}  // namespace limn
