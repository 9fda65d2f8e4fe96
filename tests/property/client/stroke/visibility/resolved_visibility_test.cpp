// SPDX-License-Identifier: Apache-2.0
// Resolved visibility against rays cast through every face, at places all along every segment, so
// that a missing cut shows as well as a wrong answer.
#include "client/stroke/visibility/resolved_visibility.h"

#include "client/stroke/chain/chain.h"
#include "tests/property/segment_meets.h"

#include "shared/core/rng.h"
#include "shared/mesh/edge_shape.h"
#include "shared/mesh/feature_edges.h"
#include "shared/mesh/primitives.h"
#include "shared/progressive/vertex_split.h"
#include "shared/silhouette/detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace limn {
namespace {

struct Model {
  TriangleMesh shape;
  HalfEdgeMesh mesh;

  explicit Model(TriangleMesh from) : shape(std::move(from)) {
    auto built =
        HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
    EXPECT_TRUE(built);
    if (built) mesh = *std::move(built);
  }

  [[nodiscard]] glm::dvec3 at(HalfEdgeId h) const {
    return glm::dvec3(shape.positions[mesh.origin(h)]);
  }
};

/// The truth at one place of edge h.
bool isVisible(const Model& model, const Camera& camera, HalfEdgeId h, const glm::dvec3& p) {
  const HalfEdgeMesh& mesh = model.mesh;
  const glm::dvec3 eye = model.shape.grid.fromModel(camera.eye);
  const glm::dvec3 toEye = camera.orthographic ? -1e6 * camera.forward() : eye - p;
  const HalfEdgeId twin = mesh.twin(h);
  const auto isFront = [&](FaceId f) {
    const glm::dvec3 a = model.at(3 * f);
    const glm::dvec3 n = glm::cross(model.at(3 * f + 1) - a, model.at(3 * f + 2) - a);
    return glm::dot(n, camera.orthographic ? toEye : eye - a) > 0.0;
  };
  if (twin != kNone && isFront(HalfEdgeMesh::face(h)) != isFront(HalfEdgeMesh::face(twin)) &&
      isConcave(mesh, model.shape.positions, h)) {
    return false;
  }
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    if (f == HalfEdgeMesh::face(h) || (twin != kNone && f == HalfEdgeMesh::face(twin))) continue;
    const auto t = meets(model.at(3 * f), model.at(3 * f + 1), model.at(3 * f + 2), p, toEye);
    if (t && *t > 1e-9 && *t < 1.0) return false;
  }
  return true;
}

/// Silhouette edges and all features, from one camera.
PolylineSet linesOf(const Model& model, const Camera& camera) {
  const SilhouetteField field(model.mesh, model.shape.positions, SilhouetteKind::kEdges);
  const auto detector = makeDetector(DetectorMethod::kBrute, field);
  const SilhouetteView view{
      model.shape.grid.fromModel(camera.eye),
      camera.forward(),
      camera.orthographic};
  SilhouetteChainer chainer;
  PolylineSet all = chainer.chain(field, view, detector->detect(view));
  std::vector<std::uint8_t> features(model.mesh.origins.size(), 0);
  for (HalfEdgeId h = 0; h < features.size(); ++h) {
    const HalfEdgeId twin = model.mesh.twin(h);
    // Every third edge, so that lines on the flat and on the far side are asked about too.
    if (twin != kNone && std::min(h, twin) % 3 == 0) features[h] = kFeatureCrease;
  }
  const PolylineSet lines = chainFeatures(model.mesh, model.shape.positions, features);
  for (PolylineSet::Line line : lines.lines) {
    const auto begin = static_cast<std::uint32_t>(all.points.size());
    for (std::uint32_t i = line.begin; i < line.end; ++i) {
      all.points.push_back(lines.points[i]);
      all.halfEdges.push_back(lines.halfEdges[i]);
      all.faces.push_back(lines.faces[i]);
    }
    line.end = begin + (line.end - line.begin);
    line.begin = begin;
    all.lines.push_back(line);
  }
  return all;
}

struct Count {
  std::size_t asked = 0;
  std::size_t visible = 0;
  std::size_t wrong = 0;
};

