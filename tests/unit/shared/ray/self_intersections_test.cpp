// SPDX-License-Identifier: Apache-2.0
#include "shared/ray/self_intersections.h"

#include "shared/mesh/primitives.h"
#include "shared/mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace limn {
namespace {

HalfEdgeMesh link(const TriangleMesh& shape) {
  auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
  EXPECT_TRUE(mesh);
  return std::move(*mesh);
}

void append(const TriangleMesh& part, const glm::ivec3& shift, TriangleMesh& whole) {
  const auto first = static_cast<std::uint32_t>(whole.positions.size());
  for (const glm::ivec3& p : part.positions)
    whole.positions.push_back(p + shift);
  for (const glm::uvec3& t : part.triangles)
    whole.triangles.push_back(t + first);
}

TEST(SelfIntersections, TwoSpheresCrossInTheCircleOfGeometry) {
  const TriangleMesh sphere = primitives::icosphere(4);
  glm::ivec3 high(0);
  for (const glm::ivec3& p : sphere.positions)
    high = glm::max(high, p);
  const double radius = 0.5 * high.x;
  const glm::ivec3 shift(static_cast<int>(radius), 37, 21);
  TriangleMesh both;
  append(sphere, {0, 0, 0}, both);
  append(sphere, shift, both);
  const auto segments = findSelfIntersections(link(both), both.positions);
  ASSERT_GT(segments.size(), 50U);
  // The circle: halfway between the centres, across the line through them.
  const glm::dvec3 axis = glm::normalize(glm::dvec3(shift));
  const glm::dvec3 middle =
      glm::dvec3(0.5 * high.x, 0.5 * high.y, 0.5 * high.z) + 0.5 * glm::dvec3(shift);
  const double half = 0.5 * glm::length(glm::dvec3(shift));
  const double ring = std::sqrt(radius * radius - half * half);
  double length = 0.0;
  std::map<std::uint32_t, int> ends;
  for (const SurfaceSegment& segment : segments) {
    for (const SurfaceSegment::End& end : segment.ends) {
      const glm::dvec3 away = glm::dvec3(end.point) - middle;
      EXPECT_NEAR(glm::dot(away, axis), 0.0, 0.01 * radius);
      EXPECT_NEAR(glm::length(away), ring, 0.01 * radius);
      ++ends[end.node];
    }
    length += glm::distance(segment.ends[0].point, segment.ends[1].point);
  }
  EXPECT_NEAR(length, 2.0 * 3.14159265 * ring, 0.02 * length);
  for (const auto& [node, count] : ends)
    EXPECT_EQ(count, 2) << "the line is broken at node " << node;
}

TEST(SelfIntersections, PartsApartDoNotCrossAndFlushOnesAtMostWhereTheyTouch) {
  const TriangleMesh cube = primitives::cube();
  glm::ivec3 high(0);
  for (const glm::ivec3& p : cube.positions)
    high = glm::max(high, p);
  for (const int gap : {0, 5}) {
    TriangleMesh both;
    append(cube, {0, 0, 0}, both);
    append(cube, {high.x + gap, 100, 200}, both);
    const auto segments = findSelfIntersections(link(both), both.positions);
    EXPECT_TRUE(gap == 0 || segments.empty());
    for (const SurfaceSegment& segment : segments) {
      for (const SurfaceSegment::End& end : segment.ends)
        EXPECT_EQ(end.point.x, static_cast<float>(high.x));
    }
  }
}

TEST(SelfIntersections, MeshesThatDoNotCrossThemselvesHaveNone) {
  for (const TriangleMesh& shape : {primitives::torus(40, 20), primitives::bumpySphere(4, 3)})
    EXPECT_TRUE(findSelfIntersections(link(shape), shape.positions).empty());
}

}  // namespace
}  // namespace limn
