// SPDX-License-Identifier: Apache-2.0
#include "client/apps/view_command.h"

#include "client/apps/catalogue_watch.h"
#include "client/apps/drawing_options.h"
#include "client/apps/interrupt.h"
#include "client/apps/output_file.h"
#include "client/apps/picture_thread.h"
#include "client/apps/view_files.h"
#include "client/apps/viewed_model.h"
#include "client/pose/camera_file.h"
#include "client/render/assets.h"
#include "client/view/detail.h"
#include "client/view/menus.h"
#include "client/view/orbit_controls.h"
#include "client/view/pick.h"
#include "client/view/window.h"

#include <imgui.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace limn {
namespace {

constexpr double kPictureBudgetMs = 50.0;
constexpr double kRestAfterSeconds = 0.25;  // without movement the best picture is drawn
constexpr double kMessageSeconds = 6.0;
constexpr double kIdleSeconds = 0.1;  // between looks at what has arrived

ViewMemory recall(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  return viewMemoryFromJson(text);
}

/// What the window did, for `--report`.
struct Tally {
  std::uint32_t pictures = 0;
  double longestPictureMs = 0.0;
  double longestBlockMs = 0.0;  // without looking at the window's events
  std::string state;
};

class Viewer {
 public:
  Viewer(const ViewCommandOptions& options, std::filesystem::path assets)
      : options_(options),
        memory_(recall(options.memoryFile)),
        files_(options.saveFolder),
        pictures_(options.gl, assets, &Window::wake),
        model_(options_, &Window::wake) {
    memory_.choices = chosenBy(options, memory_.choices);
    if (options.size) {
      memory_.width = options.size->width;
      memory_.height = options.size->height;
    }
    facts_.styles = listStyles(assets);
  }

  Result<void> run() {
    auto window = Window::open("Limn", {memory_.width, memory_.height});
    if (!window) return tl::unexpected(window.error());
    window_ = std::move(*window);
    if (auto ok = begin(); !ok) return ok;
    while (window_->isOpen() && !interrupted()) {
      window_->waitForEvents(isAnimating_ ? 0.0 : kIdleSeconds);
      const double begin = Window::nowSeconds();
      frame();
      tally_.longestBlockMs =
          std::max(tally_.longestBlockMs, 1000.0 * (Window::nowSeconds() - begin));
    }
    watch_.reset();
    tally_.state = nameOf(model_.progress().state);
    return finish();
  }

 private:
  Result<void> begin() {
    if (options_.source.serverUrl.empty()) {
      // The name of a file is what a user would look for.
      const SourceOptions& source = options_.source;
      model_.open(
          source.meshFile.empty() ? source.assetDirectory.filename().string()
                                  : source.meshFile.stem().string());
      return {};
    }
    auto server = serverOf(options_.source);
    if (!server) return tl::unexpected(server.error());
    watch_ = std::make_unique<CatalogueWatch>(std::move(*server), &Window::wake);
    if (!options_.source.model.empty()) model_.open(options_.source.model);
    return {};
  }

  void frame() {
    takeCatalogue();
    model_.poll();
    if (controls_ == nullptr && model_.description() != nullptr) meetModel();
    if (auto picture = pictures_.take()) {
      governor_.learn(picture->order.detail, picture->totalMs);
      ++tally_.pictures;
      tally_.longestPictureMs = std::max(tally_.longestPictureMs, picture->totalMs);
      window_->show(picture->image);
      shown_ = std::move(picture);
    }
    takeMessages();
    window_->beginFrame();
    gestures();
    learnFacts();
    const ViewChoices before = memory_.choices;
    act(menus_.show(facts_, memory_.choices));
    if (memory_.choices != before || !look_) changeLook(before);
    window_->endFrame();
    orderPicture();
  }

  void takeCatalogue() {
    if (!watch_) return;
    if (auto entries = watch_->take()) facts_.catalogue = std::move(*entries);
    if (!model_.name().empty()) return;
    // Nobody has chosen a model: the first one that is ready.
    for (const CatalogueEntry& entry : facts_.catalogue) {
      if (entry.state == CatalogueEntry::State::kReady) return openModel(entry.name);
    }
  }

  void openModel(const std::string& name) {
    if (files_.isRecording()) record();  // a path is of one model
    model_.open(name);
    controls_.reset();
    ordered_.reset();
    window_->setTitle("Limn");
  }

