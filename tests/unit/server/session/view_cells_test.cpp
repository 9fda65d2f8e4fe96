// SPDX-License-Identifier: Apache-2.0
#include "server/session/view_cells.h"

#include "tests/unit/server/session/test_model.h"

#include "shared/core/rng.h"
#include "shared/mesh/primitives.h"

#include <set>

namespace limn {
namespace {

const std::shared_ptr<const Model>& sphere() {
  static const auto model = modelOf(primitives::icosphere(3));
  return model;
}

HaveSet baseOf(const Model& model) {
  HaveSet have(model.forest().vertexCount());
  have.addRange(0, model.forest().baseVertexCount());
  return have;
}

ViewCell cellAt(const glm::dvec3& direction) {
  return viewCellOf(poseAt(sphere()->info(), direction), sphere()->info());
}

TEST(ViewCellOf, NearPosesShareACell) {
  const auto& info = sphere()->info();
  const ViewCell a = viewCellOf(poseAt(info, {0.1, 0.1, 1.0}, 3.0), info);
  const ViewCell b = viewCellOf(poseAt(info, {0.11, 0.1, 1.0}, 3.05), info);
  EXPECT_EQ(a, b);
}

TEST(ViewCellOf, WhatDiffersInNeedDiffersInCell) {
  const auto& info = sphere()->info();
  const protocol::Pose pose = poseAt(info, {0.1, 0.1, 1.0}, 3.0);
  std::set<std::uint64_t> keys{viewCellOf(pose, info)};
  const auto expectNew = [&](const protocol::Pose& other) {
    EXPECT_TRUE(keys.insert(viewCellOf(other, info)).second);
  };
  expectNew(poseAt(info, {0.5, 0.1, 1.0}, 3.0));
  expectNew(poseAt(info, {0.1, 0.1, -1.0}, 3.0));
  expectNew(poseAt(info, {0.1, 0.1, 1.0}, 6.0));
  protocol::Pose other = pose;
  other.errorPx = 4.0F;
  expectNew(other);
  other = pose;
  other.silhouette = protocol::Silhouette::kEdges;
  expectNew(other);
  other = pose;
  other.orthoHeight = 2.0;
  expectNew(other);
  other = pose;
  other.forward = glm::normalize(glm::dvec3(1.0, 0.0, -0.5));  // the model half out of view
  expectNew(other);
}

TEST(ViewCellOf, ThePoseIsNearTheMiddleOfItsCell) {
  const auto& info = sphere()->info();
  Rng rng(3);
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 direction(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5);
    const double distance = 1.5 + 5.0 * rng.uniform();
    const protocol::Pose pose = poseAt(info, direction, distance);
    const View middle = viewOfCell(viewCellOf(pose, info), info);
    const glm::dvec3 eye = sphere()->forest().grid.fromModel(pose.eye);
    const glm::dvec3 center = sphere()->forest().grid.fromModel(info.center);
    const double cosine =
        glm::dot(glm::normalize(eye - center), glm::normalize(middle.eye - center));
    EXPECT_GT(cosine, std::cos(glm::radians(5.0)));
    const double ratio = glm::distance(middle.eye, center) / glm::distance(eye, center);
    EXPECT_GT(ratio, 0.91);
    EXPECT_LT(ratio, 1.1);
  }
}

TEST(RestCellOf, ItsSetHasWhatAnyPoseInItNeeds) {
  const Model& model = *sphere();
  const auto& info = model.info();
  Rng rng(5);
  std::size_t shared = 0;
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 direction(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5);
    protocol::Pose pose = poseAt(info, direction, 3.2 + 3.0 * rng.uniform());
    pose.silhouette = i % 2 == 0 ? protocol::Silhouette::kSmooth : protocol::Silhouette::kEdges;
    const auto cell = restCellOf(pose, info);
    ASSERT_TRUE(cell);
    const auto cones = smoothConesOf(model.forest());
    const auto wide = classifySplits(model.forest(), viewOfCell(*cell, info), cones);
    const auto needed =
        classifySplits(model.forest(), viewOfPose(pose, model.forest().grid), cones);
    for (std::size_t s = 0; s < needed.size(); ++s)
      ASSERT_LE(wide[s], needed[s]) << "split " << s << " of pose " << i;
    // One that stands beside it.
    protocol::Pose beside = pose;
    beside.eye += 0.003 * info.radius * glm::dvec3(1.0, 0.0, 0.0);
    const auto other = restCellOf(beside, info);
    if (other && *other == *cell) ++shared;
  }
  EXPECT_GT(shared, 100U);
}

