// SPDX-License-Identifier: Apache-2.0
//
// limn-contour-bench MESH...: what a server does for an exact contour of edges, and papers/003's
// table 2 of it: one line of JSON a mesh, means over 101 views from 1.5 to 6 radii. Processor
// milliseconds of one thread: finding and linking, coding, decoding; the same search by brute
// force; edges tested and clusters visited; bytes a point.
#include "server/contour/contour_extractor.h"
#include "server/preprocess/import/import.h"
#include "server/preprocess/repair/repair.h"

#include "protocol/limits.h"
#include "protocol/messages.h"

#include "shared/codec/contour_codec.h"
#include "shared/core/rng.h"

#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

namespace limn {
namespace {

constexpr int kViews = 101;

double processorMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

std::vector<SilhouetteView> viewsOf(const TriangleMesh& mesh) {
  const BoundingSphere sphere = boundingSphere(mesh.grid, mesh.positions);
  Rng rng(3);
  std::vector<SilhouetteView> views(kViews);
  for (int i = 0; i < kViews; ++i) {
    const double azimuth = rng.below(3600) / 10.0;
    const double elevation = rng.below(1600) / 10.0 - 80.0;
    const Camera camera = orbitCamera(sphere, azimuth, elevation, 1.5 + 4.5 * i / kViews);
    views[static_cast<std::size_t>(i)] = {mesh.grid.fromModel(camera.eye), camera.forward(), false};
  }
  return views;
}

int bench(const char* path) {
  const auto imported = importMesh(path);
  const auto repaired = imported ? repairMesh(*imported, {14}) : tl::unexpected(imported.error());
  const auto links = repaired ? HalfEdgeMesh::build(
                                    static_cast<std::uint32_t>(repaired->mesh.positions.size()),
                                    repaired->mesh.triangles)
                              : tl::unexpected(repaired.error());
  if (!links) {
    std::fprintf(stderr, "limn-contour-bench: %s: %s\n", path, links.error().message.c_str());
    return 1;
  }
  const TriangleMesh& mesh = repaired->mesh;
  const SilhouetteField field(*links, mesh.positions, SilhouetteKind::kEdges);
  const ContourExtractor extractor(field);
  const auto cones = makeDetector(DetectorMethod::kCones, field);
  const auto brute = makeDetector(DetectorMethod::kBrute, field);
  double find = 0.0;
  double code = 0.0;
  double decode = 0.0;
  double cone = 0.0;
  double all = 0.0;
  double bytes = 0.0;
  double points = 0.0;
  double edges = 0.0;
  double tested = 0.0;
  double clusters = 0.0;
  for (const SilhouetteView& view : viewsOf(mesh)) {
    static_cast<void>(extractor.extract(view));  // working memory
    double begin = processorMs();
    const ContourLines lines = extractor.extract(view);
    find += processorMs() - begin;
    begin = processorMs();
    const auto coded = encodeContour(lines);
    const auto message = protocol::encodeMessage(protocol::Contour{0, 1, coded});
    code += processorMs() - begin;
    begin = processorMs();
    if (!decodeContour(coded, limits::kMaxContourPoints)) return 1;
    decode += processorMs() - begin;
    begin = processorMs();
    const SilhouetteResult& found = cones->detect(view);
    cone += processorMs() - begin;
    edges += static_cast<double>(found.edges.size());
    tested += found.stats.sitesTested;
    clusters += found.stats.clustersTested;
    begin = processorMs();
    static_cast<void>(brute->detect(view));
    all += processorMs() - begin;
    bytes += static_cast<double>(message.size());
    points += static_cast<double>(lines.points.size());
  }
  std::printf(
      "{\"faces\": %zu, \"edges\": %.0f, \"points\": %.0f, \"planes_tested\": %.0f, \"clusters\": "
      "%.0f, \"cones_ms\": %.4f, \"brute_ms\": %.4f, \"find_ms\": %.4f, \"code_ms\": %.4f, "
      "\"decode_ms\": %.4f, \"answers_a_second\": %.0f, \"bytes_a_point\": %.3f}\n",
      mesh.triangles.size(),
      edges / kViews,
      points / kViews,
      tested / kViews,
      clusters / kViews,
      cone / kViews,
      all / kViews,
      find / kViews,
      code / kViews,
      decode / kViews,
      1000.0 * kViews / (find + code),
      bytes / points);
  return 0;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: limn-contour-bench MESH...\n");
    return 2;
  }
  int status = 0;
  for (int i = 1; i < argc; ++i)
    status |= limn::bench(argv[i]);
  return status;
}