  void meetModel() {
    const ModelDescription& model = *model_.description();
    controls_ = std::make_unique<OrbitControls>(model.sphere);
    if (options_.orbit) {
      const Orbit& orbit = *options_.orbit;
      controls_->look(orbitCamera(
          model.sphere,
          orbit.azimuthDegrees,
          orbit.elevationDegrees,
          orbit.distanceRadii));
    }
    window_->setTitle("Limn: " + model_.name());
    applyLens();
    look_.reset();  // a light's place depends on the model
  }

  void applyLens() {
    if (!controls_) return;
    controls_->setFov(memory_.choices.fovDegrees);
    controls_->setOrthographic(memory_.choices.orthographic);
  }

  void gestures() {
    isAnimating_ = false;
    const ImGuiIO& io = ImGui::GetIO();
    if (!controls_) return;
    const double now = Window::nowSeconds();
    const Viewport desk{static_cast<int>(io.DisplaySize.x), static_cast<int>(io.DisplaySize.y)};
    const glm::dvec2 moved(io.MouseDelta.x, io.MouseDelta.y);
    const glm::dvec2 pointer(io.MousePos.x, io.MousePos.y);
    if (!io.WantCaptureMouse && desk.width > 0 && desk.height > 0) {
      const bool isMoved = moved.x != 0.0 || moved.y != 0.0;
      if (io.MouseDown[0] && isMoved) controls_->rotate(moved, desk);
      if ((io.MouseDown[1] || io.MouseDown[2]) && isMoved) controls_->pan(moved, desk);
      if (io.MouseWheel != 0.0F) controls_->zoom(io.MouseWheel, pointer, desk);
      if (ImGui::IsMouseDoubleClicked(0)) flyTo(pointer, desk, now);
    }
    isAnimating_ = controls_->animate(now);
    files_.record(now, controls_->camera());
  }

  void flyTo(const glm::dvec2& pointer, const Viewport& desk, double now) {
    const auto snapshot = model_.snapshot();
    if (!snapshot) return;
    if (const auto point = pick(*snapshot, rayThrough(controls_->camera(), pointer, desk)))
      controls_->flyTo(*point, now);
  }

  void learnFacts() {
    const ClientSession::Progress progress = model_.progress();
    facts_.model = model_.name();
    facts_.state = nameOf(progress.state);
    facts_.share = progress.splitsTotal == 0
                       ? 0.0
                       : static_cast<double>(progress.splitsHeld) / progress.splitsTotal;
    facts_.bytes = progress.bytes.received;
    facts_.notice = progress.notice;
    facts_.complaint = model_.complaint();
    if (facts_.complaint.empty() && watch_ && model_.name().empty())
      facts_.complaint = watch_->complaint();
    if (Window::nowSeconds() > messageUntil_) facts_.message.clear();
    facts_.gl = pictures_.gl();
    facts_.isRecording = files_.isRecording();
    if (!shown_) return;
    facts_.faces = shown_->order.snapshot->mesh.mesh().faceCount();
    facts_.detectMs = shown_->detectMs;
    facts_.chainMs = shown_->chainMs;
    facts_.strokeMs = shown_->timings.strokeMs;
    facts_.visibilityMs = shown_->timings.visibilityMs;
    facts_.drawMs = shown_->timings.drawMs;
    facts_.segments = shown_->segments;
    facts_.width = shown_->image.width;
    facts_.height = shown_->image.height;
    facts_.supersample = shown_->order.detail.supersample;
  }

  void act(const MenuActions& actions) {
    if (actions.model && *actions.model != model_.name()) openModel(*actions.model);
    if (actions.retry) openModel(model_.name());
    if (actions.home && controls_) controls_->home();
    if (actions.savePng) save(".png");
    if (actions.saveSvg) save(".svg");
    if (actions.copyCommand) copyCommand();
    if (actions.record) record();
    if (actions.quit) window_->close();
  }

  void save(const char* extension) {
    if (!ordered_) return say("there is nothing to save yet");
    pictures_.save(*ordered_, files_.name(model_.name(), extension));
  }

  /// Begins, or ends and writes what was recorded.
  void record() {
    if (!files_.isRecording()) {
      if (controls_) files_.beginRecording();
      return;
    }
    const auto file = files_.endRecording(model_.name());
    if (!file) return say(file.error().message);
    if (*file) say("saved " + (*file)->string());
  }

  void copyCommand() {
    if (!controls_) return;
    const std::filesystem::path file = options_.saveFolder / (model_.name() + "-camera.json");
    if (auto written = writeOutputFile(file, cameraFileJson(controls_->camera()) + "\n"); !written)
      return say(written.error().message);
    const std::string command =
        renderCommand(options_.source, model_.name(), memory_.choices, file);
    ImGui::SetClipboardText(command.c_str());
    say("copied; the camera is in " + file.string());
  }

