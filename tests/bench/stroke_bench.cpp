// SPDX-License-Identifier: Apache-2.0
// A frame of lines on the processor, stage by stage: detection, chaining, and everything of
// client/stroke up to the strips that the GPU draws. One thread's processor time; medians over an
// orbit.
#include "client/stroke/chain.h"
#include "client/stroke/stroke_builder.h"
#include "tests/corpus/corpus.h"

#include "shared/silhouette/detector.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

namespace limn {
namespace {

double nowMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

constexpr std::array kStages = {"detect", "chain", "strokes", "all"};

struct Target {
  const char* file;
  double ms;  // detection, chaining and strokes together
};

constexpr std::array<Target, 3> kTargets = {
    {{"bunny-closed.ply", 2.0}, {"turbine-blade.ply", 4.0}, {"dragon.ply", 25.0}}};

double median(std::vector<double> values) {
  std::nth_element(
      values.begin(),
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
      values.end());
  return values[values.size() / 2];
}

void benchMesh(const corpus::Mesh& model, double targetMs, int frames) {
  const TriangleMesh& shape = model.mesh;
  const auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
  if (!mesh) return;
  const SilhouetteField field(*mesh, shape.positions, SilhouetteKind::kSmooth);
  const auto detector = makeDetector(DetectorMethod::kCones, field);
  SilhouetteChainer chainer;
  StrokeBuilder builder;
  const BoundingSphere sphere = boundingSphere(shape.grid, shape.positions);
  std::array<std::vector<double>, kStages.size()> times;
  std::size_t segments = 0;
  std::size_t vertices = 0;
  std::size_t sampleCount = 0;
  StrokeStyle style;  // as the pencil
  style.widthPx = 3.4F;
  style.taperPx = 9.0F;
  style.overshootPx = 1.5F;
  style.smoothPx = 1.2F;
  style.fadeBelowPx = 10.0F;
  style.fadeHiddenBelowPx = 18.0F;
  for (int i = -2; i < frames; ++i) {  // two to warm up
    const Camera camera = orbitCamera(sphere, 30.0 + 360.0 * i / frames, 20.0);
    const LineScene scene{*mesh, shape.positions, shape.grid, camera, {1024, 1024}};
    const SilhouetteView view{shape.grid.fromModel(camera.eye), camera.forward(), false};
    std::array<double, kStages.size()> at{};
    std::size_t stage = 0;
    const auto mark = [&] { at[stage++] = nowMs(); };
    mark();
    const SilhouetteResult& found = detector->detect(view);
    mark();
    const PolylineSet& lines = chainer.chain(field, view, found);
    mark();
    const BuiltStrokes strokes = builder.build(lines, scene, style, {.widthPx = style.widthPx});
    mark();
    if (i < 0) continue;
    for (std::size_t k = 0; k + 1 < kStages.size(); ++k) {
      times[k].push_back(at[k + 1] - at[k]);
    }
    times.back().push_back(at.back() - at.front());
    segments += found.stats.segments;
    sampleCount += strokes.samples.samples.size();
    vertices += strokes.mesh.vertices.size();
  }
  const auto mean = [&](std::size_t sum) { return sum / static_cast<std::size_t>(frames); };
  std::printf("%-18s", model.name.c_str());
  for (const auto& stage : times)
    std::printf(" %8.3f", median(stage));
  std::printf(
      "  target %4.1f %s  %zu segments, %zu samples, %zu vertices\n",
      targetMs,
      median(times.back()) <= targetMs ? "met" : "NOT",
      mean(segments),
      mean(sampleCount),
      mean(vertices));
}

int run(int argc, char** argv) {
  const bool isQuick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
  std::printf("%-18s", "ms a frame");
  for (const char* stage : kStages)
    std::printf(" %8s", stage);
  std::printf("\n");
  for (const Target& target : kTargets) {
    if (isQuick && std::strcmp(target.file, "dragon.ply") == 0) continue;
    if (const corpus::Mesh* mesh = corpus::model(target.file)) benchMesh(*mesh, target.ms, 60);
  }
  return 0;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(argc, argv);
}
