// SPDX-License-Identifier: Apache-2.0
// The ways to draw that find their silhouettes on the GPU, against exact visible contours (edges
// of the mesh, resolved by client/stroke/visibility/resolved_visibility) and, in time, against the
// plain shaded frame: six views at 1024 x 1024, the style "technical" (2 px). One line of JSON a
// mesh and method, on stdout.
//   limn-draw-bench [--gl egl|osmesa] [--frames N] [--save FOLDER] MODEL-FILE...
//   (names of models as tests/corpus knows them). ms: of the processor, on a software renderer
// covered_percent: of the length of visible contours, what has ink within 2 px. false_px: the
// longest extent of ink that is more than 3 px from every visible contour and feature edge.
#include "client/render/image_io.h"
#include "client/render/renderer.h"
#include "client/stroke/chain/chain.h"
#include "client/stroke/visibility/resolved_visibility.h"
#include "tests/bench/measure.h"
#include "tests/corpus/corpus.h"

#include "shared/mesh/feature_edges.h"
#include "shared/silhouette/detector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr int kSize = 1024;
constexpr int kCoverPx = 2;
constexpr int kFalsePx = 3;
/// Share of full ink from which a pixel counts.
constexpr double kInked = 0.25;
/// Of charcoal's greys, (1 + V·N) / 3, only those of back faces are ink.
constexpr double kInkedCharcoal = 0.6;

/// A bit a pixel.
class PixelSet {
 public:
  [[nodiscard]] bool has(int x, int y) const { return isIn(x, y) && bits_[place(x, y)]; }

  void add(int x, int y) {
    if (isIn(x, y)) bits_[place(x, y)] = true;
  }

  void remove(int x, int y) { bits_[place(x, y)] = false; }

  /// All pixels within `radius` of one of the set.
  [[nodiscard]] PixelSet grown(int radius) const {
    PixelSet result;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        if (!bits_[place(x, y)]) continue;
        for (int dy = -radius; dy <= radius; ++dy) {
          for (int dx = -radius; dx <= radius; ++dx) {
            if (dx * dx + dy * dy <= radius * radius) result.add(x + dx, y + dy);
          }
        }
      }
    }
    return result;
  }

 private:
  static bool isIn(int x, int y) { return x >= 0 && y >= 0 && x < kSize && y < kSize; }

  static std::size_t place(int x, int y) {
    return static_cast<std::size_t>(y) * kSize + static_cast<std::size_t>(x);
  }

  std::vector<bool> bits_ = std::vector<bool>(std::size_t{kSize} * kSize);
};

PixelSet inkOf(const Image& image, const RenderOptions& options) {
  const glm::dvec3 paper(*options.paper);
  const double share = options.draw == DrawMode::kBackCharcoal ? kInkedCharcoal : kInked;
  PixelSet ink;
  const double full = glm::length(glm::dvec3(*options.lineColor) - paper) * 255.0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const std::uint8_t* p =
          &image.rgba[4 * (static_cast<std::size_t>(y) * kSize + static_cast<std::size_t>(x))];
      const glm::dvec3 away = glm::dvec3(p[0], p[1], p[2]) - paper * 255.0;
      if (glm::length(away) >= share * full) ink.add(x, y);
    }
  }
  return ink;
}

/// The longest extent of the 8-connected parts of a set; takes the set apart.
int longestExtent(PixelSet set) {
  int longest = 0;
  std::vector<glm::ivec2> open;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      if (!set.has(x, y)) continue;
      glm::ivec2 low(x, y);
      glm::ivec2 high(x, y);
      open.assign(1, {x, y});
      set.remove(x, y);
      while (!open.empty()) {
        const glm::ivec2 p = open.back();
        open.pop_back();
        low = glm::min(low, p);
        high = glm::max(high, p);
        for (int k = 0; k < 9; ++k) {
          const glm::ivec2 q = p + glm::ivec2(k % 3 - 1, k / 3 - 1);
          if (!set.has(q.x, q.y)) continue;
          set.remove(q.x, q.y);
          open.push_back(q);
        }
      }
      longest = std::max({longest, high.x - low.x + 1, high.y - low.y + 1});
    }
  }
  return longest;
}

/// One view's truth.
struct View {
  Camera camera;
  std::vector<glm::dvec2> contour;  // visible, half a pixel apart
  PixelSet known;                   // within kFalsePx of those and of feature edges
};

struct Tally {
  std::size_t points = 0;
  std::size_t covered = 0;
  int falsePx = 0;
  std::vector<double> ms;
};