  void say(const std::string& message) {
    facts_.message = message;
    messageUntil_ = Window::nowSeconds() + kMessageSeconds;
  }

  void takeMessages() {
    if (auto message = pictures_.takeMessage()) say(*message);
  }

  /// Choices that make no sense (a texture set that is gone) go back to what was before.
  void changeLook(const ViewChoices& before) {
    auto look = understand(memory_.choices, options_);
    if (!look) {
      say(look.error().message);
      const bool wasFirst = !look_;
      memory_.choices = wasFirst ? ViewChoices{} : before;
      look = understand(memory_.choices, options_);
      if (!look) return;
    }
    if (memory_.choices.hasLight && model_.description() != nullptr) {
      const BoundingSphere& sphere = model_.description()->sphere;
      look->light =
          orbitCamera(sphere, memory_.choices.lightAzimuth, memory_.choices.lightElevation).eye;
    }
    look_ = std::make_shared<const RenderCommandOptions>(std::move(*look));
    applyLens();
  }

  void orderPicture() {
    const auto snapshot = model_.snapshot();
    const Viewport size = window_->size();
    if (!controls_ || !snapshot || !look_ || size.width == 0 || size.height == 0) return;
    const Camera camera = controls_->camera();
    const double now = Window::nowSeconds();
    if (!ordered_ || isMoved(ordered_->camera, camera)) movedAt_ = now;
    const bool isMoving = now - movedAt_ < kRestAfterSeconds;
    PictureOrder order{snapshot, look_, camera, size, governor_.choose(isMoving)};
    if (ordered_ && ordered_->snapshot == order.snapshot && ordered_->look == order.look &&
        !isMoved(ordered_->camera, camera) && ordered_->viewport.width == size.width &&
        ordered_->viewport.height == size.height && ordered_->detail == order.detail) {
      return;
    }
    ClientView view;
    view.camera = camera;
    view.viewport = size;
    view.errorPx = static_cast<float>(options_.errorPx);
    view.silhouette = wantedSilhouette(*look_);
    if (look_->draw == DrawMode::kClip) view.hullFaces = look_->hullFaces;
    model_.setView(view);
    ordered_ = order;
    pictures_.order(std::move(order));
  }

  static bool isMoved(const Camera& a, const Camera& b) {
    return a.eye != b.eye || a.target != b.target || a.fovDegrees != b.fovDegrees ||
           a.orthographic != b.orthographic;
  }

  Result<void> finish() {
    const double ratio = window_->pixelRatio();
    const Viewport size = window_->size();
    if (size.width > 0) {
      memory_.width = static_cast<int>(std::lround(size.width / ratio));
      memory_.height = static_cast<int>(std::lround(size.height / ratio));
    }
    if (!options_.memoryFile.empty()) {
      std::error_code ignored;
      std::filesystem::create_directories(options_.memoryFile.parent_path(), ignored);
      if (auto ok = writeOutputFile(options_.memoryFile, toJson(memory_)); !ok) return ok;
    }
    if (options_.report.empty()) return {};
    const nlohmann::ordered_json report = {
        {"model", model_.name()},
        {"state", tally_.state},
        {"pictures", tally_.pictures},
        {"longest_picture_ms", tally_.longestPictureMs},
        {"longest_block_ms", tally_.longestBlockMs},
        {"saved", files_.named()}};
    return writeOutputFile(options_.report, report.dump(2) + "\n");
  }

  const ViewCommandOptions& options_;
  ViewMemory memory_;
  MenuFacts facts_;
  Menus menus_;
  Tally tally_;
  ViewFiles files_;
  std::unique_ptr<Window> window_;  // outlives what wakes it
  PictureThread pictures_;
  ViewedModel model_;
  std::unique_ptr<CatalogueWatch> watch_;
  std::unique_ptr<OrbitControls> controls_;  // null until a model is known
  DetailGovernor governor_{kPictureBudgetMs};
  std::shared_ptr<const RenderCommandOptions> look_;
  std::optional<PictureOrder> ordered_;
  std::optional<Picture> shown_;
  double movedAt_ = 0.0;
  double messageUntil_ = 0.0;
  bool isAnimating_ = false;
};

}  // namespace

Result<void> runView(const ViewCommandOptions& options) {
  watchForInterrupts();
  auto assets = findAssets(options.assets);
  if (!assets) return tl::unexpected(assets.error());
  return Viewer(options, std::move(*assets)).run();
}

}  // namespace limn
