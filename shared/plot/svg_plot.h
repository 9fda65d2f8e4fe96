// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace limn {

enum class PlotScale : std::uint8_t { kLinear, kLogarithmic };

struct PlotAxis {
  std::string label;  // with the unit
  PlotScale scale = PlotScale::kLinear;
};

enum class PlotMark : std::uint8_t {
  kLine,            // no points
  kLineWithPoints,  // few measurements
  kPoints,
};

/// One series of measurements. Points that an axis cannot show (not finite; not positive on a
/// logarithmic axis) are left out, and a line is broken there.
struct PlotCurve {
  std::string label;
  std::vector<glm::dvec2> points;
  PlotMark mark = PlotMark::kLineWithPoints;
};

/// One diagram: curves over common axes.
struct PlotPanel {
  std::string title;
  PlotAxis x;
  PlotAxis y;
  std::vector<PlotCurve> curves;
};

/// Panels beside each other, as an SVG document: round ticks, a legend, colours that the colour-
/// blind can tell apart [Okabe and Ito 2008], the same for the same label in all panels. Axes begin
/// at 0 when linear. Any text is escaped. Deterministic: equal panels give equal bytes.
[[nodiscard]] std::string svgPlot(std::span<const PlotPanel> panels);

/// Where ticks go on an axis from low to high: 1, 2 or 5 times a power of ten apart, or powers of
/// ten (with 2 and 5 between when they are few). low < high, both positive when logarithmic.
[[nodiscard]] std::vector<double> plotTicks(PlotScale scale, double low, double high);

}  // namespace limn
