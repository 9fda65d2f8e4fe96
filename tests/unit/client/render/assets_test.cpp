// SPDX-License-Identifier: Apache-2.0
#include "client/render/assets.h"

#include "client/render/image_io.h"
#include "client/stroke/style.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

namespace limn {
namespace {

TEST(Assets, TheBuildFindsItsTextureSets) {
  const auto assets = findAssets();
  ASSERT_TRUE(assets) << assets.error().message;
  const std::vector<std::string> styles = listStyles(*assets);
  for (const char* name : {"coloured-pencil", "felt-pen", "ink", "marker", "pencil", "technical"}) {
    EXPECT_NE(std::find(styles.begin(), styles.end(), name), styles.end()) << name;
  }
}

TEST(Assets, AChosenFolderWithoutStylesIsRefused) {
  const auto assets = findAssets("/no/such/folder");
  ASSERT_FALSE(assets);
  EXPECT_EQ(assets.error().code, ErrorCode::kNotFound);
  EXPECT_NE(assets.error().message.find("/no/such/folder"), std::string::npos);
}

/// Our own sets: hidden strokes are dashed, visible ones not; both close where they repeat.
TEST(Assets, OurTexturesAreStrokesThatRepeatWithoutASeam) {
  const std::filesystem::path assets = LIMN_TEST_ASSETS;
  for (const std::string& name : listStyles(assets)) {
    std::ifstream file(assets / name / "style.toml");
    const auto style = parseStyle(
        std::string{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()});
    ASSERT_TRUE(style) << name << ": " << style.error().message;
    for (const bool isHidden : {false, true}) {
      const auto image =
          readPng(assets / name / (isHidden ? style->hidden.file : style->visible.file));
      ASSERT_TRUE(image) << image.error().message;
      const auto ink = [&](int x, int y) {
        return static_cast<int>(
            image->rgba[4 * static_cast<std::size_t>(y * image->width + x) + 3]);
      };
      int gaps = 0;
      int largestStep = 0;
      for (int x = 0; x < image->width; ++x) {
        int column = 0;
        int step = 0;
        const int next = (x + 1) % image->width;
        for (int y = 0; y < image->height; ++y) {
          column = std::max(column, ink(x, y));
          step += std::abs(ink(x, y) - ink(next, y));
        }
        gaps += column < 16 ? 1 : 0;
        if (next == 0) {
          EXPECT_LE(step, largestStep) << name << ": a seam";
        }
        largestStep = std::max(largestStep, step);
        // Nothing may bleed over the strip's edge.
        EXPECT_LT(ink(x, 0), 48) << name;
        EXPECT_LT(ink(x, image->height - 1), 48) << name;
      }
      const double share = static_cast<double>(gaps) / image->width;
      if (isHidden) {
        EXPECT_GT(share, 0.2) << name;
        EXPECT_LT(share, 0.6) << name;
      } else {
        EXPECT_EQ(gaps, 0) << name;
      }
    }
  }
}

}  // namespace
}  // namespace limn
