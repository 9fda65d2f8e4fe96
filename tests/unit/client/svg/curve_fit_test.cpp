// SPDX-License-Identifier: Apache-2.0
#include "client/svg/curve_fit.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace limn {
namespace {

using Line = std::vector<glm::vec2>;

double distanceToLine(const glm::dvec2& p, const std::vector<glm::dvec2>& line) {
  double least = 1e30;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const glm::dvec2 a = line[i - 1];
    const glm::dvec2 ab = line[i] - a;
    const double length2 = glm::dot(ab, ab);
    const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, ab) / length2, 0.0, 1.0) : 0.0;
    least = std::min(least, glm::distance(p, a + t * ab));
  }
  return least;
}

std::vector<glm::dvec2> sampled(const FittedPath& path) {
  std::vector<glm::dvec2> points{path.start};
  for (const PathStep& step : path.steps) {
    const glm::dvec2 from = points.back();
    constexpr int kParts = 32;
    for (int k = 1; k <= kParts; ++k) {
      const double u = static_cast<double>(k) / kParts;
      const double v = 1.0 - u;
      points.push_back(
          step.isCurve ? v * v * v * from + 3.0 * v * v * u * step.control1 +
                             3.0 * v * u * u * step.control2 + u * u * u * step.to
                       : glm::mix(from, step.to, u));
    }
  }
  return points;
}

std::vector<glm::dvec2> exact(const Line& line, PathEnds ends) {
  std::vector<glm::dvec2> points(line.begin(), line.end());
  if (ends == PathEnds::kClosed) points.push_back(points.front());
  return points;
}

/// Both ways: the path keeps to the line, and leaves none of it out.
double errorOf(const Line& line, PathEnds ends) {
  const std::vector<glm::dvec2> ours = sampled(fitPath(line, ends));
  const std::vector<glm::dvec2> theirs = exact(line, ends);
  double most = 0.0;
  for (const glm::dvec2& p : ours)
    most = std::max(most, distanceToLine(p, theirs));
  for (std::size_t i = 1; i < theirs.size(); ++i) {
    for (const double t : {0.0, 0.3, 0.7, 1.0})
      most = std::max(most, distanceToLine(glm::mix(theirs[i - 1], theirs[i], t), ours));
  }
  return most;
}

Line circle(int points, float radius) {
  Line line;
  for (int i = 0; i < points; ++i) {
    const auto angle =
        2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(points);
    line.emplace_back(100.0F + radius * std::cos(angle), 100.0F + radius * std::sin(angle));
  }
  return line;
}

std::size_t curvesOf(const FittedPath& path) {
  return static_cast<std::size_t>(
      std::count_if(path.steps.begin(), path.steps.end(), [](const PathStep& s) {
        return s.isCurve;
      }));
}

TEST(CurveFit, StaysWithinAQuarterPixelOfAnyLine) {
  Rng rng(5);
  for (int round = 0; round < 40; ++round) {
    // Walks whose steps and turns go from fine and smooth to long and wild.
    const double step = 0.3 + 20.0 * rng.uniform() * rng.uniform();
    const double turn = 2.5 * rng.uniform() * rng.uniform();
    Line line;
    glm::dvec2 p(0.0);
    double angle = 0.0;
    const std::uint32_t count = 2 + rng.below(80);
    for (std::uint32_t i = 0; i < count; ++i) {
      line.emplace_back(p);
      angle += turn * (2.0 * rng.uniform() - 1.0);
      p += step * (0.5 + rng.uniform()) * glm::dvec2(std::cos(angle), std::sin(angle));
    }
    EXPECT_LE(errorOf(line, PathEnds::kOpen), 0.25) << "round " << round;
    if (count > 2) {
      EXPECT_LE(errorOf(line, PathEnds::kClosed), 0.25) << "closed, round " << round;
    }
    const FittedPath path = fitPath(line, PathEnds::kOpen);
    EXPECT_LT(glm::distance(path.start, glm::dvec2(line.front())), 1e-6);
    EXPECT_LT(glm::distance(path.steps.back().to, glm::dvec2(line.back())), 1e-6);
  }
}

TEST(CurveFit, ACircleIsAFewSmoothCurves) {
  const FittedPath path = fitPath(circle(400, 80.0F), PathEnds::kClosed);
  EXPECT_LE(path.steps.size(), 10U);
  EXPECT_EQ(curvesOf(path), path.steps.size());
  EXPECT_LT(glm::distance(path.start, path.steps.back().to), 1e-9);
  // No kink where it closes.
  const glm::dvec2 in = glm::normalize(path.steps.back().to - path.steps.back().control2);
  const glm::dvec2 out = glm::normalize(path.steps.front().control1 - path.start);
  EXPECT_GT(glm::dot(in, out), 0.999);
}

TEST(CurveFit, CornersStayCorners) {
  const Line square = {{0, 0}, {50, 0}, {100, 0}, {100, 100}, {0, 100}};
  const FittedPath path = fitPath(square, PathEnds::kClosed);
  EXPECT_EQ(path.steps.size(), 4U);
  EXPECT_EQ(curvesOf(path), 0U);
}

TEST(CurveFit, LongEdgesOfAPolygonAreNotRounded) {
  EXPECT_LE(errorOf(circle(12, 200.0F), PathEnds::kClosed), 0.25);
  EXPECT_EQ(fitPath(circle(12, 200.0F), PathEnds::kClosed).steps.size(), 12U);
}

TEST(CurveFit, ASinglePlaceIsAPathToo) {
  const FittedPath path = fitPath(Line{{3, 4}, {3, 4}}, PathEnds::kOpen);
  EXPECT_EQ(path.start, glm::dvec2(3, 4));
}

}  // namespace
}  // namespace limn
