// SPDX-License-Identifier: Apache-2.0
#include "server/contour/contour_extractor.h"

#include "shared/core/rng.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

namespace limn {
namespace {

using Edge = std::array<int, 6>;  // both ends' positions

Edge edgeOf(const glm::ivec3& a, const glm::ivec3& b) {
  return {a.x, a.y, a.z, b.x, b.y, b.z};
}

HalfEdgeMesh linked(const TriangleMesh& mesh) {
  auto links =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  EXPECT_TRUE(links) << links.error().message;
  return *links;
}

TriangleMesh withoutLastFaces(TriangleMesh mesh, std::size_t faces) {
  mesh.triangles.resize(mesh.triangles.size() - faces);
  return mesh;
}

std::vector<TriangleMesh> meshes() {
  return {
      primitives::bumpySphere(4, 3),
      primitives::torus(40, 20),
      primitives::tetrahedron(),
      withoutLastFaces(primitives::bumpySphere(4, 5), 300)};
}

SilhouetteView viewFrom(const TriangleMesh& mesh, Rng& rng, int round) {
  glm::dvec3 low(mesh.positions.front());
  glm::dvec3 high = low;
  for (const glm::ivec3& p : mesh.positions) {
    low = glm::min(low, glm::dvec3(p));
    high = glm::max(high, glm::dvec3(p));
  }
  const auto any = [&rng] { return rng.below(2001) / 1000.0 - 1.0; };
  const glm::dvec3 direction = glm::normalize(glm::dvec3(any(), any(), any() + 1e-3));
  SilhouetteView view;
  view.eye =
      (low + high) / 2.0 + direction * glm::length(high - low) * (round % 2 == 0 ? 1.5 : 4.0);
  view.forward = -direction;
  view.orthographic = round % 5 == 0;
  return view;
}

/// The oriented edges between faces that face the eye and faces that do not, by brute force.
std::multiset<Edge> silhouetteOf(const SilhouetteField& field, const SilhouetteView& view) {
  const HalfEdgeMesh& mesh = field.mesh();
  const glm::vec4 eye = field.eyeOf(view);
  std::multiset<Edge> edges;
  for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
    if (mesh.twin(h) == kNone) continue;
    if (field.isFront(HalfEdgeMesh::face(h), eye) &&
        !field.isFront(HalfEdgeMesh::face(mesh.twin(h)), eye)) {
      edges.insert(edgeOf(field.positions()[mesh.origin(h)], field.positions()[mesh.target(h)]));
    }
  }
  return edges;
}

TEST(ContourExtractor, EdgeLinesAreTheSilhouetteEdgesEachOnceFrontToTheLeft) {
  Rng rng(1);
  for (const TriangleMesh& mesh : meshes()) {
    const HalfEdgeMesh links = linked(mesh);
    const SilhouetteField field(links, mesh.positions, SilhouetteKind::kEdges);
    const ContourExtractor extractor(field);
    for (int round = 0; round < 20; ++round) {
      const SilhouetteView view = viewFrom(mesh, rng, round);
      const ContourLines lines = extractor.extract(view);
      std::multiset<Edge> found;
      for (const ContourLines::Line& line : lines.lines) {
        for (std::uint32_t i = line.begin; i + 1 < line.end; ++i)
          found.insert(edgeOf(lines.points[i], lines.points[i + 1]));
        if (line.closed) found.insert(edgeOf(lines.points[line.end - 1], lines.points[line.begin]));
        EXPECT_TRUE(line.closed || field.hasBorder());
      }
      EXPECT_EQ(found, silhouetteOf(field, view));
    }
  }
}

TEST(ContourExtractor, SmoothLinesHaveAPointOnEachCrossedEdge) {
  Rng rng(2);
  for (const TriangleMesh& mesh : meshes()) {
    const HalfEdgeMesh links = linked(mesh);
    const SilhouetteField field(links, mesh.positions, SilhouetteKind::kSmooth);
    const ContourExtractor extractor(field);
    for (int round = 0; round < 20; ++round) {
      const SilhouetteView view = viewFrom(mesh, rng, round);
      const ContourLines lines = extractor.extract(view);
      const glm::vec4 eye = field.eyeOf(view);
      std::size_t crossed = 0;
      for (HalfEdgeId h = 0; h < links.origins.size(); ++h) {
        const bool counts = links.twin(h) == kNone || h < links.twin(h);
        if (counts && field.isFront(links.origin(h), eye) != field.isFront(links.target(h), eye))
          ++crossed;
      }
      EXPECT_EQ(lines.points.size(), crossed);
      for (const ContourLines::Line& line : lines.lines)
        EXPECT_TRUE(line.closed || field.hasBorder());
    }
  }
}

}  // namespace
}  // namespace limn
