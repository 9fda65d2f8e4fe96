// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/clip_contours.h"

#include "shared/core/camera.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// A pixel that an outline covers partly, from the bottom left.
struct CoveredPixel {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  std::uint8_t coverage = 0;  // of 255
};

/// How much of each pixel lies where contours wind around a positive number of times, which is
/// what an outline covers. Keeps its working memory. Threads: one caller at a time.
class ContourCoverage {
 public:
  /// Pixels of a picture of that size that are covered otherwise than the winding number of their
  /// middle says. Sixteen lines a pixel, along each of them exact. Valid until the next call.
  /// Cost: O(rows crossed + pixels from each row's first contour to its last), some ms a frame.
  [[nodiscard]] std::span<const CoveredPixel> find(
      const ClipContours& contours,
      const Viewport& size);

 private:
  /// Where a contour crosses a line, 1/512 pixels: 2 x + (1 if upwards), so that sorting is plain.
  using Crossing = std::int32_t;

  void findCrossings(const ClipContours& contours, const Viewport& size);
  void addLine(std::uint32_t line);
  void addMiddles(std::uint32_t line, int width);
  void emitRow(std::uint16_t y, int width);

  std::vector<std::uint32_t> lineEnds_;  // by line: past its last crossing
  std::vector<Crossing> crossings_;      // by line
  // Of one row, by pixel; zeros between rows. Coverage is in 1/512 of a pixel of one line.
  std::vector<std::int32_t> partial_;
  std::vector<std::int32_t> full_;    // by how much the number of lines that cover all of it grows
  std::vector<std::int32_t> middle_;  // by how much its middle's insideness grows
  int first_ = 0;                     // the pixels that have anything
  int last_ = -1;
  std::vector<CoveredPixel> pixels_;
};

}  // namespace limn
