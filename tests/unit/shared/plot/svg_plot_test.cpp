// SPDX-License-Identifier: Apache-2.0
#include "shared/plot/svg_plot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace limn {
namespace {

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

TEST(PlotTicks, AreRoundNumbersInsideTheRange) {
  EXPECT_EQ(
      plotTicks(PlotScale::kLinear, 0.0, 10.5),
      (std::vector<double>{0.0, 2.0, 4.0, 6.0, 8.0, 10.0}));
  EXPECT_EQ(
      plotTicks(PlotScale::kLogarithmic, 0.9, 60.0),
      (std::vector<double>{1.0, 2.0, 5.0, 10.0, 20.0, 50.0}));
  EXPECT_EQ(
      plotTicks(PlotScale::kLogarithmic, 1.0, 1e4).size(),
      5U);  // many decades: their powers alone
}

TEST(PlotTicks, StayFewWhateverTheRange) {
  for (int e = -12; e <= 12; ++e) {
    const double high = std::pow(10.0, e) * 3.7;
    const std::size_t linear = plotTicks(PlotScale::kLinear, 0.0, high).size();
    EXPECT_GE(linear, 3U) << high;
    EXPECT_LE(linear, 8U) << high;
    if (e < 1) continue;
    EXPECT_LE(plotTicks(PlotScale::kLogarithmic, 1e-12, high).size(), 9U) << high;
  }
}

TEST(SvgPlot, EscapesEveryText) {
  const PlotPanel panel{
      .title = "a<b & \"c\"",
      .x = {.label = "x>0"},
      .y = {.label = "&"},
      .curves = {{.label = "</svg>", .points = {{1, 1}}}}};
  const std::string svg = svgPlot(std::span(&panel, 1));
  EXPECT_EQ(countOf(svg, "</svg>"), 1U);
  EXPECT_NE(svg.find("a&lt;b &amp; &quot;c&quot;"), std::string::npos);
}

TEST(SvgPlot, LeavesOutWhatAnAxisCannotShowAndBreaksTheLine) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const PlotPanel panel{
      .title = "",
      .x = {.label = "", .scale = PlotScale::kLogarithmic},
      .y = {.label = ""},
      .curves = {{.label = "", .points = {{1, 1}, {2, 2}, {0, 3}, {4, nan}, {5, 1}, {6, 2}}}}};
  const std::string svg = svgPlot(std::span(&panel, 1));
  EXPECT_EQ(countOf(svg, "<circle"), 4U);
  const std::size_t path = svg.find("<path d=\"") + 9;
  const std::string d = svg.substr(path, svg.find('"', path) - path);
  EXPECT_EQ(countOf(d, "M"), 2U);
  EXPECT_EQ(countOf(d, "L"), 2U);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(SvgPlot, GivesALabelItsColourInEveryPanel) {
  const PlotCurve a{.label = "a", .points = {{1, 1}}};
  const PlotCurve b{.label = "b", .points = {{1, 1}}};
  const PlotPanel panels[] = {
      {.title = "", .x = {}, .y = {}, .curves = {a, b}},
      {.title = "", .x = {}, .y = {}, .curves = {b}}};
  const std::string svg = svgPlot(panels);
  EXPECT_EQ(countOf(svg, "stroke=\"#0072b2\""), 2U);  // curve and legend
  EXPECT_EQ(countOf(svg, "stroke=\"#d55e00\""), 4U);
}

TEST(SvgPlot, DrawsPanelsWithoutMeasurements) {
  const PlotPanel panel{.title = "empty", .x = {.label = "x"}, .y = {.label = "y"}, .curves = {}};
  const std::string svg = svgPlot(std::span(&panel, 1));
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

}  // namespace
}  // namespace limn
