// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/picture_flags.h"
#include "client/apps/render_options.h"
#include "client/view/choices.h"

#include "shared/core/result.h"

#include <filesystem>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace limn {

struct ViewCommandOptions {
  SourceOptions source;  // of a server's models, `model` may be empty: the first one

  /// What the flags say over what is remembered.
  struct {
    std::optional<std::string> draw, detector, silhouette, style, brush, hidden;
    std::optional<double> widthPx, fovDegrees;
    std::optional<int> hullFaces;
    bool orthographic = false;
  } chosen;

  std::optional<Orbit> orbit;
  std::optional<Viewport> size;  // of the window
  double errorPx = 1.0;
  std::uint64_t memoryMib = 0;
  GlBackend gl = GlBackend::kEgl;  // that pictures are drawn with
  std::optional<std::filesystem::path> assets;
  std::filesystem::path saveFolder = ".";
  std::filesystem::path memoryFile;  // of what is remembered
  std::filesystem::path report;      // written at the end
};

/// Flags of `limn-client view`.
class ViewFlags {
 public:
  void addTo(CLI::App& app);
  /// Errors: kInvalidArgument, in one line that says what to write instead.
  [[nodiscard]] Result<ViewCommandOptions> parse() const;

 private:
  ViewCommandOptions options_;
  PictureFlags pictureFlags_;
  std::string assets_;
};

/// The remembered choices with those of the flags over them.
[[nodiscard]] ViewChoices chosenBy(const ViewCommandOptions& options, ViewChoices remembered);

/// A choice as drawing flags, checked like those of `render`. Errors: as RenderFlags::parse().
[[nodiscard]] Result<RenderCommandOptions> understand(
    const ViewChoices& choices,
    const ViewCommandOptions& options);

}  // namespace limn
