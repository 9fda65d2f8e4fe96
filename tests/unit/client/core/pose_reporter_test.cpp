// SPDX-License-Identifier: Apache-2.0
#include "client/core/pose_reporter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limn {
namespace {

ClientView viewFrom(double x) {
  ClientView view;
  view.camera.eye = {x, 0.0, 3.0};
  return view;
}

TEST(PoseReporter, SendsTheNewestAndNoneTwice) {
  PoseReporter poses(4);
  EXPECT_FALSE(poses.next(0));
  poses.set(viewFrom(1.0));
  poses.set(viewFrom(2.0));
  const auto pose = poses.next(0);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->eye.x, 2.0);
  EXPECT_EQ(pose->channel, 4);
  EXPECT_EQ(pose->id, poses.newestId());
  EXPECT_FALSE(poses.next(1000));
  poses.set(viewFrom(2.0));
  EXPECT_FALSE(poses.next(2000));
}

TEST(PoseReporter, KeepsItsRate) {
  PoseReporter poses(0);
  int sent = 0;
  for (std::uint64_t now = 0; now < 1000; ++now) {
    poses.set(viewFrom(static_cast<double>(now)));
    sent += poses.next(now) ? 1 : 0;
  }
  EXPECT_LE(sent, 60);
  EXPECT_GE(sent, 40);
  // The last one is not lost, only late.
  ASSERT_TRUE(poses.dueAtMs());
  EXPECT_EQ(poses.next(*poses.dueAtMs())->eye.x, 999.0);
}

TEST(PoseReporter, RepeatsForANewConnectionUnderANewId) {
  PoseReporter poses(0);
  poses.repeat();
  EXPECT_FALSE(poses.next(0));
  poses.set(viewFrom(1.0));
  const std::uint32_t first = poses.next(0)->id;
  poses.repeat();
  EXPECT_GT(poses.next(1)->id, first);
}

TEST(PoseReporter, OrthographicHeightIsThePerspectiveExtentAtTheTarget) {
  ClientView view = viewFrom(0.0);
  view.camera.orthographic = true;
  view.camera.fovDegrees = 90.0;
  const protocol::Pose pose = toPose(view, 0, 1);
  EXPECT_NEAR(pose.orthoHeight, 6.0, 1e-12);
  EXPECT_NEAR(pose.fovY, std::acos(-1.0) / 2.0, 1e-6);
  EXPECT_EQ(pose.forward, glm::dvec3(0.0, 0.0, -1.0));
  const auto bytes = encodeMessage(pose);
  EXPECT_TRUE(protocol::decodeMessage(bytes, protocol::Sender::kClient));
}

}  // namespace
}  // namespace limn
