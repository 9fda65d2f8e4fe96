// SPDX-License-Identifier: Apache-2.0
// Curvature and the lines made of it against shapes whose curvature is known exactly.
#include "shared/mesh/primitives.h"
#include "shared/silhouette/curvature.h"
#include "shared/silhouette/ridges.h"
#include "shared/silhouette/suggestive_contours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

constexpr double kTau = 2.0 * std::numbers::pi;
constexpr double kRing = 300'000.0;  // fine enough for rounding to be nothing
constexpr double kTube = 100'000.0;

constexpr CurvatureOptions kUnsmoothed{.smoothing = 0.0, .smoothingEdges = 0.0};

struct Shape {
  std::vector<glm::ivec3> positions;
  std::vector<glm::uvec3> triangles;
  HalfEdgeMesh mesh;

  void link() {
    auto linked = HalfEdgeMesh::build(static_cast<std::uint32_t>(positions.size()), triangles);
    ASSERT_TRUE(linked);
    mesh = std::move(*linked);
  }
};

/// Round z; its rows wind round the tube once, so that few edges run along a principal direction.
Shape torus(int rings, int sides) {
  Shape shape;
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < sides; ++j) {
      const double turn = kTau * i / rings;
      const double side = kTau * (j + double(i) / rings) / sides;
      const double reach = kRing + kTube * std::cos(side);
      shape.positions.emplace_back(glm::round(
          glm::dvec3(reach * std::cos(turn), reach * std::sin(turn), kTube * std::sin(side))));
    }
  }
  const auto at = [&](int i, int j) {
    return static_cast<std::uint32_t>((i % rings) * sides + (j + i / rings) % sides);
  };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < sides; ++j) {
      shape.triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      shape.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  shape.link();
  return shape;
}

/// What geometry says about the torus near a point.
struct TorusPoint {
  explicit TorusPoint(const glm::dvec3& p) {
    const double around = std::hypot(p.x, p.y);
    const glm::dvec3 out(p.x / around, p.y / around, 0.0);
    normal = glm::normalize((around - kRing) * out + glm::dvec3(0.0, 0.0, p.z));
    parallel = glm::dvec3(-out.y, out.x, 0.0);
    meridian = glm::cross(normal, parallel);
    const double cosine = glm::dot(normal, out);
    const double reach = kRing + kTube * cosine;
    curvature = cosine / reach;
    // d/ds (cos φ / (R + r cos φ)) along the meridian; its direction is ±∂/∂φ.
    const glm::dvec3 growing = -normal.z * out + cosine * glm::dvec3(0.0, 0.0, 1.0);
    growth = (glm::dot(growing, meridian) > 0.0 ? -1.0 : 1.0) * kRing * normal.z / (reach * reach) /
             kTube;
  }

  [[nodiscard]] double radial(const glm::dvec3& toEye) const {
    const double u = glm::dot(toEye, meridian);
    const double v = glm::dot(toEye, parallel);
    return (u * u / kTube + v * v * curvature) / (u * u + v * v);
  }

  glm::dvec3 normal;
  glm::dvec3 parallel;  // principal directions
  glm::dvec3 meridian;
  double curvature;  // along the parallel; along the meridian it is 1 / kTube
  double growth;     // of `curvature` along `meridian`
};

/// The nearest point of the torus.
glm::dvec3 onTorus(const glm::dvec3& p) {
  const double around = std::hypot(p.x, p.y);
  const glm::dvec3 centre = glm::dvec3(p.x, p.y, 0.0) * (kRing / around);
  return centre + glm::normalize(p - centre) * kTube;
}

TEST(SurfaceCurvature, OfATorusIsWhatGeometrySays) {
  const Shape shape = torus(180, 90);
  const SurfaceCurvature found = curvatureOf(shape.mesh, shape.positions, kUnsmoothed);
  for (std::size_t v = 0; v < shape.positions.size(); ++v) {
    ASSERT_EQ(found.isKnown[v], 1);
    const TorusPoint truth{glm::dvec3(shape.positions[v])};
    EXPECT_NEAR(found.curvatures[v].x * kTube, 1.0, 0.02);
    EXPECT_NEAR(found.curvatures[v].y * kTube, truth.curvature * kTube, 0.02);
    EXPECT_GT(std::abs(glm::dot(glm::dvec3(found.directions1[v]), truth.meridian)), 0.99);
    EXPECT_GT(glm::dot(glm::dvec3(found.normals[v]), truth.normal), 0.999);
    // The derivative's only part: of the smaller curvature along the first direction.
    const double sign = glm::dot(glm::dvec3(found.directions1[v]), truth.meridian) > 0.0 ? 1 : -1;
    const glm::dvec4 derivative = glm::dvec4(found.derivatives[v]) * (kTube * kTube);
    EXPECT_NEAR(derivative.z, sign * truth.growth * kTube * kTube, 0.04);
    for (const double other : {derivative.x, derivative.y, derivative.w})
      EXPECT_NEAR(other, 0.0, 0.1);  // of ½, the largest
  }
}

