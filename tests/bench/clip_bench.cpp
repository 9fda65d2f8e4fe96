// SPDX-License-Identifier: Apache-2.0
//
// The outline that silhouette clipping draws, by a hull of 500 faces, against the mesh's own drawn
// four times as large (16 samples a pixel) and sixteen times (256), from 20 views; silhouettes by
// the client's chains and by the server's exact contours, coded and decoded. One line of JSON a
// mesh.
//   limn-clip-bench [--gl egl|osmesa] [--views N] [--size PX] [--times] MODEL-FILE...
// leaks, holes: pixels that differ where the truth (of 16 samples) is the same within a pixel.
// rms: grey levels of 255 at full contrast, over the pixels that the truth covers partly: ours from
// either truth, and the coarse truth's from the fine one.
// --times: papers/003's table 1 instead: processor milliseconds a frame, the best of five, means
// over the views: the original mesh (one sample a pixel; 2 x 2), the hull alone, the clipped hull,
// and of it finding and chaining, the contours' way to the screen and to coverage; the rest is GL.
#include "client/render/clip_contours.h"
#include "client/render/contour_coverage.h"
#include "client/render/renderer.h"
#include "client/stroke/chain/chain.h"
#include "server/contour/contour_extractor.h"
#include "server/preprocess/hulls/build_hull.h"
#include "tests/bench/measure.h"
#include "tests/corpus/corpus.h"
#include "tests/unit/client/render/outline_coverage.h"

#include "protocol/limits.h"

#include "shared/codec/contour_codec.h"
#include "shared/silhouette/detector.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr std::uint32_t kHullFaces = 500;

struct Settings {
  int views = 20;
  int size = 320;
  bool times = false;
};

template <class Work>
double bestOf(int rounds, Work work) {
  double best = 1e300;
  for (int i = 0; i < rounds; ++i) {
    const double begin = processCpuMs();
    work();
    best = std::min(best, processCpuMs() - begin);
  }
  return best;
}

struct Tally {
  outline::Difference coarse;
  outline::Difference fine;
};

/// The n-th of some directions spread over the sphere, from near and far.
Camera cameraOf(const BoundingSphere& sphere, int view, int views) {
  constexpr double kGoldenAngle = 137.50776405;
  const double height = -0.95 + 1.9 * (view + 0.5) / views;
  return orbitCamera(
      sphere,
      kGoldenAngle * view,
      std::asin(height) * 57.29577951,
      view % 3 == 0   ? 2.2
      : view % 3 == 1 ? 3.0
                      : 4.5);
}

class Bench {
 public:
  Bench(Renderer renderer, Settings settings)
      : renderer_(std::move(renderer)),
        settings_(settings) {}

  Result<void> run(const std::string& file) {
    const corpus::Mesh* model = corpus::model(file);
    if (model == nullptr) return fail(ErrorCode::kNotFound, "no model " + file);
    MeshSnapshot snapshot;
    const auto vertices = static_cast<std::uint32_t>(model->mesh.positions.size());
    auto mesh = ActiveMesh::fromBase({0, vertices}, model->mesh, {});
    if (!mesh) return tl::unexpected(mesh.error());
    const auto hull = buildHull(model->mesh, HullSide::kOuter, {.baseFaces = 200});
    if (!hull) return tl::unexpected(hull.error());
    snapshot.mesh = *std::move(mesh);
    snapshot.outerHull = std::make_shared<const ProgressiveHull>(hull->hull);
    snapshot.model.grid = model->mesh.grid;
    snapshot.model.sphere = boundingSphere(model->mesh.grid, model->mesh.positions);
    snapshot.model.closed = model->closed;
    snapshot.revision = ++revision_;  // each is another mesh to the renderer's cache
    return settings_.times ? timeViews(file, std::move(snapshot))
                           : compareViews(file, std::move(snapshot));
  }

