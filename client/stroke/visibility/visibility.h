// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/line_scene.h"
#include "client/stroke/visibility/depth_image.h"
#include "client/stroke/visibility/spine_samples.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Samples on each side, of its own span, that a sample's answer is the majority of: a run of up to
/// this many that differs from the rest of its span is a speckle of the depth image and goes.
inline constexpr int kVoteRadius = 5;

/// Gaps of up to so many samples at least between visible parts of a line are closed, then visible
/// parts as short go: neither can be told from what is right, and strokes do not flicker.
inline constexpr int kShortRun = 2;

/// The longest gap that may be closed, in samples: what the shaders look over at once.
inline constexpr int kLongestGap = 8;

/// Gaps, in samples a pixel apart, that are closed where lines are drawn as strokes: what hides a
/// line for less than a stroke's width lies under its own outline's ink, and a break there is one
/// of the drawing, not of the model.
[[nodiscard]] int closedGap(float widthPx);

/// Distance from a place where a line goes hidden, in samples, over which visibility climbs from ½
/// to 1.
inline constexpr float kRampSamples = 5.5F;

/// Visibility of every sample, 0 … 1: the 8-neighbourhood test [Mohr13 §3.4], the majority in its
/// span, what of that is drawn, and short runs left out; then how far the place is from a change,
/// which lies at ½. The CPU's counterpart and oracle of the renderer's visibility shaders; the same
/// operations on the same numbers.
/// depth: the mesh seen through the same camera, of any size with that aspect.
/// longestGap: gaps of so many samples are closed, kShortRun … kLongestGap.
[[nodiscard]] std::vector<float>
sampleVisibility(const SpineSamples& samples, const DepthImage& depth, int longestGap = kShortRun);

/// The test alone: 1 visible, 0 hidden. A pixel is free when it holds no surface nearer than the
/// line by more than its bias; a sample is visible when as many as it needs of the nine pixels at
/// and around it are (of a silhouette: of those on its outward side). Threads: reentrant.
[[nodiscard]] std::vector<std::uint8_t> testSamples(
    const SpineSamples& samples,
    const DepthImage& depth);

/// The majority of what was tested (of testSamples), sample by sample.
[[nodiscard]] std::vector<std::uint8_t> voteInSpans(
    std::span<const SpineSample> samples,
    std::span<const std::uint8_t> tested);

/// What is drawn of visible samples (of voteInSpans): those of a nested contour where the outer one
/// is not visible (SpineSample::nestedIn), those of a bridge where both lines that it joins are
/// drawn (kAsJoined).
[[nodiscard]] std::vector<std::uint8_t> drawnSamples(
    std::span<const SpineSample> samples,
    std::span<const std::uint8_t> visible);

/// Per-segment visibility: one entry a point, 1 if the middle of the segment that starts there is
/// visible by the majority in its span (0 for the last point of an open line, and for segments
/// outside the picture). depth: see sampleVisibility (Frame::depth). Cost: O(length in pixels).
[[nodiscard]] std::vector<std::uint8_t>
segmentVisibility(const PolylineSet& lines, const LineScene& scene, const DepthImage& depth);

}  // namespace limn