Count compare(const Model& model, const Camera& camera) {
  const PolylineSet lines = linesOf(model, camera);
  const LineScene scene{
      model.mesh,
      model.shape.positions,
      model.shape.grid,
      camera,
      Viewport{640, 480}};
  const VisibilityResolver resolver(model.mesh, model.shape.positions);
  const ResolvedLines resolved = resolver.resolve(lines, scene);
  EXPECT_EQ(resolved.begin.size(), lines.points.size() + 1);
  Rng rng(11);
  Count count;
  for (const PolylineSet::Line& line : lines.lines) {
    for (std::uint32_t k = 0; k < line.segmentCount(); ++k) {
      const std::uint32_t point = line.begin + k;
      const std::uint32_t next = point + 1 < line.end ? point + 1 : line.begin;
      const auto pieces = resolved.piecesOf(point);
      EXPECT_FALSE(pieces.empty());
      EXPECT_EQ(pieces.back().end, 1.0F);
      for (int i = 0; i < 3; ++i) {
        const double t = i == 0 ? 0.5 : rng.uniform();
        std::size_t piece = 0;
        bool isNearCut = t < 1e-3 || t > 1.0 - 1e-3;
        for (std::size_t p = 0; p + 1 < pieces.size(); ++p) {
          if (pieces[p].end <= t) piece = p + 1;
          isNearCut = isNearCut || std::abs(pieces[p].end - t) < 1e-3;
        }
        if (isNearCut) continue;
        const glm::dvec3 p =
            glm::mix(glm::dvec3(lines.points[point]), glm::dvec3(lines.points[next]), t);
        const bool truth = isVisible(model, camera, lines.halfEdges[point], p);
        ++count.asked;
        count.visible += truth ? 1 : 0;
        count.wrong += truth != pieces[piece].visible ? 1 : 0;
      }
    }
  }
  return count;
}

void expectExact(const std::string& name, TriangleMesh shape) {
  const Model model(std::move(shape));
  const BoundingSphere sphere = boundingSphere(model.shape.grid, model.shape.positions);
  Count all;
  for (const auto& [azimuth, elevation] :
       {std::pair{31.0, 22.0}, {152.0, -11.0}, {263.0, 47.0}, {20.0, 4.0}}) {
    for (const bool orthographic : {false, true}) {
      Camera camera = orbitCamera(sphere, azimuth, elevation, 2.5);
      camera.orthographic = orthographic;
      const Count count = compare(model, camera);
      EXPECT_EQ(count.wrong, 0U) << name << " of " << count.asked << " from " << azimuth << ", "
                                 << elevation << (orthographic ? ", orthographic" : "");
      all.asked += count.asked;
      all.visible += count.visible;
    }
  }
  EXPECT_GT(all.visible, 0U) << name;
  EXPECT_LT(all.visible, all.asked) << name;
}

TEST(ResolvedVisibility, EqualsRaysThroughEveryFaceOnAKnot) {
  expectExact("knot", primitives::torusKnot(2, 3, 80, 12));
}

TEST(ResolvedVisibility, EqualsRaysThroughEveryFaceOnBumps) {
  expectExact("bumps", primitives::bumpySphere(3, 5));
}

TEST(ResolvedVisibility, EqualsRaysThroughEveryFaceOnSharpEdges) {
  expectExact("cube", primitives::cube());
}

TEST(ResolvedVisibility, EqualsRaysThroughEveryFaceOnAnOpenSurface) {
  expectExact("grid", primitives::openGrid(24, 24));
}

