// SPDX-License-Identifier: Apache-2.0
// Based on: M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 5.1: a
// camera that circles the object in 400 frames, the time of every detector in every frame, and the
// segments it found against those that brute force found.
#include "client/apps/sweep_command.h"

#include "client/apps/interrupt.h"
#include "client/apps/output_file.h"
#include "client/apps/source.h"
#include "client/apps/sweep_report.h"
#include "client/apps/watch_session.h"
#include "client/pose/orbit_path.h"
#include "client/render/image_seeds.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

std::string nameOf(const SourceOptions& source) {
  if (!source.meshFile.empty()) return source.meshFile.stem().string();
  return source.assetDirectory.empty() ? source.model : source.assetDirectory.stem().string();
}

/// One model and its path.
class ModelSweep {
 public:
  ModelSweep(const SweepCommandOptions& options, const MeshSnapshot& snapshot, std::string name)
      : options_(options),
        snapshot_(snapshot),
        name_(std::move(name)),
        field_(snapshot.mesh.mesh(), snapshot.mesh.positions(), options.silhouette) {
    path_ = orbitPath(snapshot.model.sphere, options.orbit, options.fovDegrees, options.frames);
    for (Camera& camera : path_) {
      camera.orthographic = options.orthographic;
      fitDepthRange(snapshot.model.sphere, camera);
      SilhouetteView view;
      view.eye = snapshot.model.grid.fromModel(options.light ? *options.light : camera.eye);
      view.forward = camera.forward();
      view.orthographic = options.orthographic && !options.light;
      views_.push_back(view);
    }
  }

  Result<SweepMesh> run() {
    SweepMesh mesh;
    mesh.name = name_;
    mesh.faces = field_.mesh().faceCount();
    findTruth();
    for (const DetectorMethod method : options_.detectors) {
      if (method == DetectorMethod::kPrecomputed && !hasSeeds()) {
        std::fprintf(
            stderr,
            "limn-client: %s has no silhouette seeds: precomputed is left out\n",
            mesh.name.c_str());
        continue;
      }
      if (method == DetectorMethod::kImage) {
        if (auto ok = makeImageSeeds(); !ok) {
          std::fprintf(
              stderr,
              "limn-client: the image detector is left out: %s\n",
              ok.error().message.c_str());
          continue;
        }
      }
      if (interrupted()) return fail(ErrorCode::kCancelled, "stopped on request");
      mesh.series.push_back(measure(method));
    }
    return mesh;
  }

 private:
  [[nodiscard]] bool hasSeeds() const {
    return snapshot_.seeds != nullptr && !snapshot_.seeds->seeds.empty();
  }

  Result<void> makeImageSeeds() {
    if (options_.light) return fail(ErrorCode::kUnsupported, "it looks with the camera, no light");
    auto made = ImageSeeds::create(options_.gl, {.viewport = options_.viewport});
    if (!made) return tl::unexpected(made.error());
    imageSeeds_.emplace(*std::move(made));
    return {};
  }

  void findTruth() {
    const auto brute = makeDetector(DetectorMethod::kBrute, field_);
    for (const SilhouetteView& view : views_)
      truth_.push_back(brute->detect(view).stats.segments);
  }

  SweepSeries measure(DetectorMethod method) {
    DetectorOptions parameters = options_.parameters;
    parameters.seeds = snapshot_.seeds.get();
    parameters.slotOf = [&mesh = snapshot_.mesh](VertexId v) {
      return mesh.holds(v) ? mesh.slotOf(v) : kNone;
    };
    std::size_t frameIndex = 0;
    if (method == DetectorMethod::kImage) {
      parameters.imageFaces = [this, &frameIndex](const SilhouetteView&) {
        return imageSeeds_->find(snapshot_, path_[frameIndex]);
      };
    }
    SweepSeries series;
    series.method = method;
    series.frames.resize(views_.size());
    for (std::uint32_t round = 0; round < options_.rounds; ++round) {
      // Each round starts without a past: coherence would profit from it.
      auto begin = Clock::now();
      const auto detector = makeDetector(method, field_, parameters);
      series.buildMs = millisecondsSince(begin);
      for (std::size_t i = 0; i < views_.size(); ++i) {
        frameIndex = i;
        begin = Clock::now();
        const DetectionStats& stats = detector->detect(views_[i]).stats;
        const double ms = millisecondsSince(begin);
        SweepFrame& frame = series.frames[i];
        frame.ms = round == 0 ? ms : std::min(frame.ms, ms);
        frame.segments = stats.segments;
        frame.facesVisited = stats.facesVisited;
        // No detector finds what is none, or anything twice (tested), so counting is enough.
        frame.recall = truth_[i] == 0 ? 1.0 : static_cast<double>(stats.segments) / truth_[i];
      }
    }
    return series;
  }

  const SweepCommandOptions& options_;
  const MeshSnapshot& snapshot_;
  std::string name_;
  SilhouetteField field_;
  CameraPath path_;
  std::vector<SilhouetteView> views_;
  std::optional<ImageSeeds> imageSeeds_;
  std::vector<std::uint32_t> truth_;  // segments there are, by frame
};

}  // namespace

Result<void> runSweep(const SweepCommandOptions& options) {
  watchForInterrupts();
  std::vector<SweepMesh> meshes;
  for (const SourceOptions& sourceOptions : options.sources) {
    const auto source = openSource(sourceOptions);
    if (!source) return tl::unexpected(source.error());
    const auto whole = loadWhole(*source);
    if (!whole) return tl::unexpected(whole.error());
    auto mesh = ModelSweep(options, *whole->snapshot, nameOf(sourceOptions)).run();
    if (!mesh) return tl::unexpected(mesh.error());
    meshes.push_back(std::move(*mesh));
  }
  std::fputs(sweepTable(meshes).c_str(), stdout);
  if (!options.csv.empty()) {
    if (auto ok = writeOutputFile(options.csv, sweepCsv(meshes)); !ok) return ok;
  }
  if (!options.plot.empty()) return writeOutputFile(options.plot, sweepPlot(meshes));
  return {};
}

}  // namespace limn
