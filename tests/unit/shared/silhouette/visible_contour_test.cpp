// SPDX-License-Identifier: Apache-2.0
#include "shared/silhouette/visible_contour.h"

#include "shared/core/rng.h"
#include "shared/mesh/primitives.h"
#include "shared/silhouette/contour_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace limn {
namespace {

glm::dvec3 middleOf(const TriangleMesh& shape) {
  glm::ivec3 low = shape.positions[0];
  glm::ivec3 high = low;
  for (const glm::ivec3& p : shape.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return 0.5 * glm::dvec3(low + high);
}

/// From +z, some radii of the box away, the shape filling most of the picture.
PictureView frontOf(const TriangleMesh& shape, bool orthographic) {
  PictureView picture;
  const glm::dvec3 middle = middleOf(shape);
  const double radius = glm::distance(middle, glm::dvec3(shape.positions[0]));
  picture.eye = middle + glm::dvec3(0.0, 0.0, 4.0 * radius);
  picture.orthographic = orthographic;
  picture.width = 300;
  picture.height = 260;
  picture.pixelsPerUnit = orthographic ? 100.0 / radius : 400.0;
  return picture;
}

struct Scene {
  TriangleMesh shape;
  HalfEdgeMesh mesh;

  explicit Scene(TriangleMesh made)
      : shape(std::move(made)),
        mesh(*HalfEdgeMesh::build(
            static_cast<std::uint32_t>(shape.positions.size()),
            shape.triangles)) {}
};

/// A copy of a shape beside it, farther away along z: what it hides of the copy it hides whole.
TriangleMesh withOneBehind(TriangleMesh shape) {
  const auto count = static_cast<std::uint32_t>(shape.positions.size());
  int low = shape.positions[0].z;
  int high = low;
  for (const glm::ivec3& p : shape.positions) {
    low = std::min(low, p.z);
    high = std::max(high, p.z);
  }
  const std::size_t faces = shape.triangles.size();
  const int middleX = static_cast<int>(middleOf(shape).x);
  const int middleY = static_cast<int>(middleOf(shape).y);
  for (std::uint32_t v = 0; v < count; ++v) {
    const glm::ivec3 p = shape.positions[v];
    shape.positions.emplace_back(
        middleX + (p.x - middleX) / 2,
        middleY + (p.y - middleY) / 2,
        p.z - 2 * (high - low));
  }
  for (std::size_t f = 0; f < faces; ++f)
    shape.triangles.push_back(shape.triangles[f] + count);
  return shape;
}

TEST(NearnessImage, HoldsTheNearestSurfaceAtEachPixel) {
  for (const bool orthographic : {false, true}) {
    const Scene scene(withOneBehind(primitives::bumpySphere(3, 3)));
    PictureView picture = frontOf(scene.shape, orthographic);
    std::vector<glm::vec3> projected;
    for (const glm::ivec3& p : scene.shape.positions)
      projected.emplace_back(picture.project(glm::dvec3(p)));
    for (const Occluders occluders : {Occluders::kFrontFaces, Occluders::kBothSides}) {
      NearnessImage image;
      image.width = picture.width;
      image.height = picture.height;
      drawNearness(scene.shape.triangles, projected, occluders, image);
      Rng rng(4);
      int covered = 0;
      for (int round = 0; round < 400; ++round) {
        const auto x = static_cast<int>(rng.below(static_cast<std::uint32_t>(picture.width)));
        const auto y = static_cast<int>(rng.below(static_cast<std::uint32_t>(picture.height)));
        const glm::dvec2 p(x + 0.5, y + 0.5);
        // Slow oracle: every triangle, in double; a pixel on an edge may go either way.
        double nearest = -std::numeric_limits<double>::infinity();
        bool onEdge = false;
        for (const glm::uvec3& t : scene.shape.triangles) {
          const glm::dvec3 a(projected[t.x]);
          const glm::dvec3 b(projected[t.y]);
          const glm::dvec3 c(projected[t.z]);
          const auto cross = [](const glm::dvec2& u, const glm::dvec2& v) {
            return u.x * v.y - u.y * v.x;
          };
          const double area = cross(glm::dvec2(b - a), glm::dvec2(c - a));
          if (area == 0.0) continue;
          const double wa = cross(glm::dvec2(c - b), p - glm::dvec2(b)) / area;
          const double wb = cross(glm::dvec2(a - c), p - glm::dvec2(c)) / area;
          const double wc = 1.0 - wa - wb;
          const double least = std::min({wa, wb, wc});
          if (std::abs(least) < 1e-3) onEdge = true;
          if (least >= 0.0) nearest = std::max(nearest, wa * a.z + wb * b.z + wc * c.z);
        }
        if (onEdge) continue;
        if (std::isinf(nearest)) {
          EXPECT_TRUE(std::isinf(image.at(x, y)));
        } else {
          ++covered;
          EXPECT_NEAR(image.at(x, y), nearest, 1e-4 * std::abs(nearest));
        }
      }
      EXPECT_GT(covered, 20);
    }
  }
}

TEST(VisibleContour, OfASphereIsItsCircleAndOfWhatItHidesNothing) {
  const Scene alone(primitives::icosphere(5));
  const Scene both(withOneBehind(primitives::icosphere(5)));
  for (const auto kind : {SilhouetteKind::kEdges, SilhouetteKind::kSmooth}) {
    for (const bool orthographic : {false, true}) {
      const PictureView picture = frontOf(alone.shape, orthographic);
      for (const Scene* scene : {&alone, &both}) {
        const SilhouetteField field(scene->mesh, scene->shape.positions, kind);
        VisibleContourFinder finder;
        const auto& points = finder.find(field, picture);
        ASSERT_GT(points.size(), 100U);
        double length = 0.0;
        double low = std::numeric_limits<double>::infinity();
        double high = 0.0;
        for (const ContourPoint& p : points) {
          length += p.lengthPx;
          const double r = glm::distance(glm::dvec2(p.px), glm::dvec2(150.0, 130.0));
          low = std::min(low, r);
          high = std::max(high, r);
        }
        EXPECT_LT(high - low, 0.02 * high) << "no circle, or one within another";
        const double circle = 2.0 * std::numbers::pi * high;
        EXPECT_GT(length, 0.9 * circle) << "not all of it was found";
        EXPECT_LT(length, 1.4 * circle);  // edges zigzag
      }
    }
  }
}

TEST(VisibleContour, OutOfThePictureThereIsNone) {
  const Scene scene(primitives::icosphere(3));
  const SilhouetteField field(scene.mesh, scene.shape.positions, SilhouetteKind::kEdges);
  PictureView picture = frontOf(scene.shape, false);
  VisibleContourFinder finder;
  EXPECT_FALSE(finder.find(field, picture).empty());
  picture.forward = -picture.forward;
  EXPECT_TRUE(finder.find(field, picture).empty()) << "behind the eye";
  picture.forward = -picture.forward;
  picture.eye.x *= 50.0;
  EXPECT_TRUE(finder.find(field, picture).empty()) << "beside the picture";
}

TEST(PixelPoints, DistanceIsWhatComparingWithEveryPointSays) {
  Rng rng(8);
  const auto point = [&rng] {
    // Some beyond the picture's edge.
    return glm::vec2(rng.uniform() * 240.0 - 20.0, rng.uniform() * 140.0 - 20.0);
  };
  for (const int count : {0, 1, 7, 300}) {
    std::vector<glm::vec2> points;
    for (int i = 0; i < count; ++i)
      points.push_back(point());
    for (const double limit : {0.5, 4.0, 60.0}) {
      const PixelPoints grid(points, 200, 100, limit);
      for (int round = 0; round < 300; ++round) {
        const glm::vec2 p = point();
        auto best = static_cast<float>(limit);
        for (const glm::vec2& q : points)
          best = std::min(best, glm::distance(p, q));
        EXPECT_NEAR(grid.distanceTo(p), best, 1e-4);
      }
    }
  }
}

// What a client may say of its camera, and rounding to pixels cannot represent.
TEST(VisibleContour, OfAbsurdViewsIsFinite) {
  const Scene scene(primitives::bumpySphere(3, 3));
  for (const SilhouetteKind kind : {SilhouetteKind::kEdges, SilhouetteKind::kSmooth}) {
    const SilhouetteField field(scene.mesh, scene.shape.positions, kind);
    for (const bool orthographic : {false, true}) {
      for (const double factor : {1e-300, 1e-30, 1e30, 1e300}) {
        PictureView picture = frontOf(scene.shape, orthographic);
        picture.pixelsPerUnit *= factor;
        PictureView far = frontOf(scene.shape, orthographic);
        far.eye *= factor;
        for (const PictureView& view : {picture, far}) {
          VisibleContourFinder finder;
          for (const ContourPoint& point : finder.find(field, view, 0.1)) {
            EXPECT_TRUE(std::isfinite(point.px.x) && std::isfinite(point.px.y));
            EXPECT_TRUE(std::isfinite(point.lengthPx));
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace limn