/// Parts of a machine as they are modelled: each closed, one stuck through the other.
TEST(ResolvedVisibility, EqualsRaysThroughEveryFaceOnPartsThatPassThroughOneAnother) {
  TriangleMesh parts = primitives::icosphere(1);
  const TriangleMesh cube = primitives::cube();
  glm::ivec3 low = parts.positions[0];
  glm::ivec3 high = low;
  for (const glm::ivec3& p : parts.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  glm::ivec3 cubeLow = cube.positions[0];
  glm::ivec3 cubeHigh = cubeLow;
  for (const glm::ivec3& p : cube.positions) {
    cubeLow = glm::min(cubeLow, p);
    cubeHigh = glm::max(cubeHigh, p);
  }
  const auto first = static_cast<std::uint32_t>(parts.positions.size());
  const glm::dvec3 size(high - low);
  for (const glm::ivec3& p : cube.positions) {
    const glm::dvec3 share = glm::dvec3(p - cubeLow) / glm::dvec3(cubeHigh - cubeLow);
    // A beam, a little askew.
    const glm::dvec3 q = glm::dvec3(low) + size * (glm::dvec3(-0.2, 0.31, 0.37) +
                                                   share * glm::dvec3(1.43, 0.29, 0.23) +
                                                   glm::dvec3(0.0, 0.11, 0.07) * share.x);
    parts.positions.emplace_back(glm::round(q));
  }
  for (const glm::uvec3& t : cube.triangles)
    parts.triangles.push_back(t + first);
  expectExact("parts", std::move(parts));
}

TEST(ResolvedVisibility, ABorderIsNotHiddenByThePartItIsFittedInto) {
  // A sheet, and another that stands so many grid units before its right border.
  const auto isBorderSeen = [](int before) {
    TriangleMesh shape;
    shape.grid.step = 1e-3;
    shape.positions = {
        {0, 0, 0},
        {1000, 0, 0},
        {1000, 1000, 0},
        {0, 1000, 0},
        {900, -100, before},
        {2000, -100, before},
        {2000, 1100, before},
        {900, 1100, before}};
    shape.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    const Model model(std::move(shape));
    Camera camera;
    camera.eye = {0.5, 0.5, 5.0};
    camera.target = {0.5, 0.5, 0.0};
    camera.nearPlane = 0.1;
    camera.farPlane = 20.0;
    const LineScene scene{
        model.mesh,
        model.shape.positions,
        model.shape.grid,
        camera,
        Viewport{512, 512}};
    const PolylineSet lines = chainFeatures(model.mesh, model.shape.positions, {});
    const ResolvedLines resolved =
        VisibilityResolver(model.mesh, model.shape.positions).resolve(lines, scene);
    for (const PolylineSet::Line& line : lines.lines) {
      for (std::uint32_t point = line.begin; point < line.begin + line.segmentCount(); ++point) {
        const std::uint32_t next = point + 1 < line.end ? point + 1 : line.begin;
        const glm::vec3 middle = 0.5F * (lines.points[point] + lines.points[next]);
        if (middle == glm::vec3(1000.0F, 500.0F, 0.0F))
          return resolved.piecesOf(point).back().visible;
      }
    }
    ADD_FAILURE() << "no border there";
    return false;
  };
  EXPECT_TRUE(isBorderSeen(3));
  EXPECT_FALSE(isBorderSeen(30));
}

TEST(ResolvedVisibility, SeesFromWithinTheMesh) {
  const Model model(primitives::torusKnot(2, 3, 80, 12));
  const BoundingSphere sphere = boundingSphere(model.shape.grid, model.shape.positions);
  Camera camera = orbitCamera(sphere, 10.0, 5.0, 0.4);
  fitDepthRange(sphere, camera);
  // Segments that reach behind the eye have no place in the picture where they could be cut.
  const PolylineSet lines = linesOf(model, camera);
  const LineScene scene{
      model.mesh,
      model.shape.positions,
      model.shape.grid,
      camera,
      Viewport{640, 480}};
  const VisibilityResolver resolver(model.mesh, model.shape.positions);
  const ResolvedLines resolved = resolver.resolve(lines, scene);
  const auto visible = segmentVisibility(lines, resolved, scene);
  EXPECT_GT(std::count(visible.begin(), visible.end(), 1), 0);
  for (std::uint32_t point = 0; point < lines.points.size(); ++point) {
    if (visible[point] == 0) continue;
    const glm::dvec3 middle = 0.5 * (model.at(lines.halfEdges[point]) +
                                     model.at(HalfEdgeMesh::next(lines.halfEdges[point])));
    EXPECT_TRUE(isVisible(model, camera, lines.halfEdges[point], middle));
  }
}

/// Smooth silhouettes against the surface that the mesh stands for: a mesh of the same torus, 64
/// times finer.
TEST(ResolvedVisibility, SmoothSilhouettesAgreeWithTheSurfaceMeant) {
  const Model coarse(primitives::torus(48, 24));
  const Model fine(primitives::torus(384, 192));
  const TriangleBvh truth(fine.shape.positions, fine.shape.triangles);
  const BoundingSphere sphere = boundingSphere(coarse.shape.grid, coarse.shape.positions);
  std::size_t asked = 0;
  std::size_t wrong = 0;
  for (const auto& [azimuth, elevation] : {std::pair{31.0, 12.0}, {152.0, -31.0}, {263.0, 57.0}}) {
    const Camera camera = orbitCamera(sphere, azimuth, elevation);
    const SilhouetteField field(coarse.mesh, coarse.shape.positions, SilhouetteKind::kSmooth);
    const auto detector = makeDetector(DetectorMethod::kBrute, field);
    const SilhouetteView view{coarse.shape.grid.fromModel(camera.eye), camera.forward(), false};
    SilhouetteChainer chainer;
    const PolylineSet& lines = chainer.chain(field, view, detector->detect(view));
    const LineScene scene{
        coarse.mesh,
        coarse.shape.positions,
        coarse.shape.grid,
        camera,
        Viewport{1024, 1024}};
    const VisibilityResolver resolver(coarse.mesh, coarse.shape.positions);
    const auto visible = segmentVisibility(lines, resolver.resolve(lines, scene), scene);
    for (const PolylineSet::Line& line : lines.lines) {
      for (std::uint32_t k = 0; k < line.segmentCount(); ++k) {
        const std::uint32_t point = line.begin + k;
        const std::uint32_t next = point + 1 < line.end ? point + 1 : line.begin;
        const glm::dvec3 middle =
            0.5 * (glm::dvec3(lines.points[point]) + glm::dvec3(lines.points[next]));
        // A pixel outside the torus' own outline: radially away from its tube.
        const glm::dvec3 model = coarse.shape.grid.origin + coarse.shape.grid.step * middle;
        const glm::dvec3 outward = [&] {
          const FaceId f = lines.faces[point];
          const glm::dvec3 a = coarse.at(3 * f);
          return glm::normalize(glm::cross(coarse.at(3 * f + 1) - a, coarse.at(3 * f + 2) - a));
        }();
        const double step = fine.shape.grid.step;
        const glm::dvec3 start =
            fine.shape.grid.fromModel(model) + outward * (0.01 * sphere.radius / step);
        const glm::dvec3 eye = fine.shape.grid.fromModel(camera.eye);
        const bool expected = !truth.isBlocked({start, eye - start, 0.0, 1.0});
        ++asked;
        wrong += expected != (visible[point] != 0) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(asked, 200U);
  EXPECT_LE(static_cast<double>(wrong), 0.02 * static_cast<double>(asked)) << "of " << asked;
  RecordProperty("wrong", static_cast<int>(wrong));
}

/// A light's silhouettes cross the surface where the eye looks straight at it.
TEST(ResolvedVisibility, SilhouettesOfALightAreSeenWhereTheSurfaceIs) {
  const Model ball(primitives::icosphere(4));
  const BoundingSphere sphere = boundingSphere(ball.shape.grid, ball.shape.positions);
  const Camera camera = orbitCamera(sphere, 0.0, 0.0);
  const glm::dvec3 eye = ball.shape.grid.fromModel(camera.eye);
  const glm::dvec3 center = ball.shape.grid.fromModel(sphere.center);
  const LineScene scene{
      ball.mesh,
      ball.shape.positions,
      ball.shape.grid,
      camera,
      Viewport{640, 480}};
  const VisibilityResolver resolver(ball.mesh, ball.shape.positions);
  for (const SilhouetteKind kind : {SilhouetteKind::kEdges, SilhouetteKind::kSmooth}) {
    const SilhouetteField field(ball.mesh, ball.shape.positions, kind);
    const auto detector = makeDetector(DetectorMethod::kBrute, field);
    for (const double side : {-1.0, 1.0}) {
      // From the side: the line goes round the ball from pole to pole.
      const SilhouetteView light{
          center + glm::dvec3(side * 1e6, 0.0, 0.0),
          {-side, 0.0, 0.0},
          false};
      SilhouetteChainer chainer;
      PolylineSet lines = chainer.chain(field, light, detector->detect(light));
      for (PolylineSet::Line& line : lines.lines)
        line.onSurface = true;
      const auto visible = segmentVisibility(lines, resolver.resolve(lines, scene), scene);
      std::size_t asked = 0;
      for (const PolylineSet::Line& line : lines.lines) {
        for (std::uint32_t point = line.begin; point < line.end; ++point) {
          const glm::dvec3 p(lines.points[point]);
          const double facing = glm::dot(glm::normalize(p - center), glm::normalize(eye - p));
          if (std::abs(facing) < 0.15) continue;  // near the outline either may be
          ++asked;
          EXPECT_EQ(visible[point] != 0, facing > 0.0)
              << (kind == SilhouetteKind::kEdges ? "edges" : "smooth") << ", facing " << facing;
        }
      }
      EXPECT_GT(asked, 50U);
    }
  }
}

}  // namespace
}  // namespace limn