class Bench {
 public:
  Bench(Renderer renderer, int frames, std::filesystem::path folder)
      : renderer_(std::move(renderer)),
        frames_(frames),
        folder_(std::move(folder)) {}

  bool run(const std::string& file) {
    const corpus::Mesh* model = corpus::model(file);
    if (model == nullptr) {
      std::fprintf(stderr, "limn-draw-bench: no model %s\n", file.c_str());
      return false;
    }
    MeshSnapshot snapshot;
    const auto vertices = static_cast<std::uint32_t>(model->mesh.positions.size());
    auto mesh = ActiveMesh::fromBase({0, vertices}, model->mesh, {});
    if (!mesh) return false;
    snapshot.mesh = *std::move(mesh);
    snapshot.model.grid = model->mesh.grid;
    snapshot.model.sphere = boundingSphere(model->mesh.grid, model->mesh.positions);
    snapshot.model.closed = model->closed;
    snapshot.revision = ++revision_;  // each is another mesh to the renderer's cache
    const std::vector<View> views = findTruth(snapshot);
    double shadedMs = 0.0;
    for (const DrawMode mode : kModes) {
      Tally tally;
      if (!runMode(file, snapshot, views, mode, tally)) return false;
      std::sort(tally.ms.begin(), tally.ms.end());
      const double ms = tally.ms[tally.ms.size() / 2];
      if (mode == DrawMode::kShaded) shadedMs = ms;
      std::printf(
          "{\"mesh\":\"%s\",\"faces\":%u,\"draw\":\"%s\",\"ms\":%.2f,\"of_shaded\":%.2f,"
          "\"covered_percent\":%.3f,\"false_px\":%d}\n",
          file.c_str(),
          snapshot.mesh.mesh().faceCount(),
          std::string(nameOf(mode)).c_str(),
          ms,
          ms / shadedMs,
          100.0 * static_cast<double>(tally.covered) /
              static_cast<double>(std::max<std::size_t>(tally.points, 1)),
          tally.falsePx);
      std::fflush(stdout);
    }
    return true;
  }

 private:
  static constexpr std::array kModes = {
      DrawMode::kShaded,
      DrawMode::kBackWireframe,
      DrawMode::kBackTranslate,
      DrawMode::kBackZScale,
      DrawMode::kBackOffset,
      DrawMode::kBackFatten,
      DrawMode::kBackCharcoal,
      DrawMode::kImageEdges,
      DrawMode::kGeometryShader,
      DrawMode::kConditionalLines,
  };

  static std::vector<View> findTruth(const MeshSnapshot& snapshot) {
    const HalfEdgeMesh& mesh = snapshot.mesh.mesh();
    const SilhouetteField field(mesh, snapshot.mesh.positions(), SilhouetteKind::kEdges);
    const auto detector = makeDetector(DetectorMethod::kBrute, field);
    const VisibilityResolver resolver(mesh, snapshot.mesh.positions());
    const PolylineSet creases = chainFeatures(
        mesh,
        snapshot.mesh.positions(),
        findCreases(mesh, snapshot.mesh.positions(), 35.0));
    std::vector<View> views;
    for (const auto& [azimuth, elevation] : kSixViews) {
      View view;
      view.camera = orbitCamera(snapshot.model.sphere, azimuth, elevation);
      fitDepthRange(snapshot.model.sphere, view.camera);
      const SilhouetteView from{
          snapshot.model.grid.fromModel(view.camera.eye),
          view.camera.forward(),
          false};
      SilhouetteChainer chainer;
      const PolylineSet& lines = chainer.chain(field, from, detector->detect(from));
      view.contour = visiblePoints(lines, snapshot, resolver, view.camera);
      PixelSet marked;
      for (const auto& points :
           {view.contour, visiblePoints(creases, snapshot, resolver, view.camera)}) {
        for (const glm::dvec2& p : points)
          marked.add(static_cast<int>(p.x), static_cast<int>(p.y));
      }
      view.known = marked.grown(kFalsePx);
      views.push_back(std::move(view));
    }
    return views;
  }

