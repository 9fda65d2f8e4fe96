// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain/crease_contours.h"

#include "shared/mesh/primitives.h"
#include "shared/progressive/vertex_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace limn {
namespace {

HalfEdgeMesh link(const TriangleMesh& mesh) {
  auto linked =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  EXPECT_TRUE(linked);
  return std::move(*linked);
}

glm::dvec3 faceNormal(const TriangleMesh& shape, FaceId f) {
  const glm::uvec3& t = shape.triangles[f];
  const glm::dvec3 a(shape.positions[t.x]);
  return glm::normalize(
      glm::cross(glm::dvec3(shape.positions[t.y]) - a, glm::dvec3(shape.positions[t.z]) - a));
}

/// Creases where faces turn by more than 40°.
std::vector<std::uint8_t> creases(const HalfEdgeMesh& mesh, const TriangleMesh& shape) {
  std::vector<std::uint8_t> features(mesh.origins.size(), 0);
  for (HalfEdgeId h = 0; h < features.size(); ++h) {
    if (glm::dot(faceNormal(shape, h / 3), faceNormal(shape, mesh.twins[h] / 3)) < 0.766)
      features[h] = kFeatureCrease;
  }
  return features;
}

/// A drum: two flat ends and a round side, about the z axis.
TriangleMesh drum(std::uint32_t sides) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    const glm::ivec2 p(
        static_cast<int>(std::lround(8000.0 + 6000.0 * std::cos(angle))),
        static_cast<int>(std::lround(8000.0 + 6000.0 * std::sin(angle))));
    mesh.positions.emplace_back(p, 4000);
    mesh.positions.emplace_back(p, 12000);
  }
  mesh.positions.emplace_back(8000, 8000, 4000);
  mesh.positions.emplace_back(8000, 8000, 12000);
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t j = (i + 1) % sides;
    mesh.triangles.emplace_back(2 * i, 2 * j, 2 * j + 1);
    mesh.triangles.emplace_back(2 * i, 2 * j + 1, 2 * i + 1);
    mesh.triangles.emplace_back(2 * j, 2 * i, 2 * sides);
    mesh.triangles.emplace_back(2 * i + 1, 2 * j + 1, 2 * sides + 1);
  }
  return mesh;
}

struct Contours {
  Contours(const TriangleMesh& shape, const SilhouetteView& view)
      : mesh(link(shape)),
        field(mesh, shape.positions, SilhouetteKind::kSmooth),
        creaseContours(field, creases(mesh, shape)),
        detector(makeDetector(DetectorMethod::kBrute, field)),
        lines(creaseContours.chain(view, detector->detect(view), chainer)) {}

  HalfEdgeMesh mesh;
  SilhouetteField field;
  CreaseContours creaseContours;
  std::unique_ptr<SilhouetteDetector> detector;
  SilhouetteChainer chainer;
  PolylineSet lines;
};

const SilhouetteView kAslant{{60000.0, 41000.0, 52000.0}, {}, false};

TEST(CreaseContours, ACubesContourIsTheHexagonOfItsCreases) {
  const TriangleMesh shape = primitives::cube();
  SilhouetteView view;
  view.eye = glm::dvec3(shape.positions[0]) + glm::dvec3(3.1, 4.2, 5.3) * 20000.0;
  const Contours cube(shape, view);
  ASSERT_EQ(cube.lines.lines.size(), 1U);
  EXPECT_TRUE(cube.lines.lines[0].closed);
  EXPECT_EQ(cube.lines.lines[0].segmentCount(), 6U);
  for (const HalfEdgeId h : cube.lines.halfEdges) {
    ASSERT_NE(h, kNone);
    const auto faces = [&](HalfEdgeId e) {
      const FaceId f = HalfEdgeMesh::face(e);
      const glm::dvec3 corner(shape.positions[cube.mesh.origin(e)]);
      return glm::dot(faceNormal(shape, f), view.eye - corner);
    };
    EXPECT_GT(faces(h), 0.0);
    EXPECT_LT(faces(cube.mesh.twin(h)), 0.0);
  }
}

TEST(CreaseContours, ADrumsSideHasStraightContoursFromRimToRim) {
  const TriangleMesh shape = drum(48);
  const Contours found(shape, kAslant);
  ASSERT_FALSE(found.creaseContours.isEmpty());
  ASSERT_EQ(found.lines.lines.size(), 1U);  // two sides and half of either rim, joined
  EXPECT_TRUE(found.lines.lines[0].closed);
  const PolylineSet::Line& line = found.lines.lines[0];
  for (std::uint32_t i = line.begin; i < line.end; ++i) {
    if (found.lines.halfEdges[i] != kNone) continue;
    // Inside a face of the side: the line there runs straight up and down.
    const std::uint32_t next = i + 1 < line.end ? i + 1 : line.begin;
    const glm::vec3 along = found.lines.points[next] - found.lines.points[i];
    EXPECT_GT(std::abs(along.z), 10.0F * std::abs(along.x)) << i;
    EXPECT_GT(std::abs(along.z), 10.0F * std::abs(along.y)) << i;
  }
  // The plain silhouette goes across the side instead: its normals are averaged with the ends'.
  SilhouetteChainer chainer;
  const PolylineSet plain = chainer.chain(found.field, kAslant, found.detector->detect(kAslant));
  EXPECT_FALSE(plain.lines.empty());
}

