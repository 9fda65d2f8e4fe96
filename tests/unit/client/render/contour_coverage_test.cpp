// SPDX-License-Identifier: Apache-2.0
#include "client/render/contour_coverage.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 30;
constexpr int kSide = 32;  // samples a pixel and direction of the oracle

/// Where the rasteriser would have a point: an odd multiple of 1/256 pixel.
glm::vec3 onGrid(double x, double y, float z) {
  return {
      static_cast<float>((2.0 * std::floor(128.0 * x) + 1.0) / 256.0),
      static_cast<float>((2.0 * std::floor(128.0 * y) + 1.0) / 256.0),
      z};
}

ClipContours loopsOf(const std::vector<std::vector<glm::dvec2>>& loops) {
  ClipContours contours;
  for (const auto& loop : loops) {
    for (const glm::dvec2& p : loop)
      contours.points.push_back(onGrid(p.x, p.y, 1.0F));
    contours.points.push_back(onGrid(loop[0].x, loop[0].y, 0.0F));
  }
  return contours;
}

int windingAt(const ClipContours& contours, const glm::dvec2& p) {
  int winding = 0;
  for (std::size_t i = 0; i + 1 < contours.points.size(); ++i) {
    if (contours.points[i].z == 0.0F) continue;
    const glm::dvec2 a(contours.points[i]);
    const glm::dvec2 b(contours.points[i + 1]);
    if ((a.y > p.y) == (b.y > p.y)) continue;
    if (a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) < p.x) winding += b.y < a.y ? 1 : -1;
  }
  return winding;
}

/// The share of each pixel where contours wind around a positive number of times, by samples.
double sampledCoverage(const ClipContours& contours, int x, int y) {
  int inside = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    const glm::dvec2 p(x + (i % kSide + 0.5) / kSide, y + (i / kSide + 0.53) / kSide);
    inside += windingAt(contours, p) > 0 ? 1 : 0;
  }
  return inside / static_cast<double>(kSide * kSide);
}

std::map<std::pair<int, int>, int> found(const ClipContours& contours) {
  ContourCoverage coverage;
  std::map<std::pair<int, int>, int> pixels;
  for (const CoveredPixel& p : coverage.find(contours, {kWidth, kHeight}))
    EXPECT_TRUE(pixels.emplace(std::pair(p.x, p.y), p.coverage).second) << "twice";
  return pixels;
}

TEST(ContourCoverage, OfABoxIsItsArea) {
  // 2.5 × 1.25 pixels, counter-clockwise.
  const auto pixels = found(loopsOf({{{4.0, 7.0}, {6.5, 7.0}, {6.5, 8.25}, {4.0, 8.25}}}));
  // The rows through y 8 to 8.25, and the column x 6 to 6.5; the grid's odd places are 1/256 off.
  EXPECT_NEAR(pixels.at({6, 7}), 128, 2);
  EXPECT_NEAR(pixels.at({4, 8}), 64, 2);
  EXPECT_NEAR(pixels.at({6, 8}), 32, 2);
  for (const auto& [place, value] : pixels) {
    if (place.first < 4 || place.first > 6 || place.second < 7 || place.second > 8) FAIL();
  }
}

TEST(ContourCoverage, OfAClockwiseLoopIsNothing) {
  EXPECT_TRUE(found(loopsOf({{{4, 7}, {4, 9}, {6, 9}, {6, 7}}})).empty());
}

TEST(ContourCoverage, EdgesInsideTheOutlineLeaveNoTrace) {
  const std::vector<glm::dvec2> outer = {{2, 2}, {30, 2}, {30, 20}, {2, 20}};
  const std::vector<glm::dvec2> inner = {{8.3, 8.2}, {14.7, 8.4}, {11.1, 13.9}};
  for (const auto& [place, value] : found(loopsOf({outer, inner}))) {
    EXPECT_TRUE(place.first <= 2 || place.first >= 29 || place.second <= 2 || place.second >= 19);
  }
}

TEST(ContourCoverage, IsWhatSamplesOfRandomLoopsSay) {
  Rng rng(5);
  for (int round = 0; round < 8; ++round) {
    std::vector<std::vector<glm::dvec2>> loops(1 + rng.below(3));
    for (auto& loop : loops) {
      // Some leave the picture; many cross themselves, and each other within pixels.
      const glm::dvec2 middle(kWidth * rng.uniform(), kHeight * rng.uniform());
      const double radius = std::pow(30.0, rng.uniform());
      for (std::uint32_t i = 0; i < 3 + rng.below(9); ++i)
        loop.push_back(middle + radius * glm::dvec2(rng.uniform() - 0.5, rng.uniform() - 0.5));
    }
    const ClipContours contours = loopsOf(loops);
    const auto pixels = found(contours);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const auto at = pixels.find({x, y});
        const bool middle = windingAt(contours, {x + 0.5, y + 0.5}) > 0;
        const double ours = at != pixels.end() ? at->second / 255.0 : middle ? 1.0 : 0.0;
        // Sixteen lines a pixel: an edge along them is off by half their distance at most; slivers
        // of several edges by more.
        EXPECT_NEAR(ours, sampledCoverage(contours, x, y), 0.08) << x << " " << y;
      }
    }
  }
}

TEST(ContourCoverage, FarOutsideAndEmptyContoursAreNoMatter) {
  EXPECT_TRUE(found({}).empty());
  // Around the whole picture, from far outside it.
  EXPECT_TRUE(found(loopsOf({{{-1e6, -1e6}, {1e6, -1e6}, {1e6, 1e6}, {-1e6, 1e6}}})).empty());
  EXPECT_TRUE(found(loopsOf({{{1e5, 3}, {2e5, 3}, {2e5, 9}}})).empty());
}

}  // namespace
}  // namespace limn