 private:
  Result<void> compareViews(const std::string& file, MeshSnapshot snapshot) {
    const HalfEdgeMesh& mesh = snapshot.mesh.mesh();
    const SilhouetteField field(mesh, snapshot.mesh.positions(), SilhouetteKind::kEdges);
    const auto detector = makeDetector(DetectorMethod::kCones, field);
    const ContourExtractor extractor(field);
    SilhouetteChainer chainer;
    outline::Difference truths;
    Tally byClient;
    Tally byServer;
    RenderOptions clip;
    clip.viewport = {settings_.size, settings_.size};
    clip.draw = DrawMode::kClip;
    clip.hullFaces = kHullFaces;
    for (int v = 0; v < settings_.views; ++v) {
      const Camera camera = cameraOf(snapshot.model.sphere, v, settings_.views);
      const SilhouetteView view{snapshot.model.grid.fromModel(camera.eye), camera.forward(), false};
      const auto coarse = outline::truth(renderer_, snapshot, camera, settings_.size, 4);
      const auto fine = outline::truth(renderer_, snapshot, camera, settings_.size, 16);
      const PolylineSet& lines = chainer.chain(field, view, detector->detect(view));
      const auto client = outline::coverage(renderer_, snapshot, lines, camera, clip);
      auto decoded =
          decodeContour(encodeContour(extractor.extract(view)), limits::kMaxContourPoints);
      if (!decoded) return tl::unexpected(decoded.error());
      MeshSnapshot exact = snapshot;
      exact.contour = std::make_shared<const ExactContour>(ExactContour{1, *std::move(decoded)});
      const auto server = outline::coverage(renderer_, exact, {}, camera, clip);
      for (const auto* pixels : {&coarse, &fine, &client, &server}) {
        if (!*pixels) return tl::unexpected(pixels->error());
      }
      const int size = settings_.size;
      outline::compare(*client, *coarse, size, byClient.coarse);
      outline::compare(*client, *fine, size, byClient.fine);
      outline::compare(*server, *coarse, size, byServer.coarse);
      outline::compare(*server, *fine, size, byServer.fine);
      outline::compare(*coarse, *fine, size, truths);
    }
    std::printf(
        "{\"mesh\":\"%s\",\"faces\":%u,\"views\":%d",
        file.c_str(),
        mesh.faceCount(),
        settings_.views);
    print("client", byClient);
    print("server", byServer);
    std::printf(
        ",\"rms_of_16_samples\":%.2f,\"edge_pixels\":%d}\n",
        truths.rmsGrey(),
        truths.edgePixels);
    std::fflush(stdout);
    return {};
  }

  /// The hull by itself, as a mesh.
  Result<MeshSnapshot> hullAlone(const MeshSnapshot& snapshot) {
    const auto level = hullAfter(*snapshot.outerHull, snapshot.outerHull->splitsFor(kHullFaces));
    if (!level) return tl::unexpected(level.error());
    const auto vertices = static_cast<std::uint32_t>(level->positions.size());
    auto mesh = ActiveMesh::fromBase({0, vertices}, *level, {});
    if (!mesh) return tl::unexpected(mesh.error());
    MeshSnapshot hull;
    hull.mesh = *std::move(mesh);
    hull.model.grid = level->grid;
    hull.model.sphere = boundingSphere(level->grid, level->positions);
    hull.model.closed = true;
    hull.revision = ++revision_;
    return hull;
  }