TEST(CreaseContours, LoopsCloseAndSegmentsGoOnFromOneAnother) {
  for (const int sides : {12, 31, 64}) {
    for (int k = 0; k < 24; ++k) {
      SilhouetteView view;
      const double a = 0.7 * k;
      view.eye = glm::dvec3(8000.0) +
                 40000.0 * glm::dvec3(std::cos(a), std::sin(a), 1.3 * std::sin(2.3 * a));
      const Contours found(drum(static_cast<std::uint32_t>(sides)), view);
      for (const PolylineSet::Line& line : found.lines.lines)
        EXPECT_TRUE(line.closed) << sides << " sides, view " << k;
    }
  }
}

/// A closed shape in two halves that are not joined: what lies above z has vertices of its own, a
/// grid unit aside, and in the middle of each second of its border edges.
TriangleMesh cracked(const TriangleMesh& shape, int z) {
  TriangleMesh mesh;
  mesh.positions = shape.positions;
  const auto isAbove = [&](const glm::uvec3& t) {
    return shape.positions[t.x].z + shape.positions[t.y].z + shape.positions[t.z].z > 3 * z;
  };
  std::map<std::uint32_t, std::uint32_t> copies;
  const auto copyOf = [&](std::uint32_t v) {
    const auto [known, isNew] =
        copies.try_emplace(v, static_cast<std::uint32_t>(mesh.positions.size()));
    if (isNew) mesh.positions.push_back(shape.positions[v] + glm::ivec3(0, 0, 1));
    return known->second;
  };
  const HalfEdgeMesh linked = link(shape);
  for (FaceId f = 0; f < shape.triangles.size(); ++f) {
    const glm::uvec3& t = shape.triangles[f];
    if (!isAbove(t)) {
      mesh.triangles.push_back(t);
      continue;
    }
    std::array<std::uint32_t, 3> corners = {copyOf(t.x), copyOf(t.y), copyOf(t.z)};
    HalfEdgeId split = kNone;
    for (HalfEdgeId h = 3 * f; h < 3 * f + 3; ++h) {
      const FaceId across = HalfEdgeMesh::face(linked.twin(h));
      if (!isAbove(shape.triangles[across]) && across % 2 == 0) split = h - 3 * f;
    }
    if (split == kNone) {
      mesh.triangles.emplace_back(corners[0], corners[1], corners[2]);
      continue;
    }
    std::rotate(corners.begin(), corners.begin() + split, corners.end());
    const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back((mesh.positions[corners[0]] + mesh.positions[corners[1]]) / 2);
    mesh.triangles.emplace_back(corners[0], middle, corners[2]);
    mesh.triangles.emplace_back(middle, corners[1], corners[2]);
  }
  return mesh;
}

TEST(CreaseContours, LoopsCloseAcrossCracks) {
  const TriangleMesh whole = primitives::bumpySphere(3, 3);
  glm::dvec3 center(0.0);
  for (const glm::ivec3& p : whole.positions)
    center += glm::dvec3(p) / static_cast<double>(whole.positions.size());
  const TriangleMesh shape = cracked(whole, static_cast<int>(center.z));
  const HalfEdgeMesh mesh = link(shape);
  const Cracks cracks = findCracks(mesh, shape.positions);
  ASSERT_GT(cracks.parts.size(), 20U);
  const SilhouetteField field(mesh, shape.positions, SilhouetteKind::kSmooth);
  const auto detector = makeDetector(DetectorMethod::kBrute, field);
  const std::vector<std::uint8_t> none(mesh.origins.size(), 0);
  CreaseContours contours(field, none, cracks.parts);
  CreaseContours halves(field, none);
  EXPECT_TRUE(halves.isEmpty());
  SilhouetteChainer chainer;
  std::size_t openHalves = 0;
  for (int k = 0; k < 60; ++k) {
    SilhouetteView view;
    const double a = 0.7 * k;
    view.eye = center + 60000.0 * glm::dvec3(std::cos(a), std::sin(a), 1.3 * std::sin(2.3 * a));
    const SilhouetteResult& found = detector->detect(view);
    for (const PolylineSet::Line& line : halves.chain(view, found, chainer).lines)
      openHalves += line.closed ? 0 : 1;
    const PolylineSet& lines = contours.chain(view, found, chainer);
    for (const PolylineSet::Line& line : lines.lines)
      EXPECT_TRUE(line.closed) << "view " << k << ", " << line.segmentCount() << " segments";
    for (const HalfEdgeId h : lines.halfEdges)
      EXPECT_TRUE(h == kNone || mesh.twin(h) == kNone);
  }
  EXPECT_GT(openHalves, 60U);
}

TEST(CreaseContours, AMeshWithoutCreasesIsLeftToTheChainer) {
  const Contours found(primitives::torus(40, 24), kAslant);
  EXPECT_TRUE(found.creaseContours.isEmpty());
  EXPECT_FALSE(found.lines.lines.empty());
}

}  // namespace
}  // namespace limn
