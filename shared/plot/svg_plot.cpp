// SPDX-License-Identifier: Apache-2.0
#include "shared/plot/svg_plot.h"

#include "shared/core/assert.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string_view>

namespace limn {
namespace {

// Pixels. A panel is its diagram and the margins that hold its words.
constexpr double kDiagramWidth = 460;
constexpr double kDiagramHeight = 340;
constexpr double kLeft = 70;
constexpr double kTop = 40;
constexpr double kRight = 20;
constexpr double kBottom = 56;
constexpr double kLegendLine = 18;

constexpr std::array<std::string_view, 8> kColours =
    {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#000000", "#56b4e9", "#e69f00", "#999999"};

std::string number(double value, const char* format = "%.6g") {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, value == 0.0 ? 0.0 : value);
  return text.data();
}

std::string pixel(double value) {
  return number(value, "%.2f");
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

bool canShow(PlotScale scale, double value) {
  return std::isfinite(value) && (scale == PlotScale::kLinear || value > 0.0);
}

/// From values to pixels along one axis.
class AxisMap {
 public:
  AxisMap(PlotScale scale, double low, double high, double from, double to)
      : scale_(scale),
        low_(low),
        high_(high),
        from_(from),
        to_(to) {}

  [[nodiscard]] double operator()(double value) const {
    return from_ + (to_ - from_) * (at(value) - at(low_)) / (at(high_) - at(low_));
  }

  [[nodiscard]] std::vector<double> ticks() const { return plotTicks(scale_, low_, high_); }

 private:
  [[nodiscard]] double at(double value) const {
    return scale_ == PlotScale::kLinear ? value : std::log10(value);
  }

  PlotScale scale_;
  double low_;
  double high_;
  double from_;
  double to_;
};

AxisMap fitAxis(const PlotPanel& panel, int axis, double from, double to) {
  const PlotScale scale = axis == 0 ? panel.x.scale : panel.y.scale;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const PlotCurve& curve : panel.curves) {
    for (const glm::dvec2& p : curve.points) {
      if (!canShow(panel.x.scale, p.x) || !canShow(panel.y.scale, p.y)) continue;
      low = std::min(low, p[axis]);
      high = std::max(high, p[axis]);
    }
  }
  if (!(low <= high)) low = high = 1.0;
  if (scale == PlotScale::kLinear) {
    low = std::min(low, 0.0);
    high += 0.05 * (high - low);
    if (low == high) high = low + 1.0;
  } else {
    low /= 1.25;
    high *= 1.25;
  }
  return {scale, low, high, from, to};
}

std::string textAt(double x, double y, std::string_view attributes, std::string_view text) {
  return "<text x=\"" + pixel(x) + "\" y=\"" + pixel(y) + "\" " + std::string(attributes) + ">" +
         escaped(text) + "</text>\n";
}

std::string lineFrom(double x1, double y1, double x2, double y2) {
  return "<line x1=\"" + pixel(x1) + "\" y1=\"" + pixel(y1) + "\" x2=\"" + pixel(x2) + "\" y2=\"" +
         pixel(y2) + "\"/>\n";
}

// Ticks, grid, frame and names.
std::string drawAxes(const PlotPanel& panel, const AxisMap& x, const AxisMap& y) {
  const double right = kLeft + kDiagramWidth;
  const double bottom = kTop + kDiagramHeight;
  std::string svg = "<g stroke=\"#ddd\">\n";
  for (const double tick : x.ticks())
    svg += lineFrom(x(tick), kTop, x(tick), bottom);
  for (const double tick : y.ticks())
    svg += lineFrom(kLeft, y(tick), right, y(tick));
  svg += "</g>\n<rect x=\"" + pixel(kLeft) + "\" y=\"" + pixel(kTop) + "\" width=\"" +
         pixel(kDiagramWidth) + "\" height=\"" + pixel(kDiagramHeight) +
         "\" fill=\"none\" stroke=\"#666\"/>\n";
  for (const double tick : x.ticks())
    svg += textAt(x(tick), bottom + 16, "text-anchor=\"middle\"", number(tick));
  for (const double tick : y.ticks())
    svg += textAt(kLeft - 6, y(tick) + 4, "text-anchor=\"end\"", number(tick));
  const double middle = kTop + kDiagramHeight / 2;
  svg += textAt(kLeft + kDiagramWidth / 2, bottom + 40, "text-anchor=\"middle\"", panel.x.label);
  svg += textAt(
      16,
      middle,
      "text-anchor=\"middle\" transform=\"rotate(-90 16 " + pixel(middle) + ")\"",
      panel.y.label);
  svg += textAt(kLeft, kTop - 14, "font-weight=\"bold\"", panel.title);
  return svg;
}

std::string drawCurve(
    const PlotPanel& panel,
    const PlotCurve& curve,
    std::string_view colour,
    const AxisMap& x,
    const AxisMap& y) {
  std::string path;
  std::string points;
  bool penDown = false;
  for (const glm::dvec2& p : curve.points) {
    if (!canShow(panel.x.scale, p.x) || !canShow(panel.y.scale, p.y)) {
      penDown = false;
      continue;
    }
    const std::string px = pixel(x(p.x));
    const std::string py = pixel(y(p.y));
    path += (penDown ? 'L' : 'M') + px + ' ' + py;
    points += "<circle cx=\"" + px + "\" cy=\"" + py + "\" r=\"2.5\"/>\n";
    penDown = true;
  }
  std::string svg = "<g stroke=\"" + std::string(colour) + "\" fill=\"" + std::string(colour) +
                    "\">\n<title>" + escaped(curve.label) + "</title>\n";
  if (curve.mark != PlotMark::kPoints)
    svg += "<path d=\"" + path + "\" fill=\"none\" stroke-width=\"1.5\"/>\n";
  if (curve.mark != PlotMark::kLine) svg += points;
  return svg + "</g>\n";
}

/// Labels in the order in which they appear: what colours go by.
class LabelColours {
 public:
  std::string_view operator()(const std::string& label) {
    const auto found = std::ranges::find(labels_, label);
    const auto index = static_cast<std::size_t>(found - labels_.begin());
    if (found == labels_.end()) labels_.push_back(label);
    return kColours[index % kColours.size()];
  }

