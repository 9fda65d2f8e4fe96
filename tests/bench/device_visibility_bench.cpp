// SPDX-License-Identifier: Apache-2.0
// Line visibility by depth image, as the device finds it, against the exact visibility of
// client/stroke/visibility/resolved_visibility (itself checked against Embree by
// limn-visibility-bench): six views at 1024 x 1024. Two lines of JSON a mesh, on stdout: silhouette
// edges, then smooth silhouettes.
//   A sample (one a pixel along every line) is wrong where its answer is not that at its place. A
// span is long where more than kFarPx samples in a row are wrong and none of them is a neighbour of
// a change of the truth ("long_spans_percent", of all samples), or whatever the truth does around
// them ("strict").
//   limn-device-visibility-bench MODEL-FILE...   (names of models as tests/corpus knows them)
#include "client/render/renderer.h"
#include "client/stroke/chain/chain.h"
#include "client/stroke/chain/crease_contours.h"
#include "client/stroke/chain/crease_noise.h"
#include "client/stroke/chain/open_surfaces.h"
#include "client/stroke/chain/panel_edges.h"
#include "client/stroke/visibility/resolved_visibility.h"
#include "client/stroke/visibility/visibility.h"
#include "tests/bench/measure.h"
#include "tests/corpus/corpus.h"

#include "shared/mesh/cracks.h"
#include "shared/mesh/feature_edges.h"
#include "shared/silhouette/detector.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr int kSize = 1024;
constexpr int kFarPx = 2;
constexpr double kCreaseDegrees = 40.0;  // limn-prepare's

/// The picture's pixels within kFarPx of a set of points.
class NearMap {
 public:
  void add(const glm::vec2& fraction) {
    const glm::ivec2 at(glm::floor(fraction * static_cast<float>(kSize)));
    for (int dy = -kFarPx; dy <= kFarPx; ++dy) {
      for (int dx = -kFarPx; dx <= kFarPx; ++dx) {
        if (dx * dx + dy * dy > kFarPx * kFarPx + 1) continue;
        if (isIn(at + glm::ivec2(dx, dy))) bits_[place(at + glm::ivec2(dx, dy))] = true;
      }
    }
  }

  [[nodiscard]] bool has(const glm::vec2& fraction) const {
    const glm::ivec2 at(glm::floor(fraction * static_cast<float>(kSize)));
    return isIn(at) && bits_[place(at)];
  }

 private:
  static bool isIn(const glm::ivec2& p) {
    return p.x >= 0 && p.y >= 0 && p.x < kSize && p.y < kSize;
  }

  static std::size_t place(const glm::ivec2& p) {
    return static_cast<std::size_t>(p.y) * kSize + static_cast<std::size_t>(p.x);
  }

  std::vector<bool> bits_ = std::vector<bool>(std::size_t{kSize} * kSize);
};

struct Tally {
  std::size_t edges = 0;
  std::size_t falseVisible = 0;
  std::size_t falseHidden = 0;
  std::size_t samples = 0;          // a pixel of length each
  std::size_t wrong = 0;            // samples
  std::size_t inLongSpans = 0;      // wrong ones in a row of more than kFarPx, not beside a change
  std::size_t inStrictSpans = 0;    // beside one as well
  std::size_t farFalseVisible = 0;  // wrong ones farther than kFarPx from any truly visible line
  std::size_t farFalseHidden = 0;   // and from any line drawn as visible
};

class Bench {
 public:
  explicit Bench(Renderer renderer) : renderer_(std::move(renderer)) {}

  bool run(const std::string& file) {
    const corpus::Mesh* model = corpus::model(file);
    if (model == nullptr) {
      std::fprintf(stderr, "limn-device-visibility-bench: no model %s\n", file.c_str());
      return false;
    }
    MeshSnapshot snapshot;
    auto mesh = ActiveMesh::fromBase(
        {0, static_cast<std::uint32_t>(model->mesh.positions.size())},
        model->mesh,
        {});
    if (!mesh) return false;
    snapshot.mesh = *std::move(mesh);
    snapshot.model.grid = model->mesh.grid;
    snapshot.model.sphere = boundingSphere(model->mesh.grid, model->mesh.positions);
    snapshot.model.closed = model->closed;
    snapshot.revision = ++revision_;  // each is another mesh to the renderer's cache
    const VisibilityResolver resolver(snapshot.mesh.mesh(), snapshot.mesh.positions());
    // As limn-client draws: with the contours of creases.
    const Cracks cracks = findCracks(snapshot.mesh.mesh(), snapshot.mesh.positions());
    openSurfaces_.emplace(snapshot.mesh.mesh(), snapshot.mesh.positions(), cracks);
    crackParts_ = cracks.parts;
    creases_ = withoutNoise(
        snapshot.mesh.mesh(),
        snapshot.mesh.positions(),
        findCreases(snapshot.mesh.mesh(), snapshot.mesh.positions(), kCreaseDegrees),
        cracks.kinds);
    creases_ = withPanelEdges(
        snapshot.mesh.mesh(),
        snapshot.mesh.positions(),
        std::move(creases_),
        snapshot.model.sphere.radius / snapshot.model.grid.step);
    return report(file, snapshot, resolver, SilhouetteKind::kEdges) &&
           report(file, snapshot, resolver, SilhouetteKind::kSmooth);
  }

