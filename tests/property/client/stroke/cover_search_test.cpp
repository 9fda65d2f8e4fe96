// SPDX-License-Identifier: Apache-2.0
// The search for what covers a place against rays through every face that it may try.
#include "client/stroke/cover_search.h"

#include "client/stroke/line_crossings.h"
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

  [[nodiscard]] bool shareCorner(FaceId a, FaceId b) const {
    for (HalfEdgeId h = 3 * a; h < 3 * a + 3; ++h) {
      for (HalfEdgeId g = 3 * b; g < 3 * b + 3; ++g) {
        if (mesh.origin(h) == mesh.origin(g)) return true;
      }
    }
    return false;
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
        const CoverSearch::Place at{
            place,
            face,
            kNone,
            isAround ? CoverSearch::Own::kAround : CoverSearch::Own::kFace};
        const bool expected = std::any_of(tried.begin(), tried.end(), [&](FaceId f) {
          const bool isOwn = isAround ? shape.shareCorner(f, face) : f == face;
          return !isOwn && shape.isMet(f, place);
        });
        EXPECT_EQ(search.covers(std::vector{start}, at), expected) << start << " " << face;
        (expected ? covered : free) += 1;
      }
    }
  }
  EXPECT_GT(covered, 500);
  EXPECT_GT(free, 500);
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
  crossings.crossInPicture(from, to, found, {1.0F, 0, 1, beside});
  EXPECT_TRUE(found.empty());
  EXPECT_EQ(std::set<std::uint32_t>(beside.begin(), beside.end()), std::set<std::uint32_t>{1});
  const glm::dvec3 middle = 0.5 * (from + to);
  EXPECT_TRUE(crossings.isBefore(1, middle, 1.0));
  EXPECT_FALSE(crossings.isBefore(1, middle, 0.5));
  EXPECT_FALSE(crossings.isBefore(2, middle, 1.0));
}

}  // namespace
}  // namespace limn
