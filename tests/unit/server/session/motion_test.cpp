// SPDX-License-Identifier: Apache-2.0
#include "server/session/motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limn {
namespace {

/// On a circle around `center`, looking at it.
protocol::Pose orbiting(const glm::dvec3& center, double angle) {
  protocol::Pose pose;
  const glm::dvec3 out(std::sin(angle), 0.4, std::cos(angle));
  pose.eye = center + 3.0 * out;
  pose.forward = -2.0 * out;  // any length
  pose.up = {0.0, 1.0, 0.0};
  return pose;
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b) {
  EXPECT_LT(glm::distance(a, b), 1e-6) << a.x << " " << a.y << " " << a.z;
}

TEST(Motion, FollowsACircleAroundAnyPoint) {
  const glm::dvec3 center(5.0, -2.0, 1.0);
  Motion motion;
  for (int i = 0; i < 8; ++i)
    motion.add(orbiting(center, 0.03 * i), 100 * i);
  for (const std::int64_t ahead : {0, 50, 400, 1500}) {
    const auto pose = motion.at(ahead);
    ASSERT_TRUE(pose);
    const auto there = orbiting(center, 0.21 + 0.0003 * static_cast<double>(ahead));
    expectNear(pose->eye, there.eye);
    expectNear(pose->forward, glm::normalize(there.forward));
    EXPECT_LT(std::abs(glm::dot(glm::cross(pose->up, there.up), there.forward)), 1e-6);
  }
}

TEST(Motion, FollowsAStraightFlight) {
  Motion motion;
  for (int i = 0; i < 4; ++i) {
    protocol::Pose pose;
    pose.eye = {0.5 * i, 1.0, -0.25 * i};
    motion.add(pose, 40 * i);
  }
  const auto pose = motion.at(400);
  ASSERT_TRUE(pose);
  expectNear(pose->eye, {6.5, 1.0, -3.25});
  expectNear(pose->forward, {0.0, 0.0, -1.0});
}

TEST(Motion, KnowsNothingOfACameraThatStandsOrHasJustCome) {
  Motion motion;
  EXPECT_FALSE(motion.at(100));
  motion.add({}, 0);
  EXPECT_FALSE(motion.at(100));
  motion.add({}, 0);
  EXPECT_FALSE(motion.at(100)) << "two poses of one moment have no speed";
  motion.add({}, 100);
  EXPECT_FALSE(motion.at(100)) << "it stands still";
  protocol::Pose far;
  far.eye = {9.0, 9.0, 9.0};
  motion.add(far, 5000);
  EXPECT_FALSE(motion.at(100)) << "a jump after a pause is no motion";
}

}  // namespace
}  // namespace limn
