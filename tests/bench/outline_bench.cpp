// SPDX-License-Identifier: Apache-2.0
// Flaws of drawings with the lines that limn-client draws, in ink, 1024 x 1024, three views. One
// line of JSON a view, on stdout, the largest of each with their places.
//   limn-outline-bench [--out DIR] [--camera AZIMUTH,ELEVATION] MODEL-FILE...
//   MODEL-FILE: names of models as tests/corpus knows them. --out: each view as a PNG, flaws
//   framed.
// Gaps of outlines (red): places where a model's depth image says that something ends and the
// drawing has no line near. What the picture alone tells: breaks (blue), where a line ends and
// seems to go on a few pixels further; doubled lines (orange), two that lie so close together for a
// while that they look like one drawn twice, with paper between them or without.
#include "client/apps/line_finder.h"
#include "client/render/image_io.h"
#include "client/render/renderer.h"
#include "tests/corpus/corpus.h"
#include "tests/unit/client/render/line_flaws.h"
#include "tests/unit/client/render/outline_gaps.h"

#include "shared/mesh/feature_edges.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace limn {
namespace {

using View = std::pair<double, double>;

constexpr std::array<View, 3> kViews = {{{30.0, 20.0}, {150.0, -10.0}, {260.0, 50.0}}};
constexpr int kSize = 1024;
constexpr double kCreaseDegrees = 40.0;  // limn-prepare's
/// Gaps shorter than this are counted in pixels only.
constexpr int kLeastGapPx = 3;
constexpr std::size_t kMostListed = 12;

using Colour = std::array<std::uint8_t, 3>;

constexpr Colour kRed = {255, 0, 0};
constexpr Colour kBlue = {0, 64, 255};
constexpr Colour kOrange = {255, 140, 0};

struct Arguments {
  std::optional<std::filesystem::path> out;
  std::vector<View> views{kViews.begin(), kViews.end()};
  std::vector<std::string> files;
};

/// The model as a client holds it when it has every split.
std::shared_ptr<const MeshSnapshot> snapshotOf(const corpus::Mesh& model, std::uint64_t revision) {
  const auto linked = HalfEdgeMesh::build(
      static_cast<std::uint32_t>(model.mesh.positions.size()),
      model.mesh.triangles);
  if (!linked) return nullptr;
  auto mesh = ActiveMesh::fromBase(
      {0, static_cast<std::uint32_t>(model.mesh.positions.size())},
      model.mesh,
      findCreases(*linked, model.mesh.positions, kCreaseDegrees));
  if (!mesh) return nullptr;
  auto snapshot = std::make_shared<MeshSnapshot>();
  snapshot->mesh = *std::move(mesh);
  snapshot->model.grid = model.mesh.grid;
  snapshot->model.sphere = boundingSphere(model.mesh.grid, model.mesh.positions);
  snapshot->model.closed = model.closed;
  snapshot->revision = revision;  // each is another mesh to the renderer's cache
  return snapshot;
}

/// A frame around what lies between two corners.
void mark(glm::ivec2 low, glm::ivec2 high, const Colour& colour, Image& picture) {
  for (int y = low.y - 4; y <= high.y + 4; ++y) {
    for (int x = low.x - 4; x <= high.x + 4; ++x) {
      const bool isFrame = y == low.y - 4 || y == high.y + 4 || x == low.x - 4 || x == high.x + 4;
      if (!isFrame || x < 0 || y < 0 || x >= picture.width || y >= picture.height) continue;
      const std::size_t i =
          4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
               static_cast<std::size_t>(x));
      std::copy(
          colour.begin(),
          colour.end(),
          picture.rgba.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
}

double totalPx(const std::vector<flaws::Flaw>& found) {
  double px = 0.0;
  for (const flaws::Flaw& flaw : found)
    px += flaw.px;
  return px;
}

void printLargest(const char* name, const std::vector<flaws::Flaw>& found) {
  std::printf(",\"%s\":[", name);
  for (std::size_t i = 0; i < std::min(found.size(), kMostListed); ++i) {
    const glm::ivec2 middle = (found[i].low + found[i].high) / 2;
    std::printf(
        "%s{\"at\":[%d,%d],\"px\":%.1f}",
        i == 0 ? "" : ",",
        middle.x,
        middle.y,
        found[i].px);
  }
  std::printf("]");
}

bool run(
    Renderer& renderer,
    const Arguments& arguments,
    const std::string& file,
    std::uint64_t revision) {
  const corpus::Mesh* model = corpus::model(file);
  const auto snapshot = model != nullptr ? snapshotOf(*model, revision) : nullptr;
  if (snapshot == nullptr) {
    std::fprintf(stderr, "limn-outline-bench: no model %s\n", file.c_str());
    return false;
  }
  LineFinderOptions finding;
  finding.detector = DetectorMethod::kCones;
  LineFinder finder(snapshot, finding);
  for (const auto& [azimuth, elevation] : arguments.views) {
    const Camera camera = orbitCamera(snapshot->model.sphere, azimuth, elevation);
    RenderOptions options;
    options.viewport = {kSize, kSize};
    options.style = "ink";
    options.hidden = HiddenLines::kOff;
    options.paper = glm::vec3(1.0F);
    const LineFinder::Lines lines = finder.find(camera);
    auto drawing = renderer.render(*snapshot, lines.lines, camera, options);
    options.draw = DrawMode::kShaded;
    options.supersample = 1;
    options.keepDepth = true;
    const auto shape = renderer.render(*snapshot, {}, camera, options);
    if (!drawing || !shape) {
      std::fprintf(
          stderr,
          "limn-outline-bench: %s\n",
          (drawing ? shape : drawing).error().message.c_str());
      return false;
    }
    const outline::Gaps found =
        outline::findGaps(drawing->image, shape->depth, camera, snapshot->model.sphere.radius);
    std::size_t count = 0;
    while (count < found.gaps.size() && found.gaps[count].extent() >= kLeastGapPx)
      ++count;
    std::printf(
        "{\"mesh\":\"%s\",\"view\":[%g,%g],\"outline_px\":%d,\"missed_px\":%d,\"gaps\":%zu,"
        "\"largest\":[",
        file.c_str(),
        azimuth,
        elevation,
        found.outlinePixels,
        found.missed,
        count);
    for (std::size_t i = 0; i < std::min(count, kMostListed); ++i) {
      const outline::Gap& gap = found.gaps[i];
      std::printf(
          "%s{\"at\":[%d,%d],\"px\":%d,\"outer\":%s}",
          i == 0 ? "" : ",",
          (gap.low.x + gap.high.x) / 2,
          (gap.low.y + gap.high.y) / 2,
          gap.extent(),
          gap.isOuter ? "true" : "false");
    }
    std::printf("]");
    const flaws::Flaws drawn = flaws::find(drawing->image);
    std::printf(
        ",\"breaks\":%zu,\"break_px\":%.0f,\"doubled_px\":%.0f",
        drawn.breaks.size(),
        totalPx(drawn.breaks),
        totalPx(drawn.doubles));
    printLargest("largest_breaks", drawn.breaks);
    printLargest("largest_doubles", drawn.doubles);
    std::printf("}\n");
    std::fflush(stdout);
    if (!arguments.out) continue;
    for (std::size_t i = 0; i < count; ++i)
      mark(found.gaps[i].low, found.gaps[i].high, kRed, drawing->image);
    for (const flaws::Flaw& flaw : drawn.breaks)
      mark(flaw.low, flaw.high, kBlue, drawing->image);
    for (const flaws::Flaw& flaw : drawn.doubles)
      mark(flaw.low, flaw.high, kOrange, drawing->image);
    const std::string name = std::filesystem::path(file).stem().string() + "_" +
                             std::to_string(static_cast<int>(azimuth)) + "_" +
                             std::to_string(static_cast<int>(elevation)) + ".png";
    if (const auto ok = writePng(*arguments.out / name, drawing->image); !ok) {
      std::fprintf(stderr, "limn-outline-bench: %s\n", ok.error().message.c_str());
      return false;
    }
  }
  return true;
}

int run(const Arguments& arguments) {
  auto renderer = Renderer::open(GlBackend::kOsmesa);
  if (!renderer) {
    std::fprintf(stderr, "limn-outline-bench: %s\n", renderer.error().message.c_str());
    return 1;
  }
  bool ok = !arguments.files.empty();
  std::uint64_t revision = 0;
  for (const std::string& file : arguments.files)
    ok = run(*renderer, arguments, file, ++revision) && ok;
  return ok ? 0 : 1;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  limn::Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    limn::View view;
    if (word == "--out" && i + 1 < argc) {
      arguments.out = argv[++i];
    } else if (
        word == "--camera" && i + 1 < argc &&
        std::sscanf(argv[++i], "%lf,%lf", &view.first, &view.second) == 2) {
      arguments.views = {view};
    } else {
      arguments.files.push_back(word);
    }
  }
  return limn::run(arguments);
}