 private:
  bool report(
      const std::string& file,
      const MeshSnapshot& snapshot,
      const VisibilityResolver& resolver,
      SilhouetteKind kind) {
    Tally tally;
    for (const auto& [azimuth, elevation] : kSixViews) {
      const Camera camera = orbitCamera(snapshot.model.sphere, azimuth, elevation);
      if (!runView(snapshot, resolver, kind, camera, tally)) return false;
    }
    const auto percent = [](std::size_t n, std::size_t of) {
      return 100.0 * static_cast<double>(n) / static_cast<double>(std::max<std::size_t>(of, 1));
    };
    std::printf(
        "{\"mesh\":\"%s\",\"silhouette\":\"%s\",\"edges\":%zu,\"false_visible_percent\":%.3f,"
        "\"false_hidden_percent\":%.3f,\"length_px\":%zu,\"length_wrong_percent\":%.3f,"
        "\"long_spans_percent\":%.3f,\"strict_long_spans_percent\":%.3f,\"far_false_visible_"
        "percent\":%.4f,"
        "\"far_false_hidden_percent\":%.4f}\n",
        file.c_str(),
        kind == SilhouetteKind::kEdges ? "edges" : "smooth",
        tally.edges,
        percent(tally.falseVisible, tally.edges),
        percent(tally.falseHidden, tally.edges),
        tally.samples,
        percent(tally.wrong, tally.samples),
        percent(tally.inLongSpans, tally.samples),
        percent(tally.inStrictSpans, tally.samples),
        percent(tally.farFalseVisible, tally.samples),
        percent(tally.farFalseHidden, tally.samples));
    return true;
  }

  bool runView(
      const MeshSnapshot& snapshot,
      const VisibilityResolver& resolver,
      SilhouetteKind kind,
      const Camera& camera,
      Tally& tally) {
    const HalfEdgeMesh& mesh = snapshot.mesh.mesh();
    const SilhouetteField field(mesh, snapshot.mesh.positions(), kind);
    const auto detector = makeDetector(DetectorMethod::kBrute, field);
    const SilhouetteView view{snapshot.model.grid.fromModel(camera.eye), camera.forward(), false};
    SilhouetteChainer chainer;
    std::optional<CreaseContours> creases;
    if (kind == SilhouetteKind::kSmooth) creases.emplace(field, creases_, crackParts_);
    const SilhouetteResult& found = detector->detect(view);
    PolylineSet lines =
        creases ? creases->chain(view, found, chainer) : chainer.chain(field, view, found);
    openSurfaces_->markBacks(view, lines);
    RenderOptions options;
    options.viewport = {kSize, kSize};
    options.keepDepth = true;
    options.draw = DrawMode::kShaded;
    const auto frame = renderer_.render(snapshot, lines, camera, options);
    if (!frame) {
      std::fprintf(stderr, "limn-device-visibility-bench: %s\n", frame.error().message.c_str());
      return false;
    }
    const LineScene scene{
        mesh,
        snapshot.mesh.positions(),
        snapshot.model.grid,
        camera,
        options.viewport};
    const ResolvedLines resolved = resolver.resolve(lines, scene);
    countEdges(lines, scene, resolved, frame->depth, tally);
    countSpans(lines, scene, resolved, frame->depth, tally);
    return true;
  }

