// SPDX-License-Identifier: Apache-2.0
#include "server/session/contour_search.h"

#include "server/session/have_set.h"
#include "server/session/scheduler.h"
#include "tests/unit/server/session/test_model.h"

#include "shared/mesh/primitives.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace limn {
namespace {

const std::shared_ptr<const Model>& bumpy() {
  static const auto model = modelOf(primitives::bumpySphere(5, 3), 1, 200);
  return model;
}

const std::shared_ptr<const Model>& open() {
  static const auto model = modelOf(primitives::openGrid(40, 30), 2, 200);
  return model;
}

HaveSet baseOf(const SplitForest& forest) {
  HaveSet have(forest.vertexCount());
  have.addRange(0, forest.baseVertexCount());
  return have;
}

HaveSet with(HaveSet have, const TargetSet& target) {
  ScheduleCursor cursor;
  for (const VertexId v : nextSplits(target, have, have.vertexCount(), cursor))
    have.add(v);
  return have;
}

/// Slow oracle: the 95th percentile by length of the distance from one contour to the other, worse
/// way, every point compared with every other.
double p95Between(const Model& model, const HaveSet& have, const ContourView& view) {
  const ActiveMesh client = meshOf(model.forest(), have.words());
  const SilhouetteField field(client.mesh(), client.positions(), view.kind);
  VisibleContourFinder finder;
  const auto full = finder.find(model.fullMesh()->field(view.kind), view.picture, 1.0);
  const auto mine = finder.find(field, view.picture, 1.0);
  EXPECT_GT(full.size(), 100U);
  const auto oneWay = [](const auto& from, const auto& to) {
    std::vector<std::pair<double, double>> off;  // distance, length
    double sum = 0.0;
    for (const ContourPoint& p : from) {
      double best = std::numeric_limits<double>::infinity();
      for (const ContourPoint& q : to)
        best = std::min<double>(best, glm::distance(p.px, q.px));
      off.emplace_back(best, p.lengthPx);
      sum += p.lengthPx;
    }
    std::ranges::sort(off);
    double passed = 0.0;
    for (const auto& [distance, length] : off) {
      passed += length;
      if (passed >= 0.95 * sum) return distance;
    }
    return 0.0;
  };
  return std::max(oneWay(full, mine), oneWay(mine, full));
}

protocol::Pose poseOf(const Model& model, const glm::dvec3& direction, protocol::Silhouette kind) {
  protocol::Pose pose = poseAt(model.info(), direction);
  pose.silhouette = kind;
  return pose;
}

TEST(ContourSearch, BringsContoursWithinTheBoundBothWays) {
  for (const auto kind : {protocol::Silhouette::kEdges, protocol::Silhouette::kSmooth}) {
    for (const auto& model : {bumpy(), open()}) {
      const SplitForest& forest = model->forest();
      const ContourView view = contourViewOf(poseOf(*model, {1, 2, 0.7}, kind), forest.grid);
      const HaveSet start = baseOf(forest);
      EXPECT_GT(p95Between(*model, start, view), 1.0) << "nothing to do";
      ContourSearch search(*model->fullMesh(), view, start.words());
      ASSERT_TRUE(search.run());
      const HaveSet found = with(start, search.target());
      EXPECT_TRUE(isClosed(forest, found.words()));
      EXPECT_LE(p95Between(*model, found, view), 1.1);
      EXPECT_LT(found.count(), forest.vertexCount());
    }
  }
}

TEST(ContourSearch, NeedsLessThanBoundsOfSplitsDo) {
  const Model& model = *bumpy();
  const SplitForest& forest = model.forest();
  const protocol::Pose pose = poseOf(model, {1, 2, 0.7}, protocol::Silhouette::kEdges);
  const HaveSet start = baseOf(forest);
  ContourSearch search(*model.fullMesh(), contourViewOf(pose, forest.grid), start.words());
  ASSERT_TRUE(search.run());
  const auto bounded = with(start, selectForView(forest, viewOfPose(pose, forest.grid)));
  EXPECT_LT(with(start, search.target()).count(), bounded.count());
}

TEST(ContourSearch, WhatIsHeldNeedsNothing) {
  const Model& model = *bumpy();
  HaveSet everything(model.forest().vertexCount());
  everything.addRange(0, model.forest().vertexCount());
  const protocol::Pose pose = poseOf(model, {0, 0, 1}, protocol::Silhouette::kSmooth);
  ContourSearch search(
      *model.fullMesh(),
      contourViewOf(pose, model.forest().grid),
      everything.words());
  EXPECT_EQ(search.off().worst(), 0.0);
  ASSERT_TRUE(search.run());
  EXPECT_EQ(
      with(baseOf(model.forest()), search.target()).count(),
      model.forest().baseVertexCount());
}

TEST(ContourSearch, AModelOutOfThePictureNeedsNothing) {
  const Model& model = *bumpy();
  protocol::Pose pose = poseOf(model, {0, 0, 1}, protocol::Silhouette::kEdges);
  pose.forward = -pose.forward;
  const HaveSet start = baseOf(model.forest());
  ContourSearch search(*model.fullMesh(), contourViewOf(pose, model.forest().grid), start.words());
  ASSERT_TRUE(search.run());
  EXPECT_EQ(with(start, search.target()).count(), start.count());
}

TEST(ContourSearch, WorkIsBoundedWhateverThePicture) {
  protocol::Pose pose = poseOf(*bumpy(), {0, 0, 1}, protocol::Silhouette::kEdges);
  pose.width = 65535;
  pose.height = 10000;
  const ContourView view = contourViewOf(pose, bumpy()->forest().grid);
  EXPECT_LE(view.picture.width, 1024);
  EXPECT_EQ(view.picture.height, 156);
  EXPECT_NEAR(view.errorPx, 1024.0 / 65535.0, 1e-9);
}

}  // namespace
}  // namespace limn
