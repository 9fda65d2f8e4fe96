// SPDX-License-Identifier: Apache-2.0
#include "client/apps/picture_thread.h"

#include "client/apps/drawing_options.h"
#include "client/apps/line_finder.h"
#include "client/apps/output_file.h"
#include "client/apps/svg_file.h"
#include "client/render/image_io.h"
#include "client/render/image_seeds.h"
#include "client/stroke/visibility/resolved_visibility.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace limn {

/// Everything that drawing needs, on the drawing thread. Kept from picture to picture as long as
/// mesh and flags stay.
class PictureThread::Artist {
 public:
  Artist(GlBackend backend, std::filesystem::path assets)
      : backend_(backend),
        assets_(std::move(assets)) {}

  Result<Picture> draw(const PictureOrder& order) {
    const auto begin = std::chrono::steady_clock::now();
    if (auto ready = prepare(order, needsLines(order.look->draw)); !ready) {
      return tl::unexpected(ready.error());
    }
    Picture picture;
    picture.order = order;
    LineFinder::Lines found;
    if (finder_) found = finder_->find(order.camera);
    picture.detectMs = found.detectMs;
    picture.chainMs = found.chainMs;
    picture.segments = found.stats.segments;
    RenderOptions options = renderOptionsOf(*order.look);
    const double scale = order.detail.scale;
    options.viewport.width =
        std::max(1, static_cast<int>(std::lround(scale * order.viewport.width)));
    options.viewport.height =
        std::max(1, static_cast<int>(std::lround(scale * order.viewport.height)));
    options.pixelScale = scale;
    options.supersample = order.detail.supersample;
    auto frame = renderer_->render(*order.snapshot, found.lines, order.camera, options);
    if (!frame) return tl::unexpected(frame.error());
    picture.image = std::move(frame->image);
    picture.timings = frame->timings;
    picture.totalMs =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    return picture;
  }

  Result<void> save(PictureOrder order, const std::filesystem::path& path) {
    order.detail = {};
    if (path.extension() != ".svg") {
      const auto picture = draw(order);
      if (!picture) return tl::unexpected(picture.error());
      return writePng(path, picture->image);
    }
    if (auto ready = prepare(order, true); !ready) return ready;
    const MeshSnapshot& snapshot = *order.snapshot;
    const LineFinder::Lines found = finder_->find(order.camera);
    const VisibilityResolver resolver(snapshot.mesh.mesh(), snapshot.mesh.positions());
    RenderCommandOptions look = *order.look;
    look.viewport = order.viewport;
    look.assets = assets_;
    const auto svg =
        svgFile(look, snapshot.model.name, snapshot, found.lines, resolver, order.camera);
    if (!svg) return tl::unexpected(svg.error());
    return writeOutputFile(path, *svg);
  }

  [[nodiscard]] std::string gl() const { return renderer_ ? renderer_->gl().renderer : ""; }

 private:
  /// Afterwards finder_ is there if lines are needed.
  Result<void> prepare(const PictureOrder& order, bool needsFinder) {
    if (!renderer_) {
      auto renderer = Renderer::open(backend_, assets_);
      if (!renderer) return tl::unexpected(renderer.error());
      renderer_.emplace(*std::move(renderer));
    }
    if (!needsFinder) {
      finder_.reset();
      return {};
    }
    const bool wantsImage = order.look->detector == DetectorMethod::kImage;
    if (wantsImage && (!imageSeeds_ || !isSameSize(order.viewport))) {
      finder_.reset();
      auto made = ImageSeeds::create(backend_, {.viewport = order.viewport});
      if (!made) return tl::unexpected(made.error());
      imageSeeds_ = std::make_unique<ImageSeeds>(*std::move(made));
      imageSize_ = order.viewport;
    }
    if (finder_ && &finder_->snapshot() == order.snapshot.get() && look_ == order.look) return {};
    LineFinderOptions lines = lineOptionsOf(*order.look);
    if (!cones_ || cones_->kind() != lines.silhouette) cones_.emplace(lines.silhouette);
    lines.cones = &*cones_;
    if (wantsImage) {
      lines.imageSeeds = [this](const MeshSnapshot& snapshot, const Camera& camera) {
        return imageSeeds_->find(snapshot, camera);
      };
    }
    finder_.emplace(order.snapshot, lines);
    look_ = order.look;
    return {};
  }

  [[nodiscard]] bool isSameSize(const Viewport& viewport) const {
    return viewport.width == imageSize_.width && viewport.height == imageSize_.height;
  }

  const GlBackend backend_;
  const std::filesystem::path assets_;
  std::optional<Renderer> renderer_;
  std::unique_ptr<ImageSeeds> imageSeeds_;
  Viewport imageSize_;
  std::shared_ptr<const RenderCommandOptions> look_;  // of finder_
  std::optional<ConeKeeper> cones_;
  std::optional<LineFinder> finder_;
};

PictureThread::PictureThread(
    GlBackend backend,
    std::filesystem::path assets,
    std::function<void()> onPicture)
    : backend_(backend),
      assets_(std::move(assets)),
      onPicture_(std::move(onPicture)),
      thread_([this] { work(); }) {}

PictureThread::~PictureThread() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void PictureThread::order(PictureOrder order) {
  {
    const std::lock_guard lock(mutex_);
    order_ = std::move(order);
  }
  wake_.notify_one();
}

std::optional<Picture> PictureThread::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(picture_, std::nullopt);
}

void PictureThread::save(PictureOrder order, std::filesystem::path path) {
  {
    const std::lock_guard lock(mutex_);
    files_.push_back({std::move(order), std::move(path)});
  }
  wake_.notify_one();
}

std::optional<std::string> PictureThread::takeMessage() {
  const std::lock_guard lock(mutex_);
  return std::exchange(message_, std::nullopt);
}

std::string PictureThread::gl() const {
  const std::lock_guard lock(mutex_);
  return gl_;
}

void PictureThread::work() {
  Artist artist(backend_, assets_);
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stopping_ || order_ || !files_.empty(); });
    if (stopping_ && files_.empty()) return;
    if (!files_.empty()) {
      const File file = std::move(files_.front());
      files_.pop_front();
      lock.unlock();
      const auto saved = artist.save(file.order, file.path);
      lock.lock();
      message_ = saved ? "saved " + file.path.string() : saved.error().message;
    } else {
      const PictureOrder order = std::move(*std::exchange(order_, std::nullopt));
      lock.unlock();
      auto picture = artist.draw(order);
      lock.lock();
      gl_ = artist.gl();
      if (picture) {
        picture_ = std::move(*picture);
      } else {
        message_ = picture.error().message;
      }
    }
    lock.unlock();
    onPicture_();
    lock.lock();
  }
}

}  // namespace limn