TEST(RestCellOf, IsOnlyForModelsThatAreSeenWhole) {
  const auto& info = sphere()->info();
  EXPECT_TRUE(restCellOf(poseAt(info, {0, 0, 1}, 4.0), info));
  EXPECT_FALSE(restCellOf(poseAt(info, {0, 0, 1}, 1.1), info)) << "too near";
  protocol::Pose pose = poseAt(info, {0, 0, 1}, 4.0);
  pose.forward = glm::normalize(glm::dvec3(0.5, 0.0, -1.0));
  EXPECT_FALSE(restCellOf(pose, info)) << "half out of view";
  pose = poseAt(info, {0, 0, 1}, 4.0);
  pose.orthoHeight = 2.0;
  EXPECT_FALSE(restCellOf(pose, info)) << "orthographic";
}

TEST(ViewCells, BeyondSoManySearchesCellsDecide) {
  ManualTasks tasks;
  ViewCells cells(tasks, {.maxPending = 1, .maxSearches = 1});
  const auto& info = sphere()->info();
  const HaveSet have = baseOf(*sphere());
  using enum ViewCells::Need;
  const auto searched = cells.pose(sphere(), poseAt(info, {0, 0, 1}, 4.0), kSettled, have);
  const auto second = cells.pose(sphere(), poseAt(info, {1, 0, 0}, 4.0), kSettled, have);
  const auto third = cells.pose(sphere(), poseAt(info, {1, 0.001, 0}, 4.0), kSettled, have);
  EXPECT_EQ(second, third) << "one for all who stand about there";
  EXPECT_EQ(cells.pose(sphere(), poseAt(info, {0, 1, 0}, 4.0), kSettled, have), nullptr) << "later";
  EXPECT_TRUE(cells.mayAsk(*sphere(), poseAt(info, {0, 0, 1}, 4.0))) << "shares the search";
  EXPECT_TRUE(cells.mayAsk(*sphere(), poseAt(info, {1, 0, 0}, 4.0))) << "shares the cell";
  EXPECT_FALSE(cells.mayAsk(*sphere(), poseAt(info, {0, 1, 0}, 4.0))) << "later";
  EXPECT_EQ(tasks.runAll(), 2U);
  EXPECT_NE(searched->set, nullptr);
  EXPECT_NE(second->set, nullptr);
}

TEST(ViewCellOf, ItsViewLooksAsItsPosesDo) {
  const auto& info = sphere()->info();
  const auto viewOf = [&](const protocol::Pose& pose) {
    return viewOfCell(viewCellOf(pose, info), info);
  };
  protocol::Pose pose = poseAt(info, {0.1, 0.1, 1.0}, 3.0);
  pose.silhouette = protocol::Silhouette::kEdges;
  const View whole = viewOf(pose);
  EXPECT_EQ(whole.silhouette, pose.silhouette);
  EXPECT_FALSE(whole.orthographic);
  EXPECT_NE(whole.clip, View::Clip::kCone);
  const View exact = viewOfPose(pose, sphere()->forest().grid);
  const double finer = whole.pixelsPerUnit / whole.errorPx * exact.errorPx / exact.pixelsPerUnit;
  EXPECT_GE(finer, 1.0) << "the bound is rounded to the finer";
  EXPECT_LE(finer, std::sqrt(2.0) + 1e-6);
  pose.forward = glm::normalize(glm::dvec3(1.0, 0.0, -0.5));
  const View aside = viewOf(pose);
  EXPECT_EQ(aside.clip, View::Clip::kCone);
  EXPECT_GT(glm::dot(aside.forward, pose.forward), std::cos(glm::radians(5.0)));
  EXPECT_GT(aside.coneHalfAngle, pose.fovY / 2.0);
  pose.orthoHeight = 2.0;
  EXPECT_TRUE(viewOf(pose).orthographic);
}

