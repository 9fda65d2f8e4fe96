// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/image.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"

#include <memory>
#include <string>

namespace limn {

/// A window of the desktop with a GLES 3 context made through EGL, and Dear ImGui in it: between
/// beginFrame() and endFrame() any ImGui call may be made. One a process. Threads: the main one,
/// except for wake().
class Window {
 public:
  /// Errors: kUnavailable (no display, no GLES 3), saying what to do.
  [[nodiscard]] static Result<std::unique_ptr<Window>> open(
      const std::string& title,
      const Viewport& size);

  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  [[nodiscard]] bool isOpen() const;
  void close();
  void setTitle(const std::string& title);

  /// Sleeps until something happens, at most that long.
  void waitForEvents(double seconds);
  /// Ends a present or the next waitForEvents(). Any thread.
  static void wake();

  void beginFrame();
  /// Fills the window with a picture, as large as the window or not; it stays until the next one.
  void show(const Image& picture);
  void endFrame();

  /// In pixels; 0 × 0 while minimised.
  [[nodiscard]] Viewport size() const;
  /// Pixels for one of the desktop's screen coordinates, in which ImGui counts.
  [[nodiscard]] double pixelRatio() const;

  static double nowSeconds();

 private:
  struct Impl;
  explicit Window(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace limn
