// SPDX-License-Identifier: Apache-2.0
// Based on: P. Mohr, "Silhouette Rendering of Complex Shapes with Stylized Lines" (thesis), 2013,
// §3.4: the depth texture is asked at the spine and its eight neighbours, and the whole width of a
// stroke shares the answer.
// Deviations: of a silhouette only the neighbours on its outward side are asked, since those on the
// other see its own surface rise towards the eye; two of them must be free, since a single one may
// be past the outline of a surface just before the line; concave silhouettes are hidden by rule;
// the bias follows the slope of the surface; answers are filtered along the spine.
#include "client/stroke/visibility.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace limn {

std::vector<std::uint8_t> testSamples(
    std::span<const SpineSample> samples,
    const DepthImage& depth) {
  std::vector<std::uint8_t> visible(samples.size(), 0);
  const glm::vec2 size(depth.width, depth.height);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SpineSample& sample = samples[i];
    if (sample.bias < 0.0F) continue;
    const glm::ivec2 centre(glm::floor(sample.position * size));
    int free = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const glm::vec2 aside(static_cast<float>(dx), static_cast<float>(dy));
        if (glm::dot(aside, sample.outward) < -0.1F) continue;
        const int x = std::clamp(centre.x + dx, 0, depth.width - 1);
        const int y = std::clamp(centre.y + dy, 0, depth.height - 1);
        if (depth.at(x, y) >= sample.depth - sample.bias) ++free;
      }
    }
    visible[i] = free >= kFreeNeighbours ? 1 : 0;
  }
  return visible;
}

std::vector<float> sampleVisibility(const SpineSamples& samples, const DepthImage& depth) {
  const std::vector<std::uint8_t> raw = testSamples(samples.samples, depth);
  std::vector<float> filtered(raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const SpineSample& sample = samples.samples[i];
    const int first = static_cast<int>(sample.first);
    const int last = static_cast<int>(std::abs(sample.last));
    const bool closed = sample.last < 0.0F;
    const int count = last - first + 1;
    int sum = 0;
    int weight = 0;
    for (int step = -kVisibilityFilterRadius; step <= kVisibilityFilterRadius; ++step) {
      int j = static_cast<int>(i) + step;
      if (closed) {
        j = first + ((j - first) % count + count) % count;
      } else if (j < first || j > last) {
        continue;
      }
      sum += raw[static_cast<std::size_t>(j)];
      ++weight;
    }
    filtered[i] = static_cast<float>(sum) / static_cast<float>(weight);
  }
  return filtered;
}

std::vector<std::uint8_t>
segmentVisibility(const PolylineSet& lines, const LineScene& scene, const DepthImage& depth) {
  std::vector<std::uint8_t> visible(lines.points.size(), 0);
  if (depth.width < 1 || depth.height < 1) return visible;
  // Every segment is asked for itself, however short: neighbours on a dense mesh face differently.
  // Unfiltered, too: the filter is for the eye, which wants no speckles.
  const SpineSamples samples = sampleSegments(lines, scene);
  const std::vector<std::uint8_t> found = testSamples(samples.samples, depth);
  for (std::size_t i = 0; i < found.size();) {
    const std::uint32_t point = samples.source[i];
    std::uint32_t count = 0;
    std::uint32_t seen = 0;
    for (; i < found.size() && samples.source[i] == point; ++i) {
      const glm::vec2 p = samples.samples[i].position;
      const bool isInside = p.x >= 0.0F && p.x < 1.0F && p.y >= 0.0F && p.y < 1.0F;
      seen += isInside ? found[i] : 0U;
      ++count;
    }
    visible[point] = 2 * seen > count ? 1 : 0;
  }
  return visible;
}

}  // namespace limn