TEST(ViewCellOf, AWayIsCutIntoPiecesOfAboutTwoCells) {
  const auto& info = sphere()->info();
  int cells = 0;
  int pieces = 0;
  ViewCell last = kNoCell;
  for (double degrees = 0.0; degrees < 360.0; degrees += 1.0) {
    const double angle = glm::radians(degrees);
    const ViewCell cell = viewCellOf(poseAt(info, {std::sin(angle), 0.36, std::cos(angle)}), info);
    if (cell == last) continue;
    last = cell;
    ++cells;
    pieces += endsPiece(cell) ? 1 : 0;
  }
  EXPECT_GT(cells, 50);
  EXPECT_GT(3 * pieces, cells);
  EXPECT_LT(3 * pieces, 2 * cells);
  // Straight on, too.
  EXPECT_NE(
      endsPiece(viewCellOf(poseAt(info, {0.1, 0.1, 1.0}, 3.0), info)),
      endsPiece(viewCellOf(poseAt(info, {0.1, 0.1, 1.0}, 3.0 * std::exp2(0.25)), info)));
}

TEST(ViewCells, ComputesACellOnceAndSharesIt) {
  ManualTasks tasks;
  ViewCells cells(tasks, {});
  const protocol::Pose pose = poseAt(sphere()->info(), {0, 0, 1});
  const auto first = cells.cell(sphere(), viewCellOf(pose, sphere()->info()));
  const auto second = cells.cell(sphere(), viewCellOf(pose, sphere()->info()));
  EXPECT_EQ(first, second);
  EXPECT_EQ(first->set, nullptr) << "still on its way";
  EXPECT_EQ(tasks.runAll(), 1U);
  ASSERT_NE(first->set, nullptr);
  EXPECT_EQ(cells.cell(sphere(), viewCellOf(pose, sphere()->info()))->set, first->set);
  EXPECT_EQ(cells.cachedBytes(), first->set->bytes());
}

TEST(ViewCells, ForgetsTheLeastUsedBeyondItsBound) {
  ManualTasks tasks;
  ViewCells measure(tasks, {});
  const auto one = measure.cell(sphere(), cellAt({0, 0, 1}));
  tasks.runAll();
  const std::size_t bytes = one->set->bytes();
  ViewCells cells(tasks, {.cacheBytes = 2 * bytes});
  const std::vector<glm::dvec3> directions = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
  for (const glm::dvec3& direction : directions) {
    static_cast<void>(cells.cell(sphere(), cellAt(direction)));
    tasks.runAll();
    // The first stays in use.
    static_cast<void>(cells.cell(sphere(), cellAt(directions[0])));
  }
  EXPECT_EQ(cells.cachedBytes(), 2 * bytes);
  EXPECT_EQ(tasks.pending(), 0U);
  static_cast<void>(cells.cell(sphere(), cellAt(directions[0])));
  EXPECT_EQ(tasks.pending(), 0U) << "kept";
  static_cast<void>(cells.cell(sphere(), cellAt(directions[1])));
  EXPECT_EQ(tasks.pending(), 1U) << "forgotten";
}

TEST(ViewCells, StartsOnlySoManyAtOnce) {
  ManualTasks tasks;
  ViewCells cells(tasks, {.maxPending = 1});
  EXPECT_NE(cells.cell(sphere(), cellAt({0, 0, 1})), nullptr);
  EXPECT_EQ(cells.cell(sphere(), cellAt({1, 0, 0})), nullptr);
  tasks.runAll();
  EXPECT_NE(cells.cell(sphere(), cellAt({1, 0, 0})), nullptr);
}