 private:
  std::vector<std::string> labels_;
};

std::string drawPanel(const PlotPanel& panel, LabelColours& colours) {
  const AxisMap x = fitAxis(panel, 0, kLeft, kLeft + kDiagramWidth);
  const AxisMap y = fitAxis(panel, 1, kTop + kDiagramHeight, kTop);
  std::string svg = drawAxes(panel, x, y);
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const PlotCurve& curve = panel.curves[i];
    const std::string_view colour = colours(curve.label);
    svg += drawCurve(panel, curve, colour, x, y);
    const double line =
        kTop + kDiagramHeight + kBottom + kLegendLine * (static_cast<double>(i) + 0.5);
    svg += "<g stroke=\"" + std::string(colour) + "\" stroke-width=\"3\">" +
           lineFrom(kLeft, line - 4, kLeft + 24, line - 4) + "</g>\n";
    svg += textAt(kLeft + 32, line, "", curve.label);
  }
  return svg;
}

}  // namespace

std::vector<double> plotTicks(PlotScale scale, double low, double high) {
  LIMN_ASSERT(low < high && (scale == PlotScale::kLinear || low > 0.0));
  std::vector<double> ticks;
  if (scale == PlotScale::kLinear) {
    const double rough = (high - low) / 6;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    const double digit = rough / power;
    const double step = power * (digit <= 1 ? 1 : digit <= 2 ? 2 : digit <= 5 ? 5 : 10);
    for (double i = std::ceil(low / step); i * step <= high; ++i)
      ticks.push_back(i * step);
    return ticks;
  }
  const double decades = std::log10(high / low);
  const int every = std::max(1, static_cast<int>(std::ceil(decades / 8)));
  for (int e = static_cast<int>(std::floor(std::log10(low))); std::pow(10.0, e) <= high; ++e) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      if (digit > 1.0 && decades > 3.0) break;
      if (digit == 1.0 && e % every != 0) continue;
      const double tick = digit * std::pow(10.0, e);
      if (tick >= low && tick <= high) ticks.push_back(tick);
    }
  }
  return ticks;
}

std::string svgPlot(std::span<const PlotPanel> panels) {
  constexpr double kPanelWidth = kLeft + kDiagramWidth + kRight;
  std::size_t longestLegend = 0;
  for (const PlotPanel& panel : panels)
    longestLegend = std::max(longestLegend, panel.curves.size());
  const double width = kPanelWidth * static_cast<double>(panels.size());
  const double height =
      kTop + kDiagramHeight + kBottom + kLegendLine * (static_cast<double>(longestLegend) + 0.5);
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + number(width) +
                    "\" height=\"" + number(height) + "\" viewBox=\"0 0 " + number(width) + ' ' +
                    number(height) +
                    "\" font-family=\"sans-serif\" font-size=\"12\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  LabelColours colours;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    svg += "<g transform=\"translate(" + number(kPanelWidth * static_cast<double>(i)) + " 0)\">\n" +
           drawPanel(panels[i], colours) + "</g>\n";
  }
  return svg + "</svg>\n";
}

}  // namespace limn
