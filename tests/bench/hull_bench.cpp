// SPDX-License-Identifier: Apache-2.0
// GPL because of CGAL's test for self-intersections.
//
// limn-hull-bench MESH FACES [POINTS]: both hulls of a mesh at 14 bits, as one line of JSON: CPU
// seconds, volume over the mesh's at FACES faces, whether that level crosses itself, and over all
// levels asked (FACES and its quarters and fourfolds), how many of POINTS random points and of the
// vertices are on the wrong side, by exact winding numbers.
#include "server/preprocess/hulls/hulls.h"
#include "server/preprocess/import/import.h"
#include "server/preprocess/repair/repair.h"
#include "tests/bench/measure.h"
#include "tests/property/server/preprocess/hulls/self_crossing.h"
#include "tests/property/winding_number.h"

#include "shared/core/rng.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace limn {
namespace {

/// Points and vertices of `inner`'s inside that are outside `outer`.
std::size_t violations(const TriangleMesh& inner, const TriangleMesh& outer, std::uint32_t points) {
  const WindingNumber within(inner);
  const WindingNumber around(outer);
  glm::ivec3 low(INT32_MAX);
  glm::ivec3 high(INT32_MIN);
  for (const glm::ivec3& p : inner.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  std::size_t count = 0;
  const auto check = [&](const glm::ivec3& p) {
    const auto in = within.at(p);
    const auto out = around.at(p);
    if (in && *in > 0 && out && *out <= 0) ++count;
  };
  Rng rng(5);
  for (std::uint32_t i = 0; i < points; ++i) {
    glm::ivec3 p;
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = low[axis] +
                static_cast<int>(rng.below(static_cast<std::uint32_t>(high[axis] - low[axis] + 1)));
    check(p);
  }
  // Vertices count through the points around them: on a surface that touches itself they have
  // no side.
  for (const glm::ivec3& p : inner.positions) {
    for (int i = 0; i < 8; ++i)
      check(p + glm::ivec3(2 * (i & 1) - 1, 2 * (i >> 1 & 1) - 1, 2 * (i >> 2 & 1) - 1));
  }
  return count;
}

int run(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: limn-hull-bench MESH FACES [POINTS]\n");
    return 2;
  }
  const auto faces = static_cast<std::uint32_t>(std::atoi(argv[2]));
  const auto points = static_cast<std::uint32_t>(argc > 3 ? std::atoi(argv[3]) : 0);
  const auto imported = importMesh(std::filesystem::path(argv[1]));
  const auto repaired = imported ? repairMesh(*imported, {14}) : tl::unexpected(imported.error());
  if (!repaired) {
    std::fprintf(stderr, "limn-hull-bench: %s\n", repaired.error().message.c_str());
    return 1;
  }
  const double start = processCpuMs();
  const Hulls hulls = buildHulls(repaired->mesh, {}, 1);
  const double seconds = 1e-3 * (processCpuMs() - start);
  if (!hulls.outer) {
    std::printf("{\"reason\": \"%s\"}\n", hulls.reason.c_str());
    return 0;
  }
  std::printf("{\"faces\": %zu, \"seconds\": %.3f", repaired->mesh.triangles.size(), seconds);
  TriangleMesh mesh = repaired->mesh;  // on the hulls' grid; holes, where filled, stay open here
  for (glm::ivec3& p : mesh.positions)
    p *= 1 << hulls.extraBits;
  for (const bool isOuter : {true, false}) {
    const BuiltHull& built = isOuter ? *hulls.outer : *hulls.inner;
    const auto level = hullAfter(built.hull, built.hull.splitsFor(faces));
    std::size_t wrong = 0;
    if (points > 0 && repaired->closed) {
      for (const std::uint32_t n : {faces / 4, faces, 4 * faces}) {
        const auto asked = hullAfter(built.hull, built.hull.splitsFor(n));
        wrong += isOuter ? violations(mesh, *asked, points) : violations(*asked, mesh, points);
      }
    }
    std::printf(
        ", \"%s\": {\"volume\": %.5f, \"base\": %u, \"clean\": %u, \"crosses\": %s, "
        "\"violations\": %zu}",
        isOuter ? "outer" : "inner",
        hullVolume(built.hull, faces) / hulls.meshVolume,
        built.hull.facesAfter(0),
        built.cleanFaces,
        crossesItself(*level) ? "true" : "false",
        wrong);
  }
  std::printf("}\n");
  return 0;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(argc, argv);
}
