// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/line_scene.h"
#include "client/stroke/spine.h"
#include "client/stroke/visibility/line_spans.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

/// How many of the depth image's pixels around a sample must hold no surface before it, and how
/// many where its span is doubtful (LineSpans), of the five to nine that are asked.
inline constexpr float kFreeNeighbours = 2.0F;
inline constexpr float kDoubtfulNeighbours = 4.0F;

/// Instead of these, of a bridge's sample: it is as visible as the lines that it joins are a little
/// before it, whose samples there are its spanFirst and spanLast.
inline constexpr float kAsJoined = 0.0F;

/// Where a smooth silhouette's mesh stands out farther than the line's own face does, by noise, and
/// no other line is there to be its outline (LineSpans::isNearest), it is looked for as far as
/// this.
inline constexpr float kFartherPx = 0.8F;

/// One place on a spine where visibility is asked for. Twelve floats, read by the visibility
/// shaders as three RGBA32F texels in this order.
struct SpineSample {
  /// Of the exact line, or of its mesh's outline beside it (SegmentFacts::standOutPx), as a
  /// fraction of the picture, from the top left.
  glm::vec2 position{0.0F};
  float depth = 0.0F;  // window depth of the line there
  float bias = 0.0F;   // how much nearer a surface must be to hide it; < 0: hidden for sure
  /// Unit vector in the picture (y down) away from the surface that ends at a silhouette; 0 for
  /// lines with surface on both sides.
  glm::vec2 outward{0.0F};
  float first = 0.0F;  // index of the spine's first sample
  /// Index of its last one; negated when the spine is closed (a copy of the first follows it then).
  float last = 0.0F;
  /// Indices of the first and last sample around this one that are visible or hidden with it: of a
  /// closed spine first … |last| where that goes round.
  float spanFirst = 0.0F;
  float spanLast = 0.0F;
  /// Negated: where as many are not free, it is asked once more SpineSamples::farther outwards.
  float neededFree = kFreeNeighbours;
  /// Index of the sample of another contour just outside: where that is visible, this one is not
  /// drawn (NestedContours); < 0: none.
  float nestedIn = -1.0F;
};

static_assert(sizeof(SpineSample) == 12 * sizeof(float));

struct SpineSamples {
  std::vector<SpineSample> samples;
  std::vector<std::uint32_t> source;  // parallel: the PolylineSet point whose segment it is on
  /// Parallel to SpineSet::spines: the sample coordinate at distance `arc` along spine s is
  /// begin[s] + perPx[s] · arc.
  std::vector<std::uint32_t> begin;
  std::vector<float> perPx;
  float farther = 0.0F;  // kFartherPx as a fraction of the picture's height
};

struct SampleOptions {
  float spacingPx = 1.0F;               // along the line
  std::uint32_t maxSamples = 1U << 20;  // spacing grows to stay below
};

/// Places samples along every spine, with what the mesh says about the visibility of each: what
/// hides it for sure, how far it must agree with its neighbours (spans, of the same lines), and how
/// much its own surface may rise above it. Cost: O(points + samples).
[[nodiscard]] SpineSamples sampleSpines(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const LineSpans& spans,
    const Viewport& viewport,
    const SampleOptions& options = {});

/// The same into `out`, whose memory is used again.
void sampleSpines(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const LineSpans& spans,
    const Viewport& viewport,
    const SampleOptions& options,
    SpineSamples& out);

/// Samples on every segment by itself, a pixel apart, an odd number, so that one is in its middle:
/// those of one segment follow one another. No spines to filter along. Cost: as sampleSpines().
[[nodiscard]] SpineSamples
sampleSegments(const PolylineSet& lines, const LineSpans& spans, const LineScene& scene);

}  // namespace limn
