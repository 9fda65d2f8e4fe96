// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace limn {

/// What the menus choose. Names are the values of `limn-client render`'s flags, so that a view can
/// be drawn again from the command line and is checked by the same code.
struct ViewChoices {
  std::string draw = "strokes";
  std::string detector = "exact";
  std::string silhouette = "smooth";
  std::string features = "crease,border,seam";
  std::string style = "pencil";
  std::string brush = "none";
  std::string hidden = "style";
  int hullFaces = 500;   // of clip
  double widthPx = 0.0;  // 0: the style's own
  double textureSize = 1.0;
  bool orthographic = false;
  double fovDegrees = 40.0;
  /// Silhouettes as a light sees them, which turns about the model's centre, three radii away.
  bool hasLight = false;
  double lightAzimuth = 45.0;
  double lightElevation = 45.0;
  bool showsMenu = true;
  bool showsTimings = false;

  friend bool operator==(const ViewChoices&, const ViewChoices&) = default;
};

/// Of ViewChoices::hullFaces.
inline constexpr int kLeastHullFaces = 100;
inline constexpr int kMostHullFaces = 20'000;

/// The flags that draw it so; --light is not among them, since it is a place in the model.
[[nodiscard]] std::vector<std::string> flagsOf(const ViewChoices& choices);

/// Whether a list like `features` has a word, and the list with it or without.
[[nodiscard]] bool hasWord(std::string_view list, std::string_view word);
[[nodiscard]] std::string toggled(const std::string& list, std::string_view word);

/// What a window remembers until the next time.
struct ViewMemory {
  ViewChoices choices;
  int width = 1280;  // screen coordinates
  int height = 860;
};

[[nodiscard]] std::string toJson(const ViewMemory& memory);
/// Whatever is missing or makes no sense is as it was in the beginning: a damaged memory is no
/// reason not to start.
[[nodiscard]] ViewMemory viewMemoryFromJson(std::string_view json);

}  // namespace limn