  Result<void> timeViews(const std::string& file, MeshSnapshot snapshot) {
    constexpr int kRounds = 5;
    const HalfEdgeMesh& mesh = snapshot.mesh.mesh();
    const SilhouetteField field(mesh, snapshot.mesh.positions(), SilhouetteKind::kEdges);
    const auto detector = makeDetector(DetectorMethod::kCones, field);
    SilhouetteChainer chainer;
    ContourCoverage coverage;
    const auto hull = hullAlone(snapshot);
    if (!hull) return tl::unexpected(hull.error());
    const Viewport viewport{settings_.size, settings_.size};
    double found = 0.0;
    double projected = 0.0;
    double covered = 0.0;
    std::vector<PolylineSet> lines;
    std::vector<Camera> cameras;
    for (int v = 0; v < settings_.views; ++v) {
      Camera camera = cameraOf(snapshot.model.sphere, v, settings_.views);
      fitDepthRange(hull->model.sphere, camera);
      const SilhouetteView view{snapshot.model.grid.fromModel(camera.eye), camera.forward(), false};
      found += bestOf(kRounds, [&] {
        static_cast<void>(chainer.chain(field, view, detector->detect(view)));
      });
      lines.push_back(chainer.chain(field, view, detector->detect(view)));
      const glm::dmat4 clipFromWorld = camera.clipFromWorld(viewport.aspect());
      ClipScreen screen{clipFromWorld * snapshot.model.grid.step, viewport, 8};
      screen.clipFromGrid[3] = clipFromWorld * glm::dvec4(snapshot.model.grid.origin, 1.0);
      projected +=
          bestOf(kRounds, [&] { static_cast<void>(clipContoursOf(lines.back(), screen)); });
      const auto contours = clipContoursOf(lines.back(), screen);
      if (!contours) return fail(ErrorCode::kInvalidArgument, "a view from inside");
      covered += bestOf(kRounds, [&] { static_cast<void>(coverage.find(*contours, viewport)); });
      cameras.push_back(camera);
    }
    const auto frames = [&](const MeshSnapshot& of, DrawMode mode, int supersample) {
      RenderOptions options;
      options.viewport = viewport;
      options.draw = mode;
      options.hullFaces = kHullFaces;
      options.supersample = supersample;
      double sum = 0.0;
      for (std::size_t v = 0; v < cameras.size(); ++v) {
        static_cast<void>(renderer_.render(of, lines[v], cameras[v], options));  // uploads
        sum += bestOf(kRounds, [&] {
          static_cast<void>(renderer_.render(of, lines[v], cameras[v], options));
        });
      }
      return sum / static_cast<double>(cameras.size());
    };
    const double clip = frames(snapshot, DrawMode::kClip, 1);
    const double original = frames(snapshot, DrawMode::kShaded, 1);
    const double smooth = frames(snapshot, DrawMode::kShaded, 2);
    const double coarse = frames(*hull, DrawMode::kShaded, 1);
    const double views = settings_.views;
    std::printf(
        "{\"mesh\":\"%s\",\"faces\":%u,\"size\":%d,\"original_ms\":%.2f,"
        "\"original_2x2_ms\":%.2f,\"coarse_ms\":%.2f,\"clipped_ms\":%.2f,\"find_ms\":%.3f,"
        "\"project_ms\":%.3f,\"coverage_ms\":%.3f}\n",
        file.c_str(),
        mesh.faceCount(),
        settings_.size,
        original,
        smooth,
        coarse,
        clip + found / views,
        found / views,
        projected / views,
        covered / views);
    std::fflush(stdout);
    return {};
  }

  static void print(const char* name, const Tally& tally) {
    std::printf(
        ",\"%s\":{\"leaks\":%d,\"holes\":%d,\"rms_to_16\":%.2f,\"rms_to_256\":%.2f,"
        "\"worst_to_256\":%.1f}",
        name,
        tally.coarse.leaks,
        tally.coarse.holes,
        tally.coarse.rmsGrey(),
        tally.fine.rmsGrey(),
        255.0 * tally.fine.worst);
  }

  Renderer renderer_;
  Settings settings_;
  std::uint64_t revision_ = 0;
};

int run(int count, char** words) {
  GlBackend backend = GlBackend::kEgl;
  Settings settings;
  std::vector<std::string> files;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--times") {
      settings.times = true;
      continue;
    }
    if (word.starts_with("--") && i + 1 == count) {
      std::fprintf(stderr, "limn-clip-bench: %s needs a value\n", word.c_str());
      return 2;
    }
    if (word == "--gl") {
      const auto parsed = parseGlBackend(words[++i]);
      if (!parsed) return 2;
      backend = *parsed;
    } else if (word == "--views") {
      settings.views = std::max(1, std::atoi(words[++i]));
    } else if (word == "--size") {
      settings.size = std::clamp(std::atoi(words[++i]), 16, 4096);
    } else {
      files.push_back(word);
    }
  }
  auto renderer = Renderer::open(backend);
  if (!renderer) {
    std::fprintf(stderr, "limn-clip-bench: %s\n", renderer.error().message.c_str());
    return 1;
  }
  Bench bench(*std::move(renderer), settings);
  int status = 0;
  for (const std::string& file : files) {
    if (const auto done = bench.run(file); !done) {
      std::fprintf(stderr, "limn-clip-bench: %s: %s\n", file.c_str(), done.error().message.c_str());
      status = 1;
    }
  }
  return status;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(argc, argv);
}
