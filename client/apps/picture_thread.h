// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/render_options.h"
#include "client/core/snapshot.h"
#include "client/render/renderer.h"
#include "client/view/detail.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace limn {

/// A picture to be drawn.
struct PictureOrder {
  std::shared_ptr<const MeshSnapshot> snapshot;
  std::shared_ptr<const RenderCommandOptions> look;  // its drawing flags; the rest is not read
  Camera camera;
  Viewport viewport;
  Detail detail;
};

struct Picture {
  Image image;
  PictureOrder order;
  double detectMs = 0.0;
  double chainMs = 0.0;
  FrameTimings timings;
  double totalMs = 0.0;
  std::size_t segments = 0;
};

/// Draws on a thread of its own, with a context of its own, so that no mesh, however large, keeps
/// a window from answering: the newest order wins, the last picture stays until the next is there.
/// Threads: every public method from any one thread.
class PictureThread {
 public:
  /// onPicture: called on the drawing thread when a picture, a file or a failure is there.
  PictureThread(GlBackend backend, std::filesystem::path assets, std::function<void()> onPicture);
  /// Finishes the picture in hand and the files asked for.
  ~PictureThread();
  PictureThread(const PictureThread&) = delete;
  PictureThread& operator=(const PictureThread&) = delete;

  void order(PictureOrder order);
  /// The newest picture, once.
  [[nodiscard]] std::optional<Picture> take();

  /// Draws into a file, at the best detail: PNG, or SVG with visibility resolved, by the extension.
  void save(PictureOrder order, std::filesystem::path path);
  /// One line about what became of a file or a picture, once: where it was saved, or why not.
  [[nodiscard]] std::optional<std::string> takeMessage();

  /// GL_RENDERER; empty before the first picture.
  [[nodiscard]] std::string gl() const;

 private:
  class Artist;

  struct File {
    PictureOrder order;
    std::filesystem::path path;
  };

  void work();

  const GlBackend backend_;
  const std::filesystem::path assets_;
  const std::function<void()> onPicture_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<PictureOrder> order_;
  std::deque<File> files_;
  std::optional<Picture> picture_;
  std::optional<std::string> message_;
  std::string gl_;
  bool stopping_ = false;

  std::thread thread_;  // last: it uses everything above
};

}  // namespace limn
