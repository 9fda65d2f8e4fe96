// SPDX-License-Identifier: Apache-2.0
// Based on: P. Mohr, "Silhouette Rendering of Complex Shapes with Stylized Lines" (thesis), 2013,
// §3.4: the depth texture is asked at the spine and its eight neighbours, and the whole width of a
// stroke shares the answer.
// Deviations: of a silhouette only the neighbours on its outward side are asked, since those on the
// other see its own surface rise towards the eye; three of them must be free, since one or two are
// past the outline of a surface just before the line; concave silhouettes are hidden by rule; the
// bias follows the slope of the surface; answers are filtered along the spine.
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
  const SpineSet spines = projectLines(lines, scene);
  const SpineSamples samples = sampleSpines(spines, measureSpines(spines), lines, scene);
  // Unfiltered: the filter is for the eye, which wants no speckles; this answer is for those who
  // want to know.
  const std::vector<std::uint8_t> visibility = testSamples(samples.samples, depth);
  std::vector<float> sums(lines.points.size(), 0.0F);
  std::vector<std::uint32_t> counts(lines.points.size(), 0);
  for (std::size_t i = 0; i < visibility.size(); ++i) {
    const glm::vec2 p = samples.samples[i].position;
    const bool isInside = p.x >= 0.0F && p.x < 1.0F && p.y >= 0.0F && p.y < 1.0F;
    sums[samples.source[i]] += isInside && visibility[i] != 0 ? 1.0F : 0.0F;
    ++counts[samples.source[i]];
  }
  for (const PolylineSet::Line& line : lines.lines) {
    // A segment too short for a sample of its own shares its predecessor's answer.
    float known = 0.0F;
    std::uint32_t firstKnown = line.end;
    for (std::uint32_t k = 0; k < line.segmentCount(); ++k) {
      const std::uint32_t point = line.begin + k;
      if (counts[point] > 0) {
        known = sums[point] / static_cast<float>(counts[point]);
        firstKnown = std::min(firstKnown, point);
      }
      visible[point] = known > 0.5F ? 1 : 0;
    }
    for (std::uint32_t point = line.begin; point < firstKnown && firstKnown < line.end; ++point) {
      visible[point] = visible[firstKnown];
    }
  }
  return visible;
}

}  // namespace limn
