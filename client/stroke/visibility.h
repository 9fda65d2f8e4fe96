// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/depth_image.h"
#include "client/stroke/line_scene.h"
#include "client/stroke/polyline.h"
#include "client/stroke/spine_samples.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Samples on each side that the filter along a spine averages. A run of up to this many samples
/// that differs from its surroundings is a speckle of the depth image and goes (it never reaches
/// half the window); the place where a long run ends stays where it is.
inline constexpr int kVisibilityFilterRadius = 5;

/// Visibility of every sample, 0 … 1: the 8-neighbourhood test [Mohr13 §3.4] and then the filter
/// along the spine. ½ is where a line goes behind something. The CPU's counterpart and oracle of
/// the renderer's visibility shaders; the same operations on the same numbers.
/// depth: the mesh seen through the same camera, of any size with that aspect.
[[nodiscard]] std::vector<float> sampleVisibility(
    const SpineSamples& samples,
    const DepthImage& depth);

/// How many of the depth image's pixels around a sample must hold no surface before it.
inline constexpr int kFreeNeighbours = 2;

/// The test alone: 1 visible, 0 hidden. A pixel is free when it holds no surface nearer than the
/// line by more than its bias; a sample is visible when kFreeNeighbours of the nine pixels at and
/// around it are (of a silhouette: of those on its outward side). Threads: reentrant.
[[nodiscard]] std::vector<std::uint8_t> testSamples(
    std::span<const SpineSample> samples,
    const DepthImage& depth);

/// Per-segment visibility, by the test alone: one entry a point, 1 if most of the segment that
/// starts there is visible (0 for the last point of an open line, and for segments outside the
/// picture). depth: see sampleVisibility (Frame::depth). Cost: O(length in pixels).
[[nodiscard]] std::vector<std::uint8_t>
segmentVisibility(const PolylineSet& lines, const LineScene& scene, const DepthImage& depth);

}  // namespace limn
