// SPDX-License-Identifier: Apache-2.0
// Resolved line visibility on the CPU: how much of it is wrong against ray casts (Embree's where
// this program was built with it), and how long it takes. One line of JSON a mesh, on stdout.
//   limn-visibility-bench MODEL-FILE...   (names of models as tests/corpus knows them)
#include "client/stroke/chain/chain.h"
#include "client/stroke/visibility/resolved_visibility.h"
#include "tests/bench/measure.h"
#include "tests/bench/visibility_truth.h"
#include "tests/corpus/corpus.h"

#include "shared/mesh/edge_shape.h"
#include "shared/silhouette/detector.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace limn {
namespace {

constexpr int kRounds = 3;

bool benchMesh(const std::string& file) {
  const corpus::Mesh* model = corpus::model(file);
  if (model == nullptr) {
    std::fprintf(stderr, "limn-visibility-bench: no model %s\n", file.c_str());
    return false;
  }
  const TriangleMesh& shape = model->mesh;
  auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
  if (!mesh) return false;
  const auto start = processCpuMs();
  const VisibilityResolver resolver(*mesh, shape.positions);
  const double buildMs = processCpuMs() - start;
  const auto truth = VisibilityTruth::create(*mesh, shape.positions);

  const SilhouetteField field(*mesh, shape.positions, SilhouetteKind::kEdges);
  const SilhouetteField smoothField(*mesh, shape.positions, SilhouetteKind::kSmooth);
  const auto detector = makeDetector(DetectorMethod::kBrute, field);
  const auto smoothDetector = makeDetector(DetectorMethod::kBrute, smoothField);
  SilhouetteChainer chainer;
  const BoundingSphere sphere = boundingSphere(shape.grid, shape.positions);
  std::vector<double> times;
  std::vector<double> smoothTimes;
  double truthMs = 0.0;
  std::uint32_t rays = 0;
  std::size_t edges = 0;
  std::size_t falseVisible = 0;
  std::size_t falseHidden = 0;
  for (const auto& [azimuth, elevation] : kSixViews) {
    const Camera camera = orbitCamera(sphere, azimuth, elevation);
    const SilhouetteView view{shape.grid.fromModel(camera.eye), camera.forward(), false};
    const LineScene scene{*mesh, shape.positions, shape.grid, camera, Viewport{1024, 1024}};
    const auto timeOf = [&](const PolylineSet& lines) {
      double best = 1e30;
      for (int round = 0; round < kRounds; ++round) {
        const auto begin = processCpuMs();
        static_cast<void>(resolver.resolve(lines, scene));
        best = std::min(best, processCpuMs() - begin);
      }
      return best;
    };
    smoothTimes.push_back(timeOf(chainer.chain(smoothField, view, smoothDetector->detect(view))));
    const PolylineSet& lines = chainer.chain(field, view, detector->detect(view));
    times.push_back(timeOf(lines));
    const ResolvedLines resolved = resolver.resolve(lines, scene);
    rays += resolved.rays;
    const auto visible = segmentVisibility(lines, resolved, scene);
    if (!truth) continue;
    const auto begin = processCpuMs();
    for (const PolylineSet::Line& line : lines.lines) {
      for (std::uint32_t k = 0; k < line.segmentCount(); ++k) {
        const HalfEdgeId h = lines.halfEdges[line.begin + k];
        const bool expected =
            !isConcave(*mesh, shape.positions, h) && truth->isVisible(h, view.eye);
        const bool found = visible[line.begin + k] != 0;
        ++edges;
        falseVisible += found && !expected ? 1 : 0;
        falseHidden += expected && !found ? 1 : 0;
      }
    }
    truthMs += (processCpuMs() - begin) / static_cast<double>(kSixViews.size());
  }
  std::printf(
      "{\"mesh\":\"%s\",\"faces\":%u,\"build_ms\":%.3f,\"edges_ms\":%.3f,\"smooth_ms\":%.3f",
      file.c_str(),
      mesh->faceCount(),
      buildMs,
      median(times),
      median(smoothTimes));
  if (truth && edges > 0) {
    const auto percent = [&](std::size_t n) {
      return 100.0 * static_cast<double>(n) / static_cast<double>(edges);
    };
    std::printf(
        ",\"edges\":%zu,\"false_visible_percent\":%.4f,\"false_hidden_percent\":%.4f,"
        "\"embree_ms\":%.3f,\"rays\":%u",
        edges,
        percent(falseVisible),
        percent(falseHidden),
        truthMs,
        rays);
  }
  std::printf("}\n");
  return true;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  bool ok = argc > 1;
  for (int i = 1; i < argc; ++i)
    ok = limn::benchMesh(argv[i]) && ok;
  return ok ? 0 : 1;
}
