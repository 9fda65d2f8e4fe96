// SPDX-License-Identifier: Apache-2.0
#include "client/apps/scene_command.h"

#include "client/apps/drawing_options.h"
#include "client/apps/frame_path.h"
#include "client/apps/interrupt.h"
#include "client/apps/line_finder.h"
#include "client/apps/output_file.h"
#include "client/apps/progress_line.h"
#include "client/apps/render_views.h"
#include "client/apps/report.h"
#include "client/apps/session_options.h"
#include "client/apps/source.h"
#include "client/apps/watch_session.h"
#include "client/core/client_session.h"
#include "client/render/image_io.h"
#include "client/render/renderer.h"
#include "client/render/scene.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace limn {
namespace {

/// Free space between models that are placed beside one another, of their radii.
constexpr double kGap = 0.05;

/// One model: its stream, and its lines as they are found.
class Actor {
 public:
  /// Begins to stream.
  static Result<std::unique_ptr<Actor>> start(
      const RenderCommandOptions& options,
      const SourceOptions& from) {
    auto source = openSource(from);
    if (!source) return tl::unexpected(source.error());
    return std::make_unique<Actor>(options, *std::move(source));
  }

  Actor(const RenderCommandOptions& options, Source source)
      : options_(options),
        source_(std::move(source)),
        until_(sessionOptionsOf(source_, options).session.stop),
        cones_(options.silhouette),
        session_(source_.connect, sessionOptions()) {}

  Result<ModelDescription> description(ProgressLine& progress) {
    return watchSession(session_, progress, [&](std::uint64_t ms) {
      return session_.waitForModel(ms);
    });
  }

  void look(const Camera& camera) {
    camera_ = seenFrom(camera, place);
    session_.setView(viewOf(options_, until_, camera_));
  }

  /// Waits until the view is served, and finds its lines.
  Result<void> appear(ProgressLine& progress) {
    auto outcome = watchSession(session_, progress, [&](std::uint64_t ms) {
      return session_.waitForState(until_.state, ms);
    });
    if (!outcome) return tl::unexpected(outcome.error());
    if (outcome->snapshot != outcome_.snapshot) finder_.reset();
    outcome_ = *std::move(outcome);
    if (auto ok = checkHull(*outcome_.snapshot, options_); !ok) return ok;
    if (options_.contours == SessionMachine::Options::Contours::kServer) return {};
    if (!finder_) {
      LineFinderOptions lines = lineOptionsOf(options_);
      lines.cones = &cones_;
      finder_.emplace(outcome_.snapshot, lines);
    }
    found_ = finder_->find(camera_);
    return {};
  }

  [[nodiscard]] SceneObject object() const { return {*outcome_.snapshot, found_.lines, place}; }

  [[nodiscard]] const SessionOutcome& outcome() const { return outcome_; }

  [[nodiscard]] const LineFinder::Lines& found() const { return found_; }

  [[nodiscard]] const std::string& name() const { return source_.model; }

  glm::dvec3 place{0.0};  // of its origin, in the scene

 private:
  /// Views follow one another, so the session itself does not end.
  [[nodiscard]] ClientSession::Options sessionOptions() const {
    ClientSession::Options session = sessionOptionsOf(source_, options_);
    session.session.stop.kind = StopCondition::Kind::kNever;
    return session;
  }

  const RenderCommandOptions& options_;
  const Source source_;
  const StopCondition until_;
  ConeKeeper cones_;
  ClientSession session_;
  SessionOutcome outcome_;
  Camera camera_;
  std::optional<LineFinder> finder_;
  LineFinder::Lines found_;
};

SourceOptions sourceOf(SourceOptions source, const std::string& model) {
  if (!source.serverUrl.empty()) {
    source.model = model;
  } else if (!source.assetDirectory.empty()) {
    source.assetDirectory = model;
  } else {
    source.meshFile = model;
  }
  return source;
}

/// The first where its own coordinates have it, others where they are wanted, else to the right.
std::vector<BoundingSphere> placeAll(
    const RenderCommandOptions& options,
    const std::vector<BoundingSphere>& own,
    std::vector<std::unique_ptr<Actor>>& actors) {
  std::vector<BoundingSphere> placed = {own.front()};
  for (std::size_t i = 1; i < own.size(); ++i) {
    const BoundingSphere& last = placed.back();
    const double away = (1.0 + kGap) * (last.radius + own[i].radius);
    const glm::dvec3 center =
        options.with[i - 1].place.value_or(last.center + glm::dvec3(away, 0.0, 0.0));
    actors[i]->place = center - own[i].center;
    placed.push_back({center, own[i].radius});
  }
  return placed;
}

}  // namespace

Result<void> runScene(const RenderCommandOptions& options) {
  ProgressLine progress;
  std::vector<std::unique_ptr<Actor>> actors;
  for (std::size_t i = 0; i <= options.with.size(); ++i) {
    auto actor = Actor::start(
        options,
        i == 0 ? options.source : sourceOf(options.source, options.with[i - 1].model));
    if (!actor) return tl::unexpected(actor.error());
    actors.push_back(*std::move(actor));
  }
  std::vector<BoundingSphere> own;
  for (const auto& actor : actors) {
    const auto model = actor->description(progress);
    if (!model) return tl::unexpected(model.error());
    noteMissingHull(*model, options);
    own.push_back(model->sphere);
  }
  const BoundingSphere around = sphereAround(placeAll(options, own, actors));
  const auto path = camerasOf(options, around);
  if (!path) return tl::unexpected(path.error());
  auto renderer = Renderer::open(options.gl, options.assets);
  if (!renderer) return tl::unexpected(renderer.error());

  RenderReport report;
  for (std::uint32_t frame = 0; frame < options.frames; ++frame) {
    if (interrupted()) return fail(ErrorCode::kCancelled, "stopped on request");
    const Camera& camera = (*path)[frame];
    for (const auto& actor : actors)
      actor->look(camera);
    std::vector<SceneObject> objects;
    FrameTimes times;
    for (const auto& actor : actors) {
      if (auto ok = actor->appear(progress); !ok) return ok;
      objects.push_back(actor->object());
      times.detect += actor->found().detectMs;
      times.chain += actor->found().chainMs;
    }
    const auto drawn = renderer->renderScene(objects, camera, renderOptionsOf(options));
    if (!drawn) return tl::unexpected(drawn.error());
    times.stroke = drawn->timings.strokeMs;
    times.visibility = drawn->timings.visibilityMs;
    times.draw = drawn->timings.drawMs;
    report.frames.push_back(times);
    if (options.out.empty() || (!options.moves() && frame + 1 < options.frames)) continue;
    if (auto ok = writePng(framePath(options.out.string(), frame), drawn->image); !ok) return ok;
  }
  if (options.report.empty()) return {};
  // The first model's, but for the bytes, which are those of all.
  SessionOutcome outcome = actors.front()->outcome();
  for (std::size_t i = 1; i < actors.size(); ++i)
    outcome.bytes += actors[i]->outcome().bytes;
  report.outcome = &outcome;
  report.modelName = actors.front()->name();
  report.detectorName = options.detectorName;
  report.stats = actors.front()->found().stats;
  report.loops = actors.front()->found().loops;
  report.gl = renderer->gl();
  return writeOutputFile(options.report, reportJson(report));
}

}  // namespace limn
