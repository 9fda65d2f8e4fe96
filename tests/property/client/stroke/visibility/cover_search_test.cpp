// SPDX-License-Identifier: Apache-2.0
// The search for what covers a place against rays through every face that it may try.
#include "client/stroke/visibility/cover_search.h"

#include "client/stroke/view_distance.h"
#include "client/stroke/visibility/line_crossings.h"
#include "client/stroke/visibility/own_surface.h"
#include "tests/property/segment_meets.h"

#include "shared/core/rng.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <vector>

namespace limn {
namespace {

struct Shape {
  TriangleMesh shape = primitives::bumpySphere(4, 3);
  HalfEdgeMesh mesh;
  Camera camera;

  Shape() {
    auto built =
        HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
    EXPECT_TRUE(built);
    if (built) mesh = *std::move(built);
    camera = orbitCamera(boundingSphere(shape.grid, shape.positions), 33.0, 21.0, 2.5);
  }

  [[nodiscard]] LineScene view() const {
    return {mesh, shape.positions, shape.grid, camera, {800, 800}};
  }

  [[nodiscard]] glm::dvec3 eye() const { return shape.grid.fromModel(camera.eye); }

  [[nodiscard]] glm::dvec3 corner(HalfEdgeId h) const {
    return glm::dvec3(shape.positions[mesh.origin(h)]);
  }

  [[nodiscard]] bool isMet(FaceId face, const glm::dvec3& from) const {
    const auto t =
        meets(corner(3 * face), corner(3 * face + 1), corner(3 * face + 2), from, eye() - from);
    return t && *t > 0.0 && *t < 1.0;
  }

  /// Grid units that a facet may stand out there.
  [[nodiscard]] double asideOf(const glm::dvec3& place) const {
    const double distance = glm::dot(shape.grid.toModel(place) - camera.eye, camera.forward());
    return OwnSurface::kReachPx / (shape.grid.step * pixelsPerUnit(camera, {800, 800}, distance));
  }

  [[nodiscard]] bool shareCorner(FaceId a, FaceId b) const {
    for (HalfEdgeId h = 3 * a; h < 3 * a + 3; ++h) {
      for (HalfEdgeId g = 3 * b; g < 3 * b + 3; ++g) {
        if (mesh.origin(h) == mesh.origin(g)) return true;
      }
    }
    return false;
  }

  /// How many corners away, at most OwnSurface::kRings + 1.
  [[nodiscard]] int cornersBetween(FaceId a, FaceId b) const {
    if (a == b) return 0;
    std::set<std::uint32_t> vertices;
    for (HalfEdgeId h = 3 * a; h < 3 * a + 3; ++h)
      vertices.insert(mesh.origin(h));
    for (int rings = 1; rings <= OwnSurface::kRings; ++rings) {
      for (HalfEdgeId h = 3 * b; h < 3 * b + 3; ++h) {
        if (vertices.contains(mesh.origin(h))) return rings;
      }
      std::set<std::uint32_t> more = vertices;
      for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
        if (vertices.contains(mesh.origin(h))) more.insert(mesh.target(h));
      }
      vertices = std::move(more);
    }
    return OwnSurface::kRings + 1;
  }

