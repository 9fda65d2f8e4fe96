// SPDX-License-Identifier: Apache-2.0
#include "client/svg/path_data.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(PathData, IsRelativeAndShort) {
  FittedPath path;
  path.start = {10.5, 20.0};
  path.steps = {
      {{}, {}, {11.25, 20.5}, false},
      {{}, {}, {11.0, 20.25}, false},
      {{12.0, 20.25}, {13.0, 21.0}, {13.0, 22.05}, true}};
  EXPECT_EQ(pathData(path, PathEnds::kOpen), "M10.5 20l.75.5-.25-.25c1 0 2 .75 2 1.8");
}

TEST(PathData, RoundingDoesNotAddUp) {
  FittedPath path;
  for (int i = 1; i <= 1000; ++i)
    path.steps.push_back({{}, {}, {0.004 * i, 0.0}, false});
  // Steps of 0.004 round to 0 or 0.01 as they come; the end is at 4.
  const std::string data = pathData(path, PathEnds::kOpen);
  std::size_t hundredths = 0;
  for (std::size_t at = data.find(".01"); at != std::string::npos; at = data.find(".01", at + 1))
    ++hundredths;
  EXPECT_EQ(hundredths, 400U);
}

TEST(PathData, LoopsAreClosed) {
  FittedPath path;
  path.steps = {
      {{}, {}, {5.0, 0.0}, false},
      {{}, {}, {5.0, 5.0}, false},
      {{}, {}, {0.0, 0.0}, false}};
  EXPECT_EQ(pathData(path, PathEnds::kClosed), "M0 0l5 0 0 5z");
}

}  // namespace
}  // namespace limn
