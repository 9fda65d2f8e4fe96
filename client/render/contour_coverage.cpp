// SPDX-License-Identifier: Apache-2.0
//
// Scan conversion by lines, as many a pixel as sixteen: where contours overlap within a pixel only
// the winding number of each place says whether it is covered, so areas under edges do not do.
#include "client/render/contour_coverage.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace limn {
namespace {

/// Units of a pixel. Contours' points are odd multiples of 1/256 to 1/16 pixel, so in these units
/// they are never on a line, nor on one through pixels' middles.
constexpr int kUnit = 512;
constexpr int kLines = 16;  // a pixel
constexpr int kPitch = kUnit / kLines;
constexpr int kWhole = kUnit * kLines;

/// Lines at offset + i · pitch, 0 ≤ i < count.
struct Ruling {
  int offset;
  int pitch;
  int count;

  /// The first line above y.
  [[nodiscard]] std::uint32_t firstAbove(double y) const {
    return static_cast<std::uint32_t>(
        std::clamp(std::ceil((y - offset) / pitch), 0.0, 1.0 * count));
  }
};

}  // namespace

void ContourCoverage::findCrossings(const ClipContours& contours, const Viewport& size) {
  const Ruling fine{kPitch / 2, kPitch, kLines * size.height};
  const Ruling middles{kUnit / 2, kUnit, size.height};
  const double right = 1.0 * kUnit * size.width;
  // Each edge upwards, for either ruling; base: its first line's number.
  const auto eachEdge = [&](auto&& use) {
    for (std::size_t i = 0; i + 1 < contours.points.size(); ++i) {
      if (contours.points[i].z == 0.0F) continue;
      glm::dvec2 from = static_cast<double>(kUnit) * glm::dvec2(contours.points[i]);
      glm::dvec2 to = static_cast<double>(kUnit) * glm::dvec2(contours.points[i + 1]);
      if (from.y == to.y) continue;
      const bool up = to.y > from.y;
      if (!up) std::swap(from, to);
      std::uint32_t base = 0;
      for (const Ruling& ruling : {fine, middles}) {
        use(ruling, base, from, to, up ? 1 : 0);
        base += static_cast<std::uint32_t>(ruling.count);
      }
    }
  };
  const auto lines = static_cast<std::size_t>(fine.count + middles.count);
  // How many cross each line, by where that changes; then where each line begins.
  lineEnds_.assign(lines + 2, 0);
  eachEdge([&](const Ruling& ruling, std::uint32_t base, glm::dvec2 from, glm::dvec2 to, int) {
    ++lineEnds_[base + ruling.firstAbove(from.y)];
    --lineEnds_[base + ruling.firstAbove(to.y)];
  });
  std::uint32_t crossing = 0;
  std::uint32_t begin = 0;
  for (std::uint32_t& line : lineEnds_) {
    crossing += line;  // may wrap on the way, as the differences do
    line = begin;
    begin += crossing;
  }
  crossings_.resize(begin);
  // Filling moves each line's begin to its end.
  eachEdge([&](const Ruling& ruling, std::uint32_t base, glm::dvec2 from, glm::dvec2 to, int up) {
    const double slope = (to.x - from.x) / (to.y - from.y);
    const auto end = ruling.firstAbove(to.y);
    for (auto line = ruling.firstAbove(from.y); line < end; ++line) {
      const double y = ruling.offset + static_cast<double>(line) * ruling.pitch;
      const double x = std::clamp(from.x + (y - from.y) * slope, 0.0, right);
      crossings_[lineEnds_[base + line]++] = 2 * static_cast<int>(x) + up;
    }
  });
  for (std::size_t line = 0; line < lines; ++line) {
    const std::uint32_t first = line == 0 ? 0 : lineEnds_[line - 1];
    std::sort(crossings_.begin() + first, crossings_.begin() + lineEnds_[line]);
  }
}

/// Adds the parts of a line where contours wind around a positive number of times.
void ContourCoverage::addLine(std::uint32_t line) {
  int winding = 0;
  int from = 0;
  for (std::uint32_t i = line == 0 ? 0 : lineEnds_[line - 1]; i < lineEnds_[line]; ++i) {
    const int x = crossings_[i] >> 1;
    const int before = winding;
    winding += (crossings_[i] & 1) != 0 ? -1 : 1;
    if (before <= 0 && winding > 0) from = x;
    if (before <= 0 || winding > 0) continue;
    const int first = from / kUnit;
    const int last = x / kUnit;
    first_ = std::min(first_, first);
    last_ = std::max(last_, last);
    partial_[static_cast<std::size_t>(first)] -= from % kUnit;
    partial_[static_cast<std::size_t>(last)] += x % kUnit;
    ++full_[static_cast<std::size_t>(first)];
    --full_[static_cast<std::size_t>(last)];
  }
}

/// The same of the line through a row's middles.
void ContourCoverage::addMiddles(std::uint32_t line, int width) {
  int winding = 0;
  for (std::uint32_t i = lineEnds_[line - 1]; i < lineEnds_[line]; ++i) {
    const int before = winding;
    winding += (crossings_[i] & 1) != 0 ? -1 : 1;
    if ((before > 0) == (winding > 0)) continue;
    // The first middle to its right.
    const int pixel = std::min(width, ((crossings_[i] >> 1) + kUnit / 2) / kUnit);
    first_ = std::min(first_, pixel);
    last_ = std::max(last_, pixel);
    middle_[static_cast<std::size_t>(pixel)] += winding > 0 ? 1 : -1;
  }
}

void ContourCoverage::emitRow(std::uint16_t y, int width) {
  int lines = 0;
  int inside = 0;
  for (int x = first_; x <= last_; ++x) {
    const auto at = static_cast<std::size_t>(x);
    lines += full_[at];
    inside += middle_[at];
    const int covered = lines * kUnit + partial_[at];
    full_[at] = middle_[at] = partial_[at] = 0;
    if (covered == inside * kWhole || x >= width) continue;
    pixels_.push_back(
        {static_cast<std::uint16_t>(x),
         y,
         static_cast<std::uint8_t>((255 * covered + kWhole / 2) / kWhole)});
  }
}

std::span<const CoveredPixel> ContourCoverage::find(
    const ClipContours& contours,
    const Viewport& size) {
  findCrossings(contours, size);
  const auto wide = static_cast<std::size_t>(size.width) + 1;
  partial_.assign(wide, 0);
  full_.assign(wide, 0);
  middle_.assign(wide, 0);
  pixels_.clear();
  for (int y = 0; y < size.height; ++y) {
    first_ = size.width;
    last_ = -1;
    for (int k = 0; k < kLines; ++k)
      addLine(static_cast<std::uint32_t>(kLines * y + k));
    addMiddles(static_cast<std::uint32_t>(kLines * size.height + y), size.width);
    emitRow(static_cast<std::uint16_t>(y), size.width);
  }
  return pixels_;
}

}  // namespace limn
