// SPDX-License-Identifier: Apache-2.0
// The codecs know nothing of the protocol, and the other way round: here the limits of both meet.
#include "protocol/limits.h"

#include "shared/codec/contour_codec.h"
#include "shared/codec/neighbourhood.h"
#include "shared/codec/split_codec.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/mesh/vertex_attributes.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(Limits, OfTheCodecsAreThoseOfTheProtocol) {
  EXPECT_EQ(kMaxRunSplits, limits::kMaxPacketSplits);
  EXPECT_EQ(kMaxContourExtraBits, limits::kMaxContourExtraBits);
  EXPECT_EQ(split_syntax::kMaxRing, limits::kMaxRing);
  EXPECT_EQ(kAllAttributeKinds, limits::kMaxAttributeKinds);
  EXPECT_GE(kMaxGridCoordinate, 1 << limits::kMaxGridBits);
}

}  // namespace
}  // namespace limn
