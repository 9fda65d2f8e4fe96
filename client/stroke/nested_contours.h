// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/line_fade.h"
#include "client/stroke/visibility/spine_samples.h"

#include "shared/core/camera.h"
#include "shared/core/ids.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Nested contours run beside one another within a stroke's width, the surface of each on the same
/// side: a fold just before another's outline. Drawn both, they are one line too thick; the outer
/// one is what the eye sees the shape by. Keeps its memory from frame to frame.
/// Threads: one caller at a time.
class NestedContours {
 public:
  /// Sets SpineSample::nestedIn where samples are nested in a contour that fades no more than they
  /// do. widthPx: of an ordinary stroke; fades: of the samples' spines. What is nested in a contour
  /// that is nested itself stays, so that of many beside one another only the second goes; what is
  /// nested for a little only stays as well. Samples are taken for a pixel apart. Cost: O(samples),
  /// for strokes a few pixels wide.
  void find(
      const Viewport& viewport,
      float widthPx,
      std::span<const LineFade> fades,
      SpineSamples& samples);

 private:
  /// Samples of a contour that are not hidden for sure.
  struct Place {
    glm::vec2 pixel{0.0F};
    glm::vec2 outward{0.0F};
    float fade = 1.0F;
    std::uint32_t stretch = 0;   // of a line, with one place after another
    std::uint32_t sample = 0;    // the first
    std::uint32_t next = kNone;  // in the same cell
  };

  /// Most cells have places of one part of one contour: nothing is nested there.
  struct Cell {
    std::uint32_t first = kNone;  // of places_
    bool hasOthers = false;
  };

  void begin(const Viewport& viewport, float reachPx);
  void add(const glm::vec2& pixel, const glm::vec2& outward, std::uint32_t sample, bool goesOn);
  [[nodiscard]] std::uint32_t outside(std::uint32_t index) const;
  [[nodiscard]] bool isOwn(std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] glm::ivec2 cellOf(const glm::vec2& pixel) const;
  void evenOut();

  float reachPx_ = 0.0F;
  std::uint32_t ownPlaces_ = 0;
  glm::ivec2 size_{0};       // cells
  std::vector<Cell> cells_;  // row after row
  std::vector<Place> places_;
  std::vector<std::uint32_t> outer_;  // by place: the one that it is nested in
  std::vector<std::uint8_t> isNested_;
};

}  // namespace limn
