// SPDX-License-Identifier: Apache-2.0
// Based on: P. Mohr, "Silhouette Rendering of Complex Shapes with Stylized Lines" (thesis), 2013,
// §3.4: the depth texture is asked at the spine and its eight neighbours, and the whole width of a
// stroke shares the answer.
// Deviations: of a silhouette only the neighbours on its outward side are asked, since those on the
// other see its own surface rise towards the eye; two of them must be free, since a single one may
// be past the outline of a surface just before the line; the bias follows the slope of the surface.
// Between two places where a line's visibility can change (LineSpans) there is one answer.
#include "client/stroke/visibility/visibility.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace limn {
namespace {

/// Pixels around a place, not on its inward side, that hold no surface before the sample.
int freeAround(const SpineSample& sample, const glm::vec2& place, const DepthImage& depth) {
  const glm::ivec2 centre(glm::floor(place));
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
  return free;
}

}  // namespace

std::vector<std::uint8_t> testSamples(const SpineSamples& samples, const DepthImage& depth) {
  std::vector<std::uint8_t> visible(samples.samples.size(), 0);
  const glm::vec2 size(depth.width, depth.height);
  for (std::size_t i = 0; i < visible.size(); ++i) {
    const SpineSample& sample = samples.samples[i];
    if (sample.bias < 0.0F) continue;
    const int needed = static_cast<int>(std::abs(sample.neededFree));
    const glm::vec2 place = sample.position * size;
    bool isFree = freeAround(sample, place, depth) >= needed;
    if (!isFree && sample.neededFree < 0.0F)
      isFree =
          freeAround(sample, place + samples.farther * size.y * sample.outward, depth) >= needed;
    visible[i] = isFree ? 1 : 0;
  }
  return visible;
}

std::vector<std::uint8_t> voteInSpans(
    std::span<const SpineSample> samples,
    std::span<const std::uint8_t> tested) {
  std::vector<std::uint8_t> visible(samples.size(), 0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SpineSample& sample = samples[i];
    if (sample.bias < 0.0F) continue;
    const int first = static_cast<int>(sample.spanFirst);
    const int last = static_cast<int>(sample.spanLast);
    const bool isRing =
        sample.last < 0.0F && sample.spanFirst == sample.first && sample.spanLast == -sample.last;
    const int count = last - first + 1;
    int sum = 0;
    int weight = 0;
    for (int step = -kVoteRadius; step <= kVoteRadius; ++step) {
      int j = static_cast<int>(i) + step;
      if (isRing) {
        j = first + ((j - first) % count + count) % count;
      } else if (j < first || j > last) {
        continue;
      }
      sum += tested[static_cast<std::size_t>(j)];
      ++weight;
    }
    visible[i] = 2 * sum >= weight ? 1 : 0;
  }
  return visible;
}

std::vector<std::uint8_t> drawnSamples(
    std::span<const SpineSample> samples,
    std::span<const std::uint8_t> visible) {
  const auto isDrawn = [&](float index) {
    const auto i = static_cast<std::size_t>(index);
    const float outer = samples[i].nestedIn;
    return visible[i] != 0 && !(outer >= 0.0F && visible[static_cast<std::size_t>(outer)] != 0);
  };
  std::vector<std::uint8_t> drawn(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SpineSample& sample = samples[i];
    const bool is = sample.neededFree == kAsJoined
                        ? isDrawn(sample.spanFirst) && isDrawn(sample.spanLast)
                        : isDrawn(static_cast<float>(i));
    drawn[i] = is ? 1 : 0;
  }
  return drawn;
}

namespace {

/// Bits of a window, one a sample: gaps of up to `longest` between ones become ones. As many bits
/// at each end of the window are not to be used then.
std::uint32_t closeGaps(std::uint32_t bits, int longest) {
  std::uint32_t grown = bits;
  for (int i = 0; i < longest; ++i)
    grown |= grown << 1;
  std::uint32_t closed = grown;
  for (int i = 0; i < longest; ++i)
    closed &= closed >> 1;
  return closed | bits;
}

}  // namespace

int closedGap(float widthPx) {
  return std::clamp(static_cast<int>(std::lround(widthPx)), kShortRun, kLongestGap);
}

std::vector<float>
sampleVisibility(const SpineSamples& samples, const DepthImage& depth, int longestGap) {
  const std::vector<std::uint8_t> drawn =
      drawnSamples(samples.samples, voteInSpans(samples.samples, testSamples(samples, depth)));
  constexpr int kRamp = static_cast<int>(kRampSamples);
  const int middle = kRamp + longestGap + kShortRun;
  std::vector<float> shaped(drawn.size());
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const SpineSample& sample = samples.samples[i];
    const int first = static_cast<int>(sample.first);
    const int last = static_cast<int>(std::abs(sample.last));
    const int count = last - first + 1;
    std::uint32_t bits = 0;
    for (int k = 0; k <= 2 * middle; ++k) {
      int j = static_cast<int>(i) + k - middle;
      j = sample.last < 0.0F ? first + ((j - first) % count + count) % count
                             : std::clamp(j, first, last);
      bits |= std::uint32_t{drawn[static_cast<std::size_t>(j)]} << k;
    }
    bits = ~closeGaps(~closeGaps(bits, longestGap), kShortRun);
    const std::uint32_t here = (bits >> middle) & 1U;
    float distance = kRampSamples;
    for (int d = kRamp; d >= 1; --d) {
      if (((bits >> (middle + d)) & 1U) != here || ((bits >> (middle - d)) & 1U) != here)
        distance = static_cast<float>(d) - 0.5F;
    }
    const float away = 0.5F * distance / kRampSamples;
    shaped[i] = here != 0 ? 0.5F + away : 0.5F - away;
  }
  return shaped;
}

std::vector<std::uint8_t>
segmentVisibility(const PolylineSet& lines, const LineScene& scene, const DepthImage& depth) {
  std::vector<std::uint8_t> visible(lines.points.size(), 0);
  if (depth.width < 1 || depth.height < 1) return visible;
  const LineSpans spans = findSpans(lines, scene);
  const SpineSamples samples = sampleSegments(lines, spans, scene);
  const std::vector<std::uint8_t> found = voteInSpans(samples.samples, testSamples(samples, depth));
  for (std::size_t i = 0; i < found.size();) {
    const std::uint32_t point = samples.source[i];
    const std::size_t begin = i;
    while (i < found.size() && samples.source[i] == point)
      ++i;
    const std::size_t middle = begin + (i - begin) / 2;
    const glm::vec2 p = samples.samples[middle].position;
    const bool isInside = p.x >= 0.0F && p.x < 1.0F && p.y >= 0.0F && p.y < 1.0F;
    visible[point] = isInside ? found[middle] : 0;
  }
  return visible;
}

}  // namespace limn
