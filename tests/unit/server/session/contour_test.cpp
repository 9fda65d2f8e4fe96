// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/server/session/session_link.h"

#include "protocol/messages.h"

#include "shared/codec/contour_codec.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

using protocol::GetContour;
using protocol::WireError;

/// A link whose contours are kept.
class ContourLink : public ::testing::Test {
 protected:
  ContourLink() {
    link_.hello();
    link_.open("torus");
    link_.settle();
  }

  static GetContour request(std::uint32_t id, const glm::dvec3& direction) {
    const auto& info = torus()->info();
    const glm::dvec3 unit = glm::normalize(direction);
    return {
        0,
        id,
        info.center + 3.0 * info.radius * unit,
        -unit,
        false,
        protocol::Silhouette::kEdges};
  }

  Link link_;
};

TEST_F(ContourLink, AnswersWithTheFullMeshsSilhouetteThoughTheClientHoldsOnlyTheStart) {
  const GetContour asked = request(1, {1.0, 0.4, 0.2});
  link_.send(asked);
  link_.settle();
  ASSERT_EQ(link_.contours_.size(), 1U);
  EXPECT_EQ(link_.contours_[0].first, 1U);
  const auto lines = decodeContour(link_.contours_[0].second, limits::kMaxContourPoints);
  ASSERT_TRUE(lines) << lines.error().message;
  SilhouetteView view;
  view.eye = torus()->forest().grid.fromModel(asked.eye);
  view.forward = asked.forward;
  EXPECT_EQ(*lines, torus()->contours(SilhouetteKind::kEdges)->extract(view));
  EXPECT_GT(lines->points.size(), 20U);
}

TEST_F(ContourLink, OfRequestsThatWaitOnlyTheNewestIsAnswered) {
  for (std::uint32_t id = 1; id <= 5; ++id)
    link_.send(request(id, {1.0, 0.1 * id, 0.2}));
  // The first is being worked on; the others wait, and replace one another.
  link_.settle(200);
  ASSERT_EQ(link_.contours_.size(), 2U);
  EXPECT_EQ(link_.contours_[0].first, 1U);
  EXPECT_EQ(link_.contours_[1].first, 5U);
}

TEST_F(ContourLink, IdsMustGrow) {
  link_.send(request(4, {1.0, 0.0, 0.0}));
  link_.send(request(4, {0.0, 1.0, 0.0}));
  link_.settle();
  ASSERT_EQ(link_.failures_.size(), 1U);
  EXPECT_EQ(link_.failures_[0], WireError::kState);
}

TEST_F(ContourLink, AnEyeAtNonsenseIsRefusedOrAnswered) {
  GetContour inside = request(1, {1.0, 0.0, 0.0});
  inside.eye = torus()->info().center;
  link_.send(inside);
  GetContour far = request(2, {1.0, 0.0, 0.0});
  far.eye = glm::dvec3(1e300, -1e300, 1e300);
  link_.send(far);
  link_.settle(200);
  EXPECT_EQ(link_.contours_.size(), 2U);
  EXPECT_TRUE(link_.failures_.empty());
}

}  // namespace
}  // namespace limn
