// SPDX-License-Identifier: Apache-2.0
#include "client/svg/stroke_shape.h"

#include <gtest/gtest.h>

#include <numeric>
#include <string_view>
#include <vector>

namespace limn {
namespace {

/// A picture of 4 rows whose two middle ones are inked where the columns say so.
std::vector<std::uint8_t> picture(std::string_view columns) {
  std::vector<std::uint8_t> ink(4 * columns.size(), 0);
  for (std::size_t x = 0; x < columns.size(); ++x) {
    if (columns[x] != '#') continue;
    ink[columns.size() + x] = 255;
    ink[2 * columns.size() + x] = 255;
  }
  return ink;
}

TEST(StrokeShape, ASolidStrokeHasNoDashes) {
  const StrokeShape shape = strokeShape(picture("################"), 16);
  EXPECT_TRUE(shape.dashes.empty());
  EXPECT_FLOAT_EQ(shape.thickness, 0.5F);
  EXPECT_FLOAT_EQ(shape.strength, 1.0F);
}

TEST(StrokeShape, DashesOfOneLengthAreOneDash) {
  // From the end round to the beginning it goes on: dashes of 6, 3 and 3.
  EXPECT_EQ(strokeShape(picture("###.###..###.###"), 16).dashes, (std::vector{4 / 16.F, 4 / 48.F}));
  EXPECT_EQ(strokeShape(picture("####...####..."), 14).dashes, (std::vector{4 / 14.F, 3 / 14.F}));
}

TEST(StrokeShape, DashesBeginWhereThePicturesDo) {
  EXPECT_FLOAT_EQ(strokeShape(picture("..####...####."), 14).dashStart, 2 / 14.F);
  EXPECT_FLOAT_EQ(strokeShape(picture("##...####...##"), 14).dashStart, 12 / 14.F);
  // Dash and dot; the dash goes on from the end round to the beginning.
  EXPECT_FLOAT_EQ(strokeShape(picture("#...#....#######"), 16).dashStart, 9 / 16.F);
  // Dashes of 3 and 5 are both 4, their middles where they were in the mean.
  EXPECT_FLOAT_EQ(strokeShape(picture("###.....#####..."), 16).dashStart, 0.0F);
}

TEST(StrokeShape, DashAndDotStayApartAndFillTheRepeat) {
  const StrokeShape shape = strokeShape(picture("##########...#..."), 17);
  ASSERT_EQ(shape.dashes.size(), 4U);
  EXPECT_FLOAT_EQ(shape.dashes[0], 10.0F / 17.0F);
  EXPECT_FLOAT_EQ(std::accumulate(shape.dashes.begin(), shape.dashes.end(), 0.0F), 1.0F);
}

TEST(StrokeShape, NothingAndNonsenseAreSolid) {
  EXPECT_TRUE(strokeShape({}, 0).dashes.empty());
  EXPECT_TRUE(strokeShape(picture("...."), 4).dashes.empty());
  EXPECT_TRUE(strokeShape(picture("####"), 1000).dashes.empty());
}

}  // namespace
}  // namespace limn
