// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/view/catalogue.h"
#include "client/view/choices.h"

#include <optional>
#include <string>
#include <vector>

namespace limn {

/// What the menus tell and choose from.
struct MenuFacts {
  std::vector<std::string> styles;
  std::vector<CatalogueEntry> catalogue;  // empty without a server
  std::string model;                      // shown now

  // How far it has come.
  std::string state;        // "partial", "settled", …
  double share = 0.0;       // of the splits, 0 … 1
  std::uint64_t bytes = 0;  // received
  std::size_t faces = 0;    // of the mesh that is drawn
  std::string notice;       // what is being waited for; empty: nothing
  std::string complaint;    // what went wrong; empty: nothing

  // The last picture.
  double detectMs = 0.0, chainMs = 0.0, strokeMs = 0.0, visibilityMs = 0.0, drawMs = 0.0;
  std::size_t segments = 0;
  int width = 0, height = 0, supersample = 0;
  std::string gl;

  std::string message;       // passing: "saved …"
  bool isRecording = false;  // the camera's path
};

/// What the user asked for besides changing the choices.
struct MenuActions {
  std::optional<std::string> model;
  bool home = false;
  bool savePng = false;
  bool saveSvg = false;
  bool copyCommand = false;
  bool record = false;  // begin to, or end it
  bool retry = false;
  bool quit = false;
};

/// The panel at the side, the status line, help; and the keyboard. To be called between a window's
/// beginFrame() and endFrame(). Threads: the window's.
class Menus {
 public:
  [[nodiscard]] MenuActions show(const MenuFacts& facts, ViewChoices& choices);

 private:
  void showKeys();

  bool showsHelp_ = false;
};

}  // namespace limn
