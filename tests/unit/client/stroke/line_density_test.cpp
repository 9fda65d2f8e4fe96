// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/line_density.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limn {
namespace {

constexpr Viewport kViewport{512, 512};

/// Upright lines so many pixels apart.
LineDensity hatching(float spacingPx, bool visible) {
  LineDensity density(kViewport);
  for (float x = 0.5F; x < 512.0F; x += spacingPx) {
    for (float y = 0.5F; y < 512.0F; ++y)
      density.add({x, y}, visible);
  }
  return density;
}

TEST(LineDensity, OfParallelLinesIsOneOverTheirSpacing) {
  for (const float spacing : {2.0F, 4.0F, 8.0F, 32.0F}) {
    const glm::vec2 visible = hatching(spacing, true).at({256.0F, 256.0F});
    EXPECT_NEAR(visible.x, 1.0F / spacing, 0.05F / spacing);
    EXPECT_EQ(visible.y, 0.0F);
    EXPECT_NEAR(hatching(spacing, false).at({250.0F, 261.0F}).y, 1.0F / spacing, 0.05F / spacing);
  }
}

TEST(LineDensity, ChangesSmoothly) {
  LineDensity density(kViewport);
  for (float y = 0.5F; y < 512.0F; ++y)
    density.add({100.3F, y}, true);
  float before = density.at({40.0F, 256.0F}).x;
  for (float x = 40.0F; x < 160.0F; x += 0.5F) {
    const float here = density.at({x, 256.0F}).x;
    EXPECT_LT(std::abs(here - before), 0.001F);
    before = here;
  }
}

TEST(LineDensity, ALineByItselfKeepsItsWidthAndManyDoNotMerge) {
  const float alone = hatching(600.0F, true).at({1.0F, 256.0F}).x;
  for (const float width : {1.0F, 2.6F, 8.0F})
    EXPECT_EQ(crowdingOfVisible(alone, width).width, 1.0F);
  for (const float spacing : {2.0F, 3.0F, 4.0F}) {
    const Crowding crowding = crowdingOfVisible(1.0F / spacing, 2.6F);
    EXPECT_LT(2.6F * crowding.width, 0.5F * spacing);
    EXPECT_EQ(crowding.opacity, 1.0F);
  }
  const Crowding solid = crowdingOfVisible(1.5F, 2.6F);
  EXPECT_EQ(solid.width, kLeastWidth);
  EXPECT_EQ(solid.opacity, kLeastOpacity);
}

TEST(LineDensity, AFadingStrokeThinsBeforeItPales) {
  const Crowding half = faded({}, 0.5F);
  EXPECT_EQ(half.width, 0.5F);
  EXPECT_EQ(half.opacity, 1.0F);
  const Crowding little = faded({}, 0.5F * kLeastWidth);
  EXPECT_EQ(little.width, kLeastWidth);
  EXPECT_FLOAT_EQ(little.opacity, 0.5F);
  EXPECT_EQ(faded({}, 0.0F).opacity, 0.0F);
  const Crowding crowded = crowdingOfVisible(0.8F, 2.6F);
  EXPECT_EQ(faded(crowded, 1.0F).width, crowded.width);
  EXPECT_EQ(faded(crowded, 1.0F).opacity, crowded.opacity);
}

TEST(LineDensity, ManyHiddenLinesArePalerTogetherThanFew) {
  float before = 1e9F;
  for (const float density : {0.1F, 0.2F, 0.4F, 0.5F}) {
    const float tone = density * crowdingOfHidden(density, 2.6F).opacity;
    EXPECT_LT(tone, before);
    before = tone;
  }
  EXPECT_EQ(crowdingOfHidden(0.03F, 2.6F).opacity, 1.0F);
  EXPECT_EQ(crowdingOfHidden(1.0F, 2.6F).opacity, kPalest);
}

}  // namespace
}  // namespace limn