  [[nodiscard]] std::set<FaceId> around(FaceId face, int rings) const {
    std::set<FaceId> all = {face};
    for (int ring = 0; ring < rings; ++ring) {
      const std::vector<FaceId> before(all.begin(), all.end());
      for (const FaceId f : before) {
        for (HalfEdgeId h = 3 * f; h < 3 * f + 3; ++h)
          all.insert(HalfEdgeMesh::face(mesh.twin(h)));
      }
    }
    return all;
  }
};

TEST(CoverSearch, FindsWhatARayThroughTheFacesAroundMeets) {
  const Shape shape;
  CoverSearch search(shape.view());
  Rng rng(5);
  int covered = 0;
  int free = 0;
  for (FaceId start = 0; start < shape.mesh.faceCount(); start += 3) {
    const std::set<FaceId> tried = shape.around(start, CoverSearch::kRings);
    const auto own = static_cast<FaceId>(rng.below(shape.mesh.faceCount()));
    const FaceId neighbour =
        *std::next(tried.begin(), rng.below(static_cast<std::uint32_t>(tried.size())));
    // Behind or before a place near the face.
    glm::dvec3 place = shape.corner(3 * neighbour);
    place += 20.0 * glm::dvec3(rng.uniform(), rng.uniform(), rng.uniform());
    place += (rng.uniform() * 200.0 - 150.0) * glm::normalize(shape.eye() - place);
    for (const bool isAround : {false, true}) {
      for (const FaceId face : {own, neighbour}) {
        CoverSearch::Place at{
            place,
            face,
            kNone,
            isAround ? CoverSearch::Own::kAround : CoverSearch::Own::kFace};
        at.out = glm::normalize(glm::cross(shape.eye() - place, glm::dvec3(0.3, 1.0, 0.2)));
        const glm::dvec3 aside = place + shape.asideOf(place) * at.out;
        const bool expected = std::any_of(tried.begin(), tried.end(), [&](FaceId f) {
          const bool isOwn = isAround ? shape.shareCorner(f, face) : f == face;
          if (isOwn || !shape.isMet(f, place)) return false;
          if (!isAround || shape.cornersBetween(face, f) > OwnSurface::kRings) return true;
          return std::any_of(tried.begin(), tried.end(), [&](FaceId g) {
            return !shape.shareCorner(g, face) && shape.isMet(g, aside);
          });
        });
        EXPECT_EQ(search.covers(std::vector{start}, at), expected) << start << " " << face;
        (expected ? covered : free) += 1;
      }
    }
  }
  EXPECT_GT(covered, 500);
  EXPECT_GT(free, 500);
}

TEST(OwnSurface, HasTheFacesUpToThreeCornersAway) {
  const Shape shape;
  OwnSurface own(shape.mesh);
  for (FaceId face = 0; face < shape.mesh.faceCount(); face += 1201) {
    const std::span<const FaceId> around = own.around(face);
    const std::set<FaceId> found(around.begin(), around.end());
    EXPECT_EQ(found.size(), around.size());
    for (FaceId other = 0; other < shape.mesh.faceCount(); other += 61) {
      const bool expected = shape.cornersBetween(face, other) <= OwnSurface::kRings;
      EXPECT_EQ(own.has(face, other), expected);
      EXPECT_EQ(found.contains(other), expected);
    }
    for (const FaceId other : found)
      EXPECT_TRUE(own.has(face, other));
  }
}

TEST(OwnSurface, EndsAtBorders) {
  // A fan of four faces round a vertex, open.
  const std::vector<glm::uvec3> triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  const auto mesh = HalfEdgeMesh::build(6, triangles);
  ASSERT_TRUE(mesh);
  OwnSurface own(*mesh);
  for (FaceId a = 0; a < 4; ++a) {
    EXPECT_EQ(own.around(a).size(), 4U);
    for (FaceId b = 0; b < 4; ++b)
      EXPECT_TRUE(own.has(a, b));
  }
}

TEST(CoverSearch, EdgesAreCoveredByTheFacesAroundTheirEndsAsFarAsItSays) {
  const Shape shape;
  const CoverSearch search(shape.view());
  int partly = 0;
  for (HalfEdgeId h = 0; h < shape.mesh.origins.size(); ++h) {
    const FaceId own = HalfEdgeMesh::face(h);
    const FaceId other = HalfEdgeMesh::face(shape.mesh.twin(h));
    const glm::dvec3 from = shape.corner(h);
    const glm::dvec3 to = shape.corner(HalfEdgeMesh::next(h));
    const double share = search.coveredShare(h, to, own, other);
    partly += share > 0.0 && share < 1.0 ? 1 : 0;
    for (double s = 0.025; s < 1.0; s += 0.05) {
      if (std::abs(s - share) < 1e-6) continue;
      bool isMet = false;
      for (HalfEdgeId at = shape.mesh.rotateCcw(h); at != h; at = shape.mesh.rotateCcw(at)) {
        const FaceId face = HalfEdgeMesh::face(at);
        isMet = isMet || (face != own && face != other && shape.isMet(face, glm::mix(from, to, s)));
      }
      EXPECT_EQ(s < share, isMet) << h << " at " << s;
    }
  }
  EXPECT_GT(partly, 20);
}

TEST(LineCrossings, WhatIsBesideALineIsFoundOnceItComesNearAndIsBefore) {
  LineCrossings crossings(Viewport{400, 400});
  const auto add = [&](double x, double depth) {
    crossings
        .addEdgeInPicture({x, 100.0, depth}, {x, 120.0, depth}, LineCrossings::Surface::kLeft, 0);
  };
  add(100.0, 0.5);  // the line's own
  add(100.8, 0.4);
  add(100.8, 0.6);  // farther away
  add(140.0, 0.4);  // not near
  crossings.build();
  std::vector<LineCrossings::Crossing> found;
  std::vector<std::uint32_t> beside;
  const glm::dvec3 from(100.0, 100.0, 0.5);
  const glm::dvec3 to(100.0, 120.0, 0.5);
  crossings.crossAlong(0, found, {1.0F, 0, 1, beside});
  EXPECT_TRUE(found.empty());
  EXPECT_EQ(std::set<std::uint32_t>(beside.begin(), beside.end()), std::set<std::uint32_t>{1});
  const glm::dvec3 middle = 0.5 * (from + to);
  EXPECT_TRUE(crossings.isBefore(1, middle, 1.0));
  EXPECT_FALSE(crossings.isBefore(1, middle, 0.5));
  EXPECT_FALSE(crossings.isBefore(2, middle, 1.0));
}

}  // namespace
}  // namespace limn