  static void countEdges(
      const PolylineSet& lines,
      const LineScene& scene,
      const ResolvedLines& resolved,
      const DepthImage& depth,
      Tally& tally) {
    const auto found = segmentVisibility(lines, scene, depth);
    const auto truth = segmentVisibility(lines, resolved, scene);
    for (const PolylineSet::Line& line : lines.lines) {
      for (std::uint32_t point = line.begin; point < line.begin + line.segmentCount(); ++point) {
        ++tally.edges;
        tally.falseVisible += found[point] != 0 && truth[point] == 0 ? 1 : 0;
        tally.falseHidden += found[point] == 0 && truth[point] != 0 ? 1 : 0;
      }
    }
  }

  /// As drawn: samples a pixel apart, filtered.
  static void countSpans(
      const PolylineSet& lines,
      const LineScene& scene,
      const ResolvedLines& resolved,
      const DepthImage& depth,
      Tally& tally) {
    const SpineSet spines = projectLines(lines, scene);
    const SpineSamples samples =
        sampleSpines(spines, measureSpines(spines), findSpans(lines, scene), scene.viewport);
    const std::vector<float> seen = sampleVisibility(samples, depth);
    const glm::dmat4 clipFromWorld = scene.camera.clipFromWorld(1.0);
    const auto fractionOf = [&](std::uint32_t point) {
      const glm::dvec3 p = scene.grid.toModel(glm::dvec3(lines.points[point]));
      return glm::dvec2(pixelFromClip(clipFromWorld * glm::dvec4(p, 1.0), {1, 1}));
    };
    std::vector<bool> truth(seen.size());
    NearMap visible;
    NearMap drawn;
    for (std::size_t s = 0; s < spines.spines.size(); ++s) {
      const PolylineSet::Line& line = lines.lines[spines.spines[s].line];
      const std::size_t end = s + 1 < samples.begin.size() ? samples.begin[s + 1] : seen.size();
      for (std::size_t i = samples.begin[s]; i < end; ++i) {
        const std::uint32_t point = samples.source[i];
        const glm::dvec2 a = fractionOf(point);
        const glm::dvec2 ab = fractionOf(point + 1 < line.end ? point + 1 : line.begin) - a;
        const double t = std::clamp(
            glm::dot(glm::dvec2(samples.samples[i].position) - a, ab) /
                std::max(glm::dot(ab, ab), 1e-18),
            0.0,
            1.0);
        for (const ResolvedLines::Piece& piece : resolved.piecesOf(point)) {
          truth[i] = piece.visible;
          if (t <= piece.end) break;
        }
        if (truth[i]) visible.add(samples.samples[i].position);
        if (seen[i] >= 0.5F) drawn.add(samples.samples[i].position);
      }
    }
    for (std::size_t s = 0; s < spines.spines.size(); ++s) {
      const std::size_t end = s + 1 < samples.begin.size() ? samples.begin[s + 1] : seen.size();
      std::size_t row = 0;
      std::size_t strictRow = 0;
      const auto count = [](bool isWrong, std::size_t& length, std::size_t& sum) {
        if (isWrong) {
          ++length;
          return;
        }
        if (length > kFarPx) sum += length;
        length = 0;
      };
      for (std::size_t i = samples.begin[s]; i <= end; ++i) {
        const bool isWrong = i < end && truth[i] != (seen[i] >= 0.5F);
        const bool isBesideChange =
            isWrong && ((i > samples.begin[s] && truth[i - 1] != truth[i]) ||
                        (i + 1 < end && truth[i + 1] != truth[i]));
        count(isWrong && !isBesideChange, row, tally.inLongSpans);
        count(isWrong, strictRow, tally.inStrictSpans);
        if (!isWrong) continue;
        ++tally.wrong;
        const glm::vec2& at = samples.samples[i].position;
        if (truth[i]) {
          tally.farFalseHidden += drawn.has(at) ? 0 : 1;
        } else {
          tally.farFalseVisible += visible.has(at) ? 0 : 1;
        }
      }
      tally.samples += end - samples.begin[s];
    }
  }

  Renderer renderer_;
  // Of the model at hand.
  std::vector<std::uint8_t> creases_;
  std::vector<CrackPart> crackParts_;
  std::optional<OpenSurfaces> openSurfaces_;
  std::uint64_t revision_ = 0;
};

int run(int count, char** files) {
  auto renderer = Renderer::open(GlBackend::kOsmesa);
  if (!renderer) {
    std::fprintf(stderr, "limn-device-visibility-bench: %s\n", renderer.error().message.c_str());
    return 1;
  }
  Bench bench(*std::move(renderer));
  bool ok = count > 1;
  for (int i = 1; i < count; ++i)
    ok = bench.run(files[i]) && ok;
  return ok ? 0 : 1;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(argc, argv);
}
