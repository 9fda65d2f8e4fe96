// SPDX-License-Identifier: Apache-2.0
//
// The outline that silhouette clipping draws, by a hull of 500 faces, against the mesh's own drawn
// four times as large (16 samples a pixel) and sixteen times (256), from 20 views; silhouettes by
// the client's chains and by the server's exact contours, coded and decoded. One line of JSON a
// mesh.
//   limn-clip-bench [--gl egl|osmesa] [--views N] [--size PX] MODEL-FILE...
// leaks, holes: pixels that differ where the truth (of 16 samples) is the same within a pixel.
// rms: grey levels of 255 at full contrast, over the pixels that the truth covers partly: ours from
// either truth, and the coarse truth's from the fine one.
#include "client/render/assets.h"
#include "client/render/renderer.h"
#include "client/stroke/chain.h"
#include "server/contour/contour_extractor.h"
#include "server/preprocess/hulls/build_hull.h"
#include "tests/corpus/corpus.h"
#include "tests/unit/client/render/outline_coverage.h"

#include "protocol/limits.h"

#include "shared/codec/contour_codec.h"
#include "shared/silhouette/detector.h"

#include <algorithm>
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
};

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
    return compareViews(file, std::move(snapshot));
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
      settings.size = std::clamp(std::atoi(words[++i]), 16, 512);
    } else {
      files.push_back(word);
    }
  }
  auto context = createGlContext(backend);
  auto assets = findAssets();
  if (!context || !assets) {
    const Error& error = context ? assets.error() : context.error();
    std::fprintf(stderr, "limn-clip-bench: %s\n", error.message.c_str());
    return 1;
  }
  auto renderer = Renderer::create(*std::move(context), *assets);
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