TEST(SurfaceCurvature, SmoothingKeepsWhatIsLargeAndIsUnknownOnlyBesideSharpEdges) {
  Shape shape = torus(120, 60);
  const SurfaceCurvature smooth =
      curvatureOf(shape.mesh, shape.positions, {.smoothing = 0.01, .smoothingEdges = 1.0});
  for (const glm::vec2& k : smooth.curvatures)
    EXPECT_NEAR(k.x * kTube, 1.0, 0.05);
  std::vector<std::uint8_t> sharp(shape.mesh.origins.size(), 0);
  sharp[0] = 1;
  sharp[shape.mesh.twin(0)] = 1;
  CurvatureOptions options = kUnsmoothed;
  options.sharp = sharp;
  const SurfaceCurvature found = curvatureOf(shape.mesh, shape.positions, options);
  for (std::uint32_t v = 0; v < shape.positions.size(); ++v) {
    const bool isOn = v == shape.mesh.origin(0) || v == shape.mesh.target(0);
    EXPECT_EQ(found.isKnown[v] == 0, isOn);
  }
}

TEST(SuggestiveContours, OfATorusLieWhereItsRadialCurvatureIsZeroAndGrows) {
  const Shape shape = torus(240, 120);
  const SurfaceCurvature curvature = curvatureOf(shape.mesh, shape.positions, kUnsmoothed);
  SuggestiveContours contours(shape.mesh, shape.positions, curvature, {.threshold = 0.0F});
  for (const bool orthographic : {false, true}) {
    const glm::dvec3 eye(900'000.0, 200'000.0, 1'100'000.0);
    const SilhouetteView view{eye, -glm::normalize(eye), orthographic};
    const auto found = contours.find(view);
    ASSERT_GT(found.size(), 50U);
    const auto toEye = [&](const glm::dvec3& p) {
      return glm::normalize(orthographic ? eye : eye - p);
    };
    for (const SurfaceSegment& segment : found) {
      for (const SurfaceSegment::End& end : segment.ends) {
        if (!(end.strength > 0.0F)) continue;
        EXPECT_LE(end.strength, 1.0F);
        const glm::dvec3 p = onTorus(glm::dvec3(end.point));
        const TorusPoint truth(p);
        EXPECT_GT(glm::dot(truth.normal, toEye(p)), -0.01);
        EXPECT_NEAR(truth.radial(toEye(p)) * kTube, 0.0, 0.05);
        // A step towards the eye along the surface: convex, as at a contour.
        const glm::dvec3 view2 = toEye(p);
        const glm::dvec3 along =
            glm::normalize(view2 - glm::dot(view2, truth.normal) * truth.normal);
        const glm::dvec3 next = onTorus(p + 0.03 * kTube * along);
        const double growth = TorusPoint(next).radial(toEye(next)) - truth.radial(view2);
        EXPECT_GT(growth * kTube, -0.0005);  // of some 0.01 where a line is strong
      }
    }
  }
}

TEST(SuggestiveContours, AConvexSurfaceHasNone) {
  Shape shape = torus(60, 30);
  // A sphere of the same connectivity will not do; the torus's own outside will: faces whose
  // corners are all convex are crossed by no line.
  const SurfaceCurvature curvature = curvatureOf(shape.mesh, shape.positions, kUnsmoothed);
  SuggestiveContours contours(shape.mesh, shape.positions, curvature);
  for (const SurfaceSegment& segment : contours.find({{0.0, 1e6, 8e5}, {}, false})) {
    bool isConvex = true;
    for (std::uint32_t k = 0; k < 3; ++k)
      isConvex = isConvex && curvature.curvatures[shape.mesh.origin(3 * segment.face + k)].y > 0.0F;
    EXPECT_FALSE(isConvex);
  }
}

/// An ellipsoid with three different axes.
Shape ellipsoid(const glm::dvec3& axes) {
  const TriangleMesh sphere = primitives::icosphere(5);
  glm::ivec3 high(0);
  for (const glm::ivec3& p : sphere.positions)
    high = glm::max(high, p);
  Shape shape;
  for (const glm::ivec3& p : sphere.positions)
    shape.positions.emplace_back(
        glm::round(axes * glm::normalize(glm::dvec3(p) - 0.5 * glm::dvec3(high))));
  shape.triangles = sphere.triangles;
  shape.link();
  return shape;
}

TEST(Ridges, OfAnEllipsoidLieInItsPlanesOfSymmetry) {
  const glm::dvec3 axes(900'000.0, 500'000.0, 300'000.0);
  const Shape shape = ellipsoid(axes);
  const SurfaceCurvature curvature = curvatureOf(shape.mesh, shape.positions, kUnsmoothed);
  const auto ridges = findRidges(shape.mesh, shape.positions, curvature, RidgeKind::kRidge, 0.0F);
  double inPlane = 0.0;
  double all = 0.0;
  double sharpest = 0.0;  // round the two ends of the longest axis' equator
  for (const SurfaceSegment& segment : ridges) {
    const glm::dvec3 a(segment.ends[0].point);
    const glm::dvec3 b(segment.ends[1].point);
    const glm::dvec3 middle = glm::abs(0.5 * (a + b)) / axes;
    const double length = glm::distance(a, b);
    all += length;
    if (std::min({middle.x, middle.y, middle.z}) < 0.03) inPlane += length;
    // The ridge of the largest curvature: z = 0, where the ellipsoid is flattest.
    if (middle.z < 0.03) sharpest += length;
  }
  EXPECT_GT(all, 2.0 * axes.x);
  EXPECT_GT(inPlane, 0.99 * all);
  EXPECT_NEAR(sharpest, 4.51e6, 0.06e6);  // the perimeter of the ellipse there
  EXPECT_TRUE(findRidges(shape.mesh, shape.positions, curvature, RidgeKind::kValley).empty());
}

}  // namespace
}  // namespace limn
