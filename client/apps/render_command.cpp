// SPDX-License-Identifier: Apache-2.0
#include "client/apps/render_command.h"

#include "client/apps/contour_check.h"
#include "client/apps/contour_lines.h"
#include "client/apps/drawing_options.h"
#include "client/apps/dumps.h"
#include "client/apps/frame_path.h"
#include "client/apps/interrupt.h"
#include "client/apps/line_finder.h"
#include "client/apps/output_file.h"
#include "client/apps/progress_line.h"
#include "client/apps/render_views.h"
#include "client/apps/report.h"
#include "client/apps/scene_command.h"
#include "client/apps/session_options.h"
#include "client/apps/source.h"
#include "client/apps/svg_file.h"
#include "client/apps/watch_session.h"
#include "client/core/client_session.h"
#include "client/render/image_io.h"
#include "client/render/image_seeds.h"
#include "client/render/renderer.h"
#include "client/stroke/visibility/resolved_visibility.h"

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace limn {
namespace {

/// The renderer, made when it is first needed.
class Painter {
 public:
  explicit Painter(const RenderCommandOptions& options) : options_(options) {}

  Result<Frame> draw(const MeshSnapshot& snapshot, const PolylineSet& lines, const Camera& camera) {
    if (!renderer_) {
      auto made = make();
      if (!made) return tl::unexpected(made.error());
    }
    return renderer_->render(snapshot, lines, camera, renderOptionsOf(options_));
  }

  [[nodiscard]] std::optional<GlDescription> gl() const {
    return renderer_ ? std::optional(renderer_->gl()) : std::nullopt;
  }

 private:
  Result<void> make() {
    auto renderer = Renderer::open(options_.gl, options_.assets);
    if (!renderer) return tl::unexpected(renderer.error());
    renderer_ = std::move(*renderer);
    return {};
  }

  const RenderCommandOptions& options_;
  std::optional<Renderer> renderer_;
};

/// Visibility of lines on one snapshot, exact to its mesh.
class LineResolver {
 public:
  explicit LineResolver(const MeshSnapshot& snapshot)
      : snapshot_(snapshot),
        resolver_(snapshot.mesh.mesh(), snapshot.mesh.positions()) {}

  [[nodiscard]] const VisibilityResolver& resolver() const { return resolver_; }

  /// One entry a point, for linesJson() and visibleSilhouettePixels().
  [[nodiscard]] std::vector<std::uint8_t>
  perSegment(const PolylineSet& lines, const Camera& camera, const Viewport& viewport) const {
    const LineScene scene{
        snapshot_.mesh.mesh(),
        snapshot_.mesh.positions(),
        snapshot_.model.grid,
        camera,
        viewport};
    return segmentVisibility(lines, resolver_.resolve(lines, scene), scene);
  }

 private:
  const MeshSnapshot& snapshot_;
  VisibilityResolver resolver_;
};

Result<ContourError> checkAgainstReference(
    const RenderCommandOptions& options,
    const Camera& camera,
    std::span<const glm::dvec2> ours) {
  const auto source = openAssetSource(options.reference);
  if (!source) return tl::unexpected(source.error().within("--reference"));
  const auto whole = loadWhole(*source);
  if (!whole) return tl::unexpected(whole.error().within("--reference"));
  LineFinderOptions exact = lineOptionsOf(options);
  exact.detector = DetectorMethod::kBrute;
  LineFinder finder(whole->snapshot, exact);
  const auto found = finder.find(camera);
  const LineResolver resolver(*whole->snapshot);
  const auto theirs = visibleSilhouettePixels(
      found.lines,
      resolver.perSegment(found.lines, camera, options.viewport),
      whole->snapshot->model.grid,
      camera,
      options.viewport);
  return compareContours(ours, theirs, options.viewport);
}

/// Whether some output other than the picture has lines in it.
bool usesLines(const RenderCommandOptions& options) {
  return !options.svg.empty() || !options.dumpLines.empty() || options.check;
}

/// Draws every frame and writes every output.
class Drawing {
 public:
  Drawing(const RenderCommandOptions& options, std::string modelName, SessionOutcome outcome)
      : options_(options),
        modelName_(std::move(modelName)),
        cones_(options.silhouette),
        painter_(options),
        outcome_(std::move(outcome)) {}

  /// Takes another state of the mesh before the next frame.
  void refine(SessionOutcome outcome) {
    if (outcome.snapshot != outcome_.snapshot) {
      finder_.reset();
      resolver_.reset();
    }
    outcome_ = std::move(outcome);
  }

  Result<void> drawFrame(const Camera& camera, std::uint32_t index) {
    const bool last = index + 1 == options_.frames;
    // Without a number in a path every frame is the same picture: the last one is kept.
    const bool isKept = options_.moves() || last;
    LineFinder::Lines found;
    const bool findsLines = options_.contours == SessionMachine::Options::Contours::kOwnMesh;
    if (findsLines && (needsLines(options_.draw) || (isKept && usesLines(options_)))) {
      auto lines = findLines(camera);
      if (!lines) return tl::unexpected(lines.error());
      found = *std::move(lines);
    }
    // What is drawn: the client's mesh, or, for the server's lines, what stands in for it.
    std::shared_ptr<const MeshSnapshot> drawn = outcome_.snapshot;
    if (!findsLines && needsLines(options_.draw) && options_.draw != DrawMode::kClip) {
      auto stage = stage_.snapshotOf(*drawn, kStageFaces);
      if (!stage) return tl::unexpected(stage.error());
      found.lines =
          linesOf(drawn->contour->lines, (*stage)->model.grid.bits - drawn->model.grid.bits);
      drawn = *std::move(stage);
    }
    if (!options_.out.empty() || !options_.report.empty()) {
      auto frame = painter_.draw(*drawn, found.lines, camera);
      if (!frame) return tl::unexpected(frame.error());
      times_.push_back(
          {found.detectMs,
           found.chainMs,
           frame->timings.strokeMs,
           frame->timings.visibilityMs,
           frame->timings.drawMs});
      if (!options_.out.empty() && isKept) {
        const auto path = framePath(options_.out.string(), index);
        if (auto written = writePng(path, frame->image); !written) {
          return tl::unexpected(written.error());
        }
      }
    }
    if (!options_.svg.empty() && isKept) {
      const auto svg = svgFile(
          options_,
          modelName_,
          *outcome_.snapshot,
          found.lines,
          resolver().resolver(),
          camera);
      if (!svg) return tl::unexpected(svg.error());
      const auto path = framePath(options_.svg.string(), index);
      if (auto ok = writeOutputFile(path, *svg); !ok) return ok;
    }
    if (!last) return {};
    stats_ = found.stats;
    loops_ = found.loops;
    return finish(camera, found);
  }

  Result<void> writeMeshAndReport() {
    if (!options_.dumpMesh.empty()) {
      if (auto ok = writeOutputFile(options_.dumpMesh, meshPly(*outcome_.snapshot)); !ok) return ok;
    }
    const MeshSnapshot& snapshot = *outcome_.snapshot;
    if (auto ok = writeHull(options_.dumpHull, snapshot.outerHull); !ok) return ok;
    if (auto ok = writeHull(options_.dumpInnerHull, snapshot.innerHull); !ok) return ok;
    if (options_.report.empty()) return {};
    RenderReport report;
    report.outcome = &outcome_;
    report.modelName = modelName_;
    report.frames = times_;
    const bool hasLines = options_.frames > 0 && (needsLines(options_.draw) || usesLines(options_));
    report.detectorName = hasLines ? options_.detectorName : "none";
    report.stats = stats_;
    report.loops = loops_;
    report.recall = recall_;
    report.contourError = contourError_;
    report.gl = painter_.gl();
    return writeOutputFile(options_.report, reportJson(report));
  }

 private:
  Result<LineFinder::Lines> findLines(const Camera& camera) {
    if (!finder_) {
      LineFinderOptions lines = lineOptionsOf(options_);
      lines.cones = &cones_;
      if (options_.detector == DetectorMethod::kImage) {
        if (auto ok = makeImageSeeds(); !ok) return tl::unexpected(ok.error());
        lines.imageSeeds = [this](const MeshSnapshot& snapshot, const Camera& from) {
          return imageSeeds_->find(snapshot, from);
        };
      }
      finder_.emplace(outcome_.snapshot, lines);
      // Working memory grows on first use; the frames timed are those of a view that is going on.
      static_cast<void>(finder_->find(camera));
    }
    return finder_->find(camera);
  }

  const LineResolver& resolver() {
    if (!resolver_) resolver_.emplace(*outcome_.snapshot);
    return *resolver_;
  }

  Result<void> writeHull(
      const std::filesystem::path& path,
      const std::shared_ptr<const ProgressiveHull>& hull) {
    if (path.empty()) return {};
    if (!hull) return fail(ErrorCode::kUnavailable, "the hull has not arrived: allow more");
    const auto level = hullAfter(*hull, hull->splitsFor(options_.hullFaces));
    if (!level) return tl::unexpected(level.error());
    return writeOutputFile(path, hullPly(*level));
  }

  Result<void> finish(const Camera& camera, const LineFinder::Lines& found) {
    std::vector<std::uint8_t> visible;
    if (!options_.dumpLines.empty() || !options_.reference.empty()) {
      visible = resolver().perSegment(found.lines, camera, options_.viewport);
    }
    if (!options_.dumpLines.empty()) {
      const LineDump dump{*outcome_.snapshot, found.lines, visible, camera, options_.viewport};
      if (auto ok = writeOutputFile(options_.dumpLines, linesJson(dump)); !ok) return ok;
    }
    if (!options_.check) return {};
    recall_ = finder_->recallFrom(camera);
    if (options_.reference.empty()) return {};
    const auto ours = visibleSilhouettePixels(
        found.lines,
        visible,
        outcome_.snapshot->model.grid,
        camera,
        options_.viewport);
    auto error = checkAgainstReference(options_, camera, ours);
    if (!error) return tl::unexpected(error.error());
    contourError_ = *error;
    return {};
  }

  Result<void> makeImageSeeds() {
    if (imageSeeds_) return {};
    auto made = ImageSeeds::create(options_.gl, {.viewport = options_.viewport});
    if (!made) return tl::unexpected(made.error());
    imageSeeds_.emplace(*std::move(made));
    return {};
  }

  const RenderCommandOptions& options_;
  const std::string modelName_;
  ConeKeeper cones_;
  std::optional<ImageSeeds> imageSeeds_;
  Painter painter_;
  SessionOutcome outcome_;
  ContourStage stage_;
  std::optional<LineFinder> finder_;
  std::optional<LineResolver> resolver_;
  std::vector<FrameTimes> times_;
  DetectionStats stats_;
  std::uint32_t loops_ = 0;
  std::optional<double> recall_;
  std::optional<ContourError> contourError_;
};

bool needsPicture(const RenderCommandOptions& options) {
  return options.frames > 0 &&
         (!options.out.empty() || !options.svg.empty() || !options.dumpLines.empty() ||
          !options.report.empty() || options.check);
}

}  // namespace

Result<void> runRender(const RenderCommandOptions& options) {
  watchForInterrupts();
  if (!options.with.empty()) return runScene(options);
  auto source = openSource(options.source);
  if (!source) return tl::unexpected(source.error());

  ClientSession::Options sessionOptions = sessionOptionsOf(*source, options);
  const StopCondition until = sessionOptions.session.stop;
  const bool exactContours = options.contours == SessionMachine::Options::Contours::kServer;
  // A moving camera asks for more and more, so its connection stays open.
  const bool follows = source->isServer && options.moves() && options.frames > 1 &&
                       until.kind == StopCondition::Kind::kState &&
                       (until.state > MeshState::kBase || exactContours);
  if (follows) sessionOptions.session.stop.kind = StopCondition::Kind::kNever;
  ClientSession session(source->connect, sessionOptions);
  ProgressLine progress;

  const auto model =
      watchSession(session, progress, [&](std::uint64_t ms) { return session.waitForModel(ms); });
  if (!model) return tl::unexpected(model.error());
  noteMissingHull(*model, options);
  const auto path = camerasOf(options, model->sphere);
  if (!path) return tl::unexpected(path.error());
  session.setView(viewOf(options, until, path->front()));

  const auto reach = [&] {
    return watchSession(session, progress, [&](std::uint64_t ms) {
      return follows ? session.waitForState(until.state, ms) : session.waitUntilDone(ms);
    });
  };
  auto outcome = reach();
  if (!outcome) return tl::unexpected(outcome.error());

  if (auto ok = checkHull(*outcome->snapshot, options); !ok) return ok;
  const auto& seeds = outcome->snapshot->seeds;
  if (options.detector == DetectorMethod::kPrecomputed && (!seeds || seeds->seeds.empty())) {
    std::fputs(
        "limn-client: no silhouette seeds have come for this model: --detector precomputed finds "
        "nothing\n",
        stderr);
  }
  Drawing drawing(options, source->model, std::move(*outcome));
  if (needsPicture(options)) {
    for (std::uint32_t i = 0; i < options.frames; ++i) {
      if (interrupted()) return fail(ErrorCode::kCancelled, "stopped on request");
      const Camera& camera = (*path)[i];
      if (follows && i > 0) {
        session.setView(viewOf(options, until, camera));
        auto next = reach();
        if (!next) return tl::unexpected(next.error());
        drawing.refine(std::move(*next));
      }
      if (auto drawn = drawing.drawFrame(camera, i); !drawn) return drawn;
    }
  }
  return drawing.writeMeshAndReport();
}

}  // namespace limn
