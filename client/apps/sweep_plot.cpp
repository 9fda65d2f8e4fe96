// SPDX-License-Identifier: Apache-2.0
// The plots of M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), chapter 5, as
// one SVG.
#include "client/apps/sweep_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>

namespace limn {
namespace {

constexpr double kPanelWidth = 400.0;
constexpr double kPanelHeight = 240.0;
constexpr double kLeft = 62.0;  // room for the y axis
constexpr double kRight = 12.0;
constexpr double kTop = 34.0;     // room for the title
constexpr double kBottom = 38.0;  // room for the x axis
constexpr double kLegend = 34.0;

// One a detector, distinct also in lightness.
constexpr std::array<const char*, 8> kColors =
    {"#222222", "#1b6ca8", "#d1495b", "#8cb369", "#e0a106", "#8f5aa8", "#3fa7a0", "#b5651d"};

const char* colorOf(DetectorMethod method) {
  return kColors[static_cast<std::size_t>(method) % kColors.size()];
}

template <class... Arguments>
std::string format(const char* pattern, Arguments... arguments) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, arguments...);
  return text;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '&') {
      out += "&amp;";
    } else {
      out += c;
    }
  }
  return out;
}

struct Point {
  double x;
  double y;
};

struct Curve {
  const char* color;
  bool hasDots;
  std::vector<Point> points;
};

struct Axis {
  double low = 0.0;
  double high = 1.0;
  bool isLog = false;
  std::string label;

  // 0 … 1 along the axis.
  [[nodiscard]] double at(double v) const {
    if (!isLog) return (v - low) / (high - low);
    return (std::log10(std::max(v, low)) - std::log10(low)) / (std::log10(high) - std::log10(low));
  }

  [[nodiscard]] std::vector<double> ticks() const {
    std::vector<double> ticks;
    if (isLog) {
      for (double t = low; t <= high * 1.0001; t *= 10.0)
        ticks.push_back(t);
      return ticks;
    }
    const double rough = (high - low) / 5.0;
    const double unit = std::pow(10.0, std::floor(std::log10(rough)));
    const double step = unit * (rough / unit < 2.0 ? 2.0 : rough / unit < 5.0 ? 5.0 : 10.0);
    for (double t = std::ceil(low / step) * step; t <= high + 1e-9 * step; t += step)
      ticks.push_back(t);
    return ticks;
  }
};

Axis linear(std::string label, double low, double high) {
  return {low, std::max(high, low + 1e-6), false, std::move(label)};
}

// Whole decades around the values.
Axis decades(std::string label, double low, double high) {
  const double from = std::floor(std::log10(std::max(low, 1e-6)));
  const double to = std::max(std::ceil(std::log10(std::max(high, 1e-6))), from + 1.0);
  return {std::pow(10.0, from), std::pow(10.0, to), true, std::move(label)};
}

// One panel with its upper left corner at (x, y).
std::string panel(
    Point corner,
    const std::string& title,
    const Axis& xAxis,
    const Axis& yAxis,
    const std::vector<Curve>& curves) {
  const double left = corner.x + kLeft;
  const double top = corner.y + kTop;
  const double width = kPanelWidth - kLeft - kRight;
  const double height = kPanelHeight - kTop - kBottom;
  std::string svg = format(
      R"(<rect x="%.1f" y="%.1f" width="%.1f" height="%.1f" fill="none" stroke="#888"/>)"
      "\n",
      left,
      top,
      width,
      height);
  const auto text = [&](double x, double y, const char* anchor, const std::string& s) {
    svg += format(R"(<text x="%.1f" y="%.1f" text-anchor="%s">)", x, y, anchor) + escaped(s) +
           "</text>\n";
  };
  text(left, top - 8.0, "start", title);
  text(left + width / 2.0, top + height + 32.0, "middle", xAxis.label);
  svg += format(
             R"svg(<text transform="translate(%.1f,%.1f) rotate(-90)" text-anchor="middle">)svg",
             corner.x + 14.0,
             top + height / 2.0) +
         escaped(yAxis.label) + "</text>\n";
  const auto xOf = [&](double v) { return left + width * xAxis.at(v); };
  const auto yOf = [&](double v) { return top + height * (1.0 - yAxis.at(v)); };
  for (const double t : xAxis.ticks()) {
    svg += format(
        R"(<path d="M%.1f %.1fv4" stroke="#888"/>)"
        "\n",
        xOf(t),
        top + height);
    text(xOf(t), top + height + 16.0, "middle", format("%g", t));
  }
  for (const double t : yAxis.ticks()) {
    svg += format(
        R"(<path d="M%.1f %.1fh%.1f" stroke="#ddd"/>)"
        "\n",
        left,
        yOf(t),
        width);
    text(left - 5.0, yOf(t) + 4.0, "end", format("%g", t));
  }
  for (const Curve& curve : curves) {
    svg += R"(<polyline fill="none" stroke-width="1.2" stroke=")" + std::string(curve.color) +
           R"(" points=")";
    for (const Point& p : curve.points)
      svg += format("%.1f,%.1f ", xOf(p.x), yOf(std::clamp(p.y, yAxis.low, yAxis.high)));
    svg += "\"/>\n";
    if (!curve.hasDots) continue;
    for (const Point& p : curve.points) {
      svg += format(R"(<circle r="2.5" cx="%.1f" cy="%.1f" fill=")", xOf(p.x), yOf(p.y)) +
             std::string(curve.color) + "\"/>\n";
    }
  }
  return svg;
}

