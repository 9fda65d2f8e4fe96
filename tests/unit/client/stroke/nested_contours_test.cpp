// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/nested_contours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace limn {
namespace {

constexpr Viewport kViewport{200, 200};
constexpr float kWidthPx = 3.0F;  // nested up to 3.9 px

/// Lines of samples a pixel apart.
struct Lines {
  SpineSamples samples;
  std::vector<LineFade> fades;

  /// From x 20 to 180; height(x) is its y. up: which side the surface does not lie on, or 0.
  template <class Height>
  std::size_t add(Height height, float up) {
    const std::size_t first = samples.samples.size();
    samples.begin.push_back(static_cast<std::uint32_t>(first));
    for (int x = 20; x <= 180; ++x) {
      const auto at = static_cast<float>(x);
      const glm::vec2 along =
          glm::normalize(glm::vec2(1.0F, height(at + 0.5F) - height(at - 0.5F)));
      SpineSample sample;
      sample.position = glm::vec2(at, height(at)) / 200.0F;
      sample.outward = up * glm::vec2(along.y, -along.x);
      sample.first = static_cast<float>(first);
      sample.last = static_cast<float>(first + 160);
      samples.samples.push_back(sample);
    }
    return first;
  }

  std::size_t straight(float y, float up = 1.0F) {
    return add([y](float) { return y; }, up);
  }

  void find() {
    fades.resize(samples.begin.size());
    NestedContours().find(kViewport, kWidthPx, fades, samples);
  }

  /// Samples of a line that are nested in samples of another.
  [[nodiscard]] int count(std::size_t inner, std::size_t outer) const {
    const auto first = samples.samples.begin() + static_cast<std::ptrdiff_t>(inner);
    return static_cast<int>(std::count_if(first, first + 161, [&](const SpineSample& sample) {
      return sample.nestedIn >= static_cast<float>(outer) &&
             sample.nestedIn <= static_cast<float>(outer + 160);
    }));
  }
};

TEST(NestedContours, TheInnerOfTwoIsNestedInTheOuterOne) {
  Lines lines;
  const std::size_t outer = lines.straight(100.0F);
  const std::size_t inner = lines.straight(103.0F);
  const std::size_t apart = lines.straight(108.0F);
  lines.find();
  EXPECT_EQ(lines.count(inner, outer), 161);
  EXPECT_EQ(lines.count(outer, inner), 0);
  EXPECT_EQ(lines.count(apart, inner), 0);
  // In the sample beside it.
  const SpineSample& sample = lines.samples.samples[inner + 50];
  EXPECT_NEAR(sample.nestedIn, static_cast<float>(outer + 50), 2.0F);
}

TEST(NestedContours, ThinPartsAndOtherLinesKeepBothSides) {
  Lines thin;
  const std::size_t upper = thin.straight(100.0F, 1.0F);
  const std::size_t lower = thin.straight(103.0F, -1.0F);
  thin.find();
  EXPECT_EQ(thin.count(upper, lower) + thin.count(lower, upper), 0);

  Lines crease;
  const std::size_t outline = crease.straight(100.0F);
  const std::size_t inside = crease.straight(103.0F, 0.0F);
  crease.find();
  EXPECT_EQ(crease.count(inside, outline), 0);
}

TEST(NestedContours, WhatIsHiddenForSureNestsNothing) {
  Lines lines;
  const std::size_t outer = lines.straight(100.0F);
  const std::size_t inner = lines.straight(103.0F);
  for (std::size_t i = 0; i <= 160; ++i)
    lines.samples.samples[outer + i].bias = -1.0F;
  lines.find();
  EXPECT_EQ(lines.count(inner, outer), 0);
}

TEST(NestedContours, AFaintContourNestsNothingStronger) {
  Lines lines;
  const std::size_t outer = lines.straight(100.0F);
  const std::size_t inner = lines.straight(103.0F);
  lines.fades = {{0.5F, 1.0F}, {0.6F, 1.0F}};
  lines.find();
  EXPECT_EQ(lines.count(inner, outer), 0);
  lines.fades = {{0.5F, 1.0F}, {0.5F, 1.0F}};
  lines.find();
  EXPECT_EQ(lines.count(inner, outer), 161);
}

TEST(NestedContours, OfManyBesideOneAnotherTheSecondGoes) {
  Lines lines;
  std::vector<std::size_t> first;
  for (int i = 0; i < 6; ++i)
    first.push_back(lines.straight(100.0F + 3.0F * static_cast<float>(i)));
  lines.find();
  EXPECT_EQ(lines.count(first[1], first[0]), 161);
  for (std::size_t i = 2; i < 6; ++i)
    EXPECT_EQ(lines.count(first[i], first[i - 1]), 0) << i;
}

TEST(NestedContours, ACrossingAndAScrapAreEvenedOut) {
  Lines crossing;
  const std::size_t outer = crossing.straight(100.0F);
  const std::size_t inner =
      crossing.add([](float x) { return 100.0F + 0.6F * (x - 100.0F); }, 1.0F);
  crossing.find();
  EXPECT_EQ(crossing.count(inner, outer), 0);

  // Apart for some 5 px in the middle.
  Lines scrap;
  const std::size_t outline = scrap.straight(100.0F);
  const std::size_t beside =
      scrap.add([](float x) { return 103.0F + (std::abs(x - 100.0F) < 2.5F ? 1.5F : 0.0F); }, 1.0F);
  scrap.find();
  EXPECT_GE(scrap.count(beside, outline), 152);
}

}  // namespace
}  // namespace limn
