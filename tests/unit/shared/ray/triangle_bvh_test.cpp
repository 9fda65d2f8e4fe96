// SPDX-License-Identifier: Apache-2.0
#include "shared/ray/triangle_bvh.h"

#include "shared/core/rng.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace limn {
namespace {

/// Whether the ray meets the triangle [Möller, Trumbore 1997]; away from rims it cannot be wrong.
bool meets(const Ray& ray, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a;
  const glm::dvec3 ac = c - a;
  const glm::dvec3 q = glm::cross(ray.direction, ac);
  const double det = glm::dot(ab, q);
  if (det == 0.0) return false;
  const glm::dvec3 ap = ray.origin - a;
  const double u = glm::dot(ap, q) / det;
  const glm::dvec3 r = glm::cross(ap, ab);
  const double v = glm::dot(ray.direction, r) / det;
  const double t = glm::dot(ac, r) / det;
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > ray.begin && t < ray.end;
}

std::vector<FaceId> bruteHits(const TriangleMesh& mesh, const Ray& ray) {
  std::vector<FaceId> hits;
  const auto at = [&](std::uint32_t v) { return glm::dvec3(mesh.positions[v]); };
  for (FaceId f = 0; f < mesh.triangles.size(); ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    if (meets(ray, at(t.x), at(t.y), at(t.z))) hits.push_back(f);
  }
  return hits;
}

glm::dvec3 randomDirection(Rng& rng) {
  while (true) {
    const glm::dvec3 d(
        2.0 * rng.uniform() - 1.0,
        2.0 * rng.uniform() - 1.0,
        2.0 * rng.uniform() - 1.0);
    if (glm::length(d) > 0.1 && glm::length(d) < 1.0) return d;
  }
}

std::vector<FaceId> facesOf(std::vector<RayHit> hits) {
  std::vector<FaceId> faces;
  for (const RayHit& hit : hits)
    faces.push_back(hit.face);
  std::sort(faces.begin(), faces.end());
  return faces;
}

TEST(TriangleBvh, FindsWhatTestingEveryFaceFinds) {
  for (const TriangleMesh& mesh :
       {primitives::torusKnot(2, 3, 96, 16), primitives::bumpySphere(3, 5), primitives::cube()}) {
    const TriangleBvh bvh(mesh.positions, mesh.triangles);
    const BoundingSphere sphere = boundingSphere(mesh.grid, mesh.positions);
    const glm::dvec3 center = mesh.grid.fromModel(sphere.center);
    const double radius = sphere.radius / mesh.grid.step;
    Rng rng(7);
    std::size_t met = 0;
    for (int i = 0; i < 2000; ++i) {
      // From within, from nearby and from far away; towards the mesh.
      const double away = i % 3 == 0 ? 0.3 : i % 3 == 1 ? 1.5 : 1e6;
      Ray ray;
      ray.origin = center + away * radius * randomDirection(rng);
      ray.direction = center + radius * randomDirection(rng) - ray.origin;
      if (i % 5 == 0) ray.end = 1.0;
      if (i % 7 == 0) ray.begin = 0.5;
      const std::vector<FaceId> truth = bruteHits(mesh, ray);
      met += truth.size();
      ASSERT_EQ(facesOf(bvh.allHits(ray)), truth) << "ray " << i;
      ASSERT_EQ(bvh.isBlocked(ray), !truth.empty());
      ASSERT_EQ(bvh.firstHit(ray).has_value(), !truth.empty());
      EXPECT_FALSE(bvh.isBlocked(ray, truth));
      EXPECT_FALSE(bvh.firstHit(ray, truth).has_value());
    }
    EXPECT_GT(met, 500U);
  }
}

TEST(TriangleBvh, FirstHitIsTheNearestOfAll) {
  const TriangleMesh mesh = primitives::torusKnot(2, 3, 96, 16);
  const TriangleBvh bvh(mesh.positions, mesh.triangles);
  Rng rng(3);
  for (int i = 0; i < 500; ++i) {
    const Ray ray{glm::dvec3(8000.0) + 20000.0 * randomDirection(rng), randomDirection(rng)};
    const auto all = bvh.allHits(ray);
    const auto first = bvh.firstHit(ray);
    ASSERT_EQ(first.has_value(), !all.empty());
    for (const RayHit& hit : all)
      EXPECT_GE(hit.t, first->t);
  }
}

TEST(TriangleBvh, NothingSlipsThroughAtEdgesAndCorners) {
  const TriangleMesh mesh = primitives::bumpySphere(3, 5);
  const TriangleBvh bvh(mesh.positions, mesh.triangles);
  glm::dvec3 inside(0.0);
  for (const glm::ivec3& p : mesh.positions)
    inside += glm::dvec3(p) / static_cast<double>(mesh.positions.size());
  for (const glm::uvec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 a(mesh.positions[t[k]]);
      const glm::dvec3 b(mesh.positions[t[(k + 1) % 3]]);
      for (const double share : {0.0, 0.5, 0.3137}) {
        const Ray ray{inside, a + share * (b - a) - inside};
        ASSERT_TRUE(bvh.isBlocked(ray));
        ASSERT_FALSE(bvh.firstHit(ray)->front);
      }
    }
  }
}

TEST(TriangleBvh, RaysAlongAnAxisAndMeshesOfNothingAreFine) {
  const TriangleMesh mesh = primitives::cube();
  const TriangleBvh bvh(mesh.positions, mesh.triangles);
  glm::dvec3 low(mesh.positions[0]);
  glm::dvec3 high = low;
  for (const glm::ivec3& p : mesh.positions) {
    low = glm::min(low, glm::dvec3(p));
    high = glm::max(high, glm::dvec3(p));
  }
  const glm::dvec3 middle = 0.5 * (low + high);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Ray ray;
      ray.origin = middle;
      ray.direction = glm::dvec3(0.0);
      ray.direction[axis] = sign;
      EXPECT_TRUE(bvh.isBlocked(ray));
      ray.origin[axis] = (sign > 0.0 ? high : low)[axis] + sign;
      EXPECT_FALSE(bvh.isBlocked(ray));
    }
  }
  EXPECT_FALSE(TriangleBvh().isBlocked({}));
  EXPECT_FALSE(TriangleBvh({}, {}).firstHit({}).has_value());
}

}  // namespace
}  // namespace limn