using Measure = std::function<double(const SweepFrame&)>;

std::vector<Curve> curvesOf(const SweepMesh& mesh, const Measure& measure) {
  std::vector<Curve> curves;
  for (const SweepSeries& series : mesh.series) {
    Curve curve{colorOf(series.method), false, {}};
    for (std::size_t i = 0; i < series.frames.size(); ++i)
      curve.points.push_back({static_cast<double>(i), measure(series.frames[i])});
    curves.push_back(std::move(curve));
  }
  return curves;
}

struct Range {
  double low = 1e300;
  double high = -1e300;
};

Range rangeOf(const std::vector<Curve>& curves) {
  Range range;
  for (const Curve& curve : curves) {
    for (const Point& p : curve.points) {
      range.low = std::min(range.low, p.y);
      range.high = std::max(range.high, p.y);
    }
  }
  return range;
}

std::string meshRow(const SweepMesh& mesh, double y) {
  std::size_t frames = 2;
  for (const SweepSeries& series : mesh.series)
    frames = std::max(frames, series.frames.size());
  const Axis frameAxis = linear("frame", 0.0, static_cast<double>(frames - 1));
  const std::string name = mesh.name + ", " + std::to_string(mesh.faces) + " faces: ";
  const auto times = curvesOf(mesh, [](const SweepFrame& f) { return f.ms; });
  const auto segments = curvesOf(mesh, [](const SweepFrame& f) { return f.segments; });
  const auto recalls = curvesOf(mesh, [](const SweepFrame& f) { return 100.0 * f.recall; });
  const Range time = rangeOf(times);
  const double lowest = std::min(std::floor(rangeOf(recalls).low / 10.0) * 10.0, 90.0);
  return panel({0.0, y}, name + "time", frameAxis, decades("ms", time.low, time.high), times) +
         panel(
             {kPanelWidth, y},
             name + "segments",
             frameAxis,
             linear("segments", 0.0, 1.05 * rangeOf(segments).high),
             segments) +
         panel(
             {2.0 * kPanelWidth, y},
             name + "recall",
             frameAxis,
             linear("% of what there is", lowest, 100.0),
             recalls);
}

// Median time against size, a curve a detector through the meshes.
std::string sizePanel(const std::vector<SweepMesh>& meshes, double y) {
  std::vector<Curve> curves;
  Range faces;
  for (const SweepMesh& mesh : meshes) {
    faces.low = std::min(faces.low, static_cast<double>(mesh.faces));
    faces.high = std::max(faces.high, static_cast<double>(mesh.faces));
  }
  for (const DetectorMethod method : allDetectors()) {
    Curve curve{colorOf(method), true, {}};
    for (const SweepMesh& mesh : meshes) {
      for (const SweepSeries& series : mesh.series) {
        if (series.method != method) continue;
        curve.points.push_back({static_cast<double>(mesh.faces), series.medianMs()});
      }
    }
    std::sort(curve.points.begin(), curve.points.end(), [](const Point& a, const Point& b) {
      return a.x < b.x;
    });
    if (!curve.points.empty()) curves.push_back(std::move(curve));
  }
  const Range time = rangeOf(curves);
  return panel(
      {0.0, y},
      "median time against size",
      decades("faces", faces.low, faces.high),
      decades("ms", time.low, time.high),
      curves);
}

}  // namespace

std::string sweepPlot(const std::vector<SweepMesh>& meshes) {
  const double width = 3.0 * kPanelWidth;
  const double height = kLegend + kPanelHeight * static_cast<double>(meshes.size() + 1);
  std::string svg = format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="%.0f" height="%.0f" viewBox="0 0 %.0f %.0f" font-family="sans-serif" font-size="11">)"
      "\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
      width,
      height,
      width,
      height);
  double x = 20.0;
  for (const DetectorMethod method : allDetectors()) {
    svg += format(R"(<path d="M%.1f 16h22" stroke-width="2.5" stroke="%s"/>)", x, colorOf(method)) +
           format(R"(<text x="%.1f" y="20">)", x + 27.0) + std::string(detectorName(method)) +
           "</text>\n";
    x += 120.0;
  }
  double y = kLegend;
  for (const SweepMesh& mesh : meshes) {
    svg += meshRow(mesh, y);
    y += kPanelHeight;
  }
  if (!meshes.empty()) svg += sizePanel(meshes, y);
  return svg + "</svg>\n";
}

}  // namespace limn