  static std::vector<glm::dvec2> visiblePoints(
      const PolylineSet& lines,
      const MeshSnapshot& snapshot,
      const VisibilityResolver& resolver,
      const Camera& camera) {
    const Viewport viewport{kSize, kSize};
    const LineScene scene{
        snapshot.mesh.mesh(),
        snapshot.mesh.positions(),
        snapshot.model.grid,
        camera,
        viewport};
    const ResolvedLines resolved = resolver.resolve(lines, scene);
    const glm::dmat4 clip = camera.clipFromWorld(1.0);
    const auto pixelOf = [&](const glm::dvec3& p) {
      const glm::dvec4 world(snapshot.model.grid.toModel(p), 1.0);
      return glm::dvec2(pixelFromClip(clip * world, viewport));
    };
    std::vector<glm::dvec2> points;
    for (const PolylineSet::Line& line : lines.lines) {
      for (std::uint32_t point = line.begin; point < line.begin + line.segmentCount(); ++point) {
        const std::uint32_t next = point + 1 < line.end ? point + 1 : line.begin;
        const glm::dvec3 a(lines.points[point]);
        const glm::dvec3 b(lines.points[next]);
        const int steps =
            std::max(1, static_cast<int>(2.0 * glm::distance(pixelOf(a), pixelOf(b))));
        for (int i = 0; i < steps; ++i) {
          const double t = (i + 0.5) / steps;
          for (const ResolvedLines::Piece& piece : resolved.piecesOf(point)) {
            if (t > piece.end) continue;
            if (piece.visible) points.push_back(pixelOf(glm::mix(a, b, t)));
            break;
          }
        }
      }
    }
    return points;
  }

  bool runMode(
      const std::string& file,
      const MeshSnapshot& snapshot,
      const std::vector<View>& views,
      DrawMode mode,
      Tally& tally) {
    RenderOptions options;
    options.viewport = {kSize, kSize};
    options.draw = mode;
    options.style = "technical";
    options.lineColor = glm::vec3(0.0F);
    options.paper = glm::vec3(1.0F);
    for (std::size_t v = 0; v < views.size(); ++v) {
      for (int i = 0; i <= frames_; ++i) {
        // Processor time: what neighbours on the machine do is none of it.
        const double start = processCpuMs();
        const auto frame = renderer_.render(snapshot, {}, views[v].camera, options);
        const double ms = processCpuMs() - start;
        if (!frame) {
          std::fprintf(stderr, "limn-draw-bench: %s\n", frame.error().message.c_str());
          return false;
        }
        if (i > 0) {  // the first one makes what the others keep
          tally.ms.push_back(ms);
          continue;
        }
        if (!folder_.empty()) {
          std::string name = std::string(nameOf(mode)) + "-" + std::to_string(v) + ".png";
          std::replace(name.begin(), name.end(), ':', '-');
          (void)writePng(folder_ / (file + "-" + name), frame->image);
        }
        if (mode == DrawMode::kShaded) continue;
        judge(views[v], inkOf(frame->image, options), tally);
      }
    }
    return true;
  }

  static void judge(const View& view, const PixelSet& ink, Tally& tally) {
    const PixelSet near = ink.grown(kCoverPx);
    for (const glm::dvec2& p : view.contour) {
      ++tally.points;
      tally.covered += near.has(static_cast<int>(p.x), static_cast<int>(p.y)) ? 1 : 0;
    }
    PixelSet unexplained = ink;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        if (view.known.has(x, y)) unexplained.remove(x, y);
      }
    }
    tally.falsePx = std::max(tally.falsePx, longestExtent(std::move(unexplained)));
  }

  Renderer renderer_;
  int frames_;
  std::filesystem::path folder_;
  std::uint64_t revision_ = 0;
};

int run(int count, char** words) {
  GlBackend backend = GlBackend::kEgl;
  int frames = 3;
  std::filesystem::path folder;
  std::vector<std::string> files;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word.starts_with("--") && i + 1 == count) {
      std::fprintf(stderr, "limn-draw-bench: %s needs a value\n", word.c_str());
      return 2;
    }
    if (word == "--gl") {
      const auto parsed = parseGlBackend(words[++i]);
      if (!parsed) return 2;
      backend = *parsed;
    } else if (word == "--frames") {
      frames = std::max(1, std::atoi(words[++i]));
    } else if (word == "--save") {
      folder = words[++i];
    } else {
      files.push_back(word);
    }
  }
  auto renderer = Renderer::open(backend);
  if (!renderer) {
    std::fprintf(stderr, "limn-draw-bench: %s\n", renderer.error().message.c_str());
    return 1;
  }
  Bench bench(*std::move(renderer), frames, folder);
  bool ok = !files.empty();
  for (const std::string& file : files)
    ok = bench.run(file) && ok;
  return ok ? 0 : 1;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(argc, argv);
}
