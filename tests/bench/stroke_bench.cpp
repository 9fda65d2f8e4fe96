// SPDX-License-Identifier: Apache-2.0
// A frame of lines on the processor, stage by stage: detection, chaining, and everything of
// client/stroke up to the strips that the GPU draws. One thread's processor time; medians over an
// orbit. Then how far textures slide along the lines on an orbit at 1 degree a frame.
//   limn-stroke-bench [--quick] [MODEL-FILE...]   (more models to measure slides of)
#include "client/stroke/chain/chain.h"
#include "client/stroke/stroke_builder.h"
#include "tests/bench/measure.h"
#include "tests/corpus/corpus.h"
#include "tests/texture_slide.h"

#include "shared/silhouette/detector.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr Viewport kViewport{1024, 1024};
constexpr std::array kStages = {"detect", "chain", "strokes", "all"};

struct Target {
  const char* file;
  double ms;  // detection, chaining and strokes together
};

constexpr std::array<Target, 3> kTargets = {
    {{"bunny-closed.ply", 2.0}, {"turbine-blade.ply", 4.0}, {"dragon.ply", 25.0}}};

/// A model, its silhouettes and their lines: what both measures below look at.
class Subject {
 public:
  /// Null where the model is no manifold.
  static std::unique_ptr<Subject> of(const corpus::Mesh& model) {
    const TriangleMesh& shape = model.mesh;
    auto mesh =
        HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
    if (!mesh) return nullptr;
    return std::unique_ptr<Subject>(new Subject(shape, *std::move(mesh)));
  }

  [[nodiscard]] Camera orbit(double azimuthDegrees) const {
    return orbitCamera(sphere_, azimuthDegrees, 20.0);
  }

  [[nodiscard]] LineScene scene(const Camera& camera) const {
    return {mesh_, shape_.positions, shape_.grid, camera, kViewport};
  }

  [[nodiscard]] SilhouetteView view(const Camera& camera) const {
    return {shape_.grid.fromModel(camera.eye), camera.forward(), false};
  }

  const SilhouetteResult& detect(const SilhouetteView& view) { return detector_->detect(view); }

  const PolylineSet& chain(const SilhouetteView& view, const SilhouetteResult& found) {
    return chainer_.chain(field_, view, found);
  }

 private:
  Subject(const TriangleMesh& shape, HalfEdgeMesh mesh)
      : shape_(shape),
        mesh_(std::move(mesh)),
        field_(mesh_, shape.positions, SilhouetteKind::kSmooth),
        detector_(makeDetector(DetectorMethod::kCones, field_)),
        sphere_(boundingSphere(shape.grid, shape.positions)) {}

  const TriangleMesh& shape_;
  HalfEdgeMesh mesh_;
  SilhouetteField field_;
  std::unique_ptr<SilhouetteDetector> detector_;
  SilhouetteChainer chainer_;
  BoundingSphere sphere_;
};

void benchMesh(const corpus::Mesh& model, double targetMs, int frames) {
  const auto subject = Subject::of(model);
  if (!subject) return;
  StrokeBuilder builder;
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
    const Camera camera = subject->orbit(30.0 + 360.0 * i / frames);
    const LineScene scene = subject->scene(camera);
    const SilhouetteView view = subject->view(camera);
    std::array<double, kStages.size()> at{};
    std::size_t stage = 0;
    const auto mark = [&] { at[stage++] = threadCpuMs(); };
    mark();
    const SilhouetteResult& found = subject->detect(view);
    mark();
    const PolylineSet& lines = subject->chain(view, found);
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

/// Slides over forty frames, coherent and, as the control, each frame for itself.
void measureSlides(const corpus::Mesh& model) {
  constexpr int kFrames = 40;
  const auto subject = Subject::of(model);
  if (!subject) return;
  const StrokeStyle style;
  const float period = texturePeriod(style, style.widthPx);
  std::array<StrokeBuilder, 2> builders;
  std::array<StrokeFrame, 2> last;
  std::array<std::vector<double>, 2> slides;
  for (int i = 0; i <= kFrames; ++i) {
    const Camera camera = subject->orbit(30.0 + i);
    const LineScene scene = subject->scene(camera);
    const SilhouetteView view = subject->view(camera);
    const PolylineSet& lines = subject->chain(view, subject->detect(view));
    for (std::size_t k = 0; k < 2; ++k) {
      if (k == 1) builders[k] = StrokeBuilder();
      const BuiltStrokes built = builders[k].build(lines, scene, style, {.widthPx = style.widthPx});
      StrokeFrame frame{camera, built.spines, built.parameters};
      if (i > 0) {
        const std::vector<float> moved = textureSlides(last[k], frame, kViewport, period);
        slides[k].insert(slides[k].end(), moved.begin(), moved.end());
      }
      last[k] = std::move(frame);
    }
  }
  if (slides[0].empty() || slides[1].empty()) return;
  std::sort(slides[0].begin(), slides[0].end());
  const auto above = slides[0].end() - std::upper_bound(slides[0].begin(), slides[0].end(), 1.0);
  std::printf(
      "%-18s %8.3f %7.1f %% %8.2f  target 1.0 %s\n",
      model.name.c_str(),
      median(slides[0]),
      100.0 * static_cast<double>(above) / static_cast<double>(slides[0].size()),
      median(slides[1]),
      median(slides[0]) <= 1.0 ? "met" : "NOT");
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
  std::vector<const char*> files = {"bunny-closed.ply", "turbine-blade.ply", "fandisk.off"};
  files.insert(files.end(), argv + (isQuick ? 2 : 1), argv + argc);
  std::printf("\n%-18s %8s %9s %8s\n", "slide, px a frame", "median", "above 1", "alone");
  for (const char* file : files) {
    if (const corpus::Mesh* mesh = corpus::model(file)) measureSlides(*mesh);
  }
  return 0;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(argc, argv);
}