TEST(ViewCells, PosesMayJumpSoOften) {
  ManualTasks tasks;
  ViewCells cells(tasks, {.jumpsPerSecond = 1.0, .jumpsAtOnce = 2.0});
  const HaveSet have = baseOf(*sphere());
  const auto at = [](double x) { return poseAt(sphere()->info(), {x, 0, 1}); };
  using enum ViewCells::Need;
  EXPECT_TRUE(cells.mayJump(*sphere(), at(0.1), 0));
  EXPECT_TRUE(cells.mayJump(*sphere(), at(0.2), 0));
  EXPECT_FALSE(cells.mayJump(*sphere(), at(0.3), 0));
  const auto stayed = cells.pose(sphere(), at(0.2), kSettled, have);
  EXPECT_TRUE(cells.mayJump(*sphere(), at(0.2), 10)) << "with whom it shares";
  EXPECT_FALSE(cells.mayJump(*sphere(), at(0.5), 10));
  cells.giveJumpBack();
  EXPECT_TRUE(cells.mayJump(*sphere(), at(0.5), 10)) << "another one stayed";
  EXPECT_FALSE(cells.mayJump(*sphere(), at(0.5), 20));
  EXPECT_TRUE(cells.mayJump(*sphere(), at(0.5), 1010));
}

TEST(ViewCells, ADroppedTicketIsNotComputed) {
  ManualTasks tasks;
  ViewCells cells(tasks, {});
  const protocol::Pose pose = poseAt(sphere()->info(), {0, 0, 1});
  auto ticket = cells.pose(sphere(), pose, ViewCells::Need::kExact, baseOf(*sphere()));
  ticket = nullptr;
  tasks.runAll();
  EXPECT_EQ(cells.computed(), 0U);
  ticket = cells.pose(sphere(), pose, ViewCells::Need::kExact, baseOf(*sphere()));
  tasks.runAll();
  EXPECT_EQ(cells.computed(), 1U);
  EXPECT_NE(ticket->set, nullptr);
}

TEST(ViewCells, ClientsWhoHoldTheSameAndStandTogetherShareOneSet) {
  ManualTasks tasks;
  ViewCells cells(tasks, {.keptPoses = 2});
  const protocol::Pose pose = poseAt(sphere()->info(), {0, 0, 1});
  const HaveSet have = baseOf(*sphere());
  using enum ViewCells::Need;
  const auto first = cells.pose(sphere(), pose, kSettled, have);
  protocol::Pose again = pose;
  again.id = pose.id + 7;
  const auto second = cells.pose(sphere(), again, kSettled, have);
  EXPECT_EQ(tasks.runAll(), 1U);
  ASSERT_NE(first->set, nullptr);
  EXPECT_EQ(second->set, first->set);
  const auto late = cells.pose(sphere(), pose, kSettled, have);
  EXPECT_EQ(late->set, first->set) << "at once";
  EXPECT_EQ(tasks.pending(), 0U);

  const auto expectOwn = [&](const protocol::Pose& p, ViewCells::Need need, const HaveSet& h) {
    const auto ticket = cells.pose(sphere(), p, need, h);
    EXPECT_EQ(tasks.runAll(), 1U);
    EXPECT_NE(ticket->set, nullptr);
    EXPECT_NE(ticket->set, first->set);
  };
  expectOwn(pose, kExact, have);
  HaveSet more = have;
  more.add(sphere()->forest().baseVertexCount());
  expectOwn(pose, kSettled, more);
  expectOwn(pose, kSettled, have);  // forgotten by now
}

TEST(ViewCells, ASharedSetIsComputedWhileAnybodyWantsIt) {
  ManualTasks tasks;
  ViewCells cells(tasks, {});
  const protocol::Pose pose = poseAt(sphere()->info(), {0, 0, 1});
  auto first = cells.pose(sphere(), pose, ViewCells::Need::kExact, baseOf(*sphere()));
  const auto second = cells.pose(sphere(), pose, ViewCells::Need::kExact, baseOf(*sphere()));
  first = nullptr;
  tasks.runAll();
  EXPECT_NE(second->set, nullptr);
}

}  // namespace
}  // namespace limn
