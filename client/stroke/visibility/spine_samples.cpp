// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/visibility/spine_samples.h"

#include "client/stroke/clip_segment.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

float fartherIn(const Viewport& viewport) {
  return kFartherPx / static_cast<float>(viewport.height);
}

/// Adds what its span, and its segment, say about a sample.
void applySpan(
    const LineSpans& spans,
    std::uint32_t span,
    std::uint32_t point,
    SpineSample& sample) {
  const LineSpans::State state = spans.states[span];
  if (state == LineSpans::State::kHidden) sample.bias = -1.0F;
  if (state == LineSpans::State::kDoubtful) sample.neededFree = kDoubtfulNeighbours;
  if (spans.isNearest[point] != 0) sample.neededFree = -sample.neededFree;
}

/// Adds the samples of a bridge. The spines that it joins have theirs.
void sampleBridge(
    const SpineSet& spines,
    const SpineArcs& arcs,
    std::size_t index,
    std::uint32_t steps,
    const glm::vec2& toFraction,
    SpineSamples& out) {
  const SpineSet::Spine& spine = spines.spines[index];
  const auto sampleBefore = [&](const SpineSet::Spine::Joint& joint) {
    const float along = out.perPx[joint.spine] * arcBefore(spines, arcs, joint);
    return std::round(static_cast<float>(out.begin[joint.spine]) + along);
  };
  SpineSample sample;
  sample.neededFree = kAsJoined;
  sample.first = static_cast<float>(out.samples.size());
  sample.last = sample.first + static_cast<float>(steps);
  sample.spanFirst = sampleBefore(spine.joints[0]);
  sample.spanLast = sampleBefore(spine.joints[1]);
  std::uint32_t point = spine.begin;
  for (std::uint32_t i = 0; i <= steps; ++i) {
    const float arc = arcs.length[index] * static_cast<float>(i) / static_cast<float>(steps);
    while (point + 2 < spine.end && arcs.arc[point + 1] < arc)
      ++point;
    const float extent = arcs.arc[point + 1] - arcs.arc[point];
    const float t = extent > 0.0F ? (arc - arcs.arc[point]) / extent : 0.0F;
    sample.position = glm::mix(spines.exact[point], spines.exact[point + 1], t) * toFraction;
    out.samples.push_back(sample);
    out.source.push_back(spines.source[point]);
  }
}

/// Tells samples first … end − 1 that they belong together.
void bindSamples(std::size_t first, std::size_t end, SpineSamples& out) {
  for (std::size_t i = first; i < end; ++i) {
    out.samples[i].spanFirst = static_cast<float>(first);
    out.samples[i].spanLast = static_cast<float>(end - 1);
  }
}

}  // namespace

SpineSamples sampleSpines(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const LineSpans& spans,
    const Viewport& viewport,
    const SampleOptions& options) {
  SpineSamples out;
  sampleSpines(spines, arcs, spans, viewport, options, out);
  return out;
}

void sampleSpines(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const LineSpans& spans,
    const Viewport& viewport,
    const SampleOptions& options,
    SpineSamples& out) {
  double total = 0.0;
  for (const float length : arcs.length)
    total += length;
  // Each spine takes up to two more samples than its length asks for.
  const double room = std::max<double>(
      static_cast<double>(options.maxSamples) - 2.0 * static_cast<double>(spines.spines.size()),
      1.0);
  const double spacing = std::max<double>(options.spacingPx, total / room);

  const glm::vec2 toFraction(1.0F / viewport.width, 1.0F / viewport.height);
  out.farther = fartherIn(viewport);
  out.samples.clear();
  out.source.clear();
  out.begin.clear();
  out.perPx.clear();
  out.samples.reserve(static_cast<std::size_t>(total / spacing) + 2 * spines.spines.size());
  for (std::size_t index = 0; index < spines.spines.size(); ++index) {
    const SpineSet::Spine& spine = spines.spines[index];
    const float length = arcs.length[index];
    const auto steps = static_cast<std::uint32_t>(std::max(1.0, std::ceil(length / spacing)));
    // A sample at both ends. A closed spine's last one is its first again, outside the range that
    // the filter goes round, so that looking up between neighbours needs no wrapping.
    const std::uint32_t count = steps + 1;
    const auto first = static_cast<std::uint32_t>(out.samples.size());
    const auto last = static_cast<float>(spine.closed ? first + steps - 1 : first + steps);
    out.begin.push_back(first);
    out.perPx.push_back(length > 0.0F ? static_cast<float>(steps) / length : 0.0F);
    if (spine.isBridge()) {
      sampleBridge(spines, arcs, index, steps, toFraction, out);
      continue;
    }

    std::uint32_t segment = 0;    // from point begin + segment
    std::uint32_t known = kNone;  // the point that facts are of
    SegmentFacts facts;
    glm::vec2 outward(0.0F);
    std::uint32_t spanFirst = first;
    std::uint32_t span = kNone;
    const std::uint32_t lastSegment = spine.size() - (spine.closed ? 1 : 2);
    for (std::uint32_t i = 0; i < count; ++i) {
      const float arc = length * static_cast<float>(i) / static_cast<float>(steps);
      while (segment < lastSegment && arcs.arc[spine.begin + segment + 1] < arc)
        ++segment;
      const std::uint32_t from = spine.begin + segment;
      const std::uint32_t to = from + 1 < spine.end ? from + 1 : spine.begin;
      const float toArc = from + 1 < spine.end ? arcs.arc[to] : length;
      const float extent = toArc - arcs.arc[from];
      const float t =
          extent > 0.0F ? std::clamp((arc - arcs.arc[from]) / extent, 0.0F, 1.0F) : 0.0F;

      const std::uint32_t source = spines.source[from];
      const std::uint32_t before = span;
      span = spans.spanAt(source, t);
      if (source != known) {
        known = source;
        facts = spans.facts[source];
        const glm::vec2 along = spines.exact[to] - spines.exact[from];
        const float size = glm::length(along);
        outward =
            size > 1e-6F ? glm::vec2(-along.y, along.x) * (facts.openSide / size) : glm::vec2(0.0F);
      }
      // Where it stays: a copy would wait for its parts to be written.
      SpineSample& sample = out.samples.emplace_back();
      const glm::vec2 place = glm::mix(spines.exact[from], spines.exact[to], t);
      sample.position = (place + facts.standOutPx * outward) * toFraction;
      sample.depth = glm::mix(spines.depth[from], spines.depth[to], t);
      sample.bias = facts.bias;
      sample.outward = outward;
      sample.first = static_cast<float>(first);
      sample.last = spine.closed ? -last : last;
      applySpan(spans, span, source, sample);
      if (i > 0 && span != before) {
        bindSamples(spanFirst, first + i, out);
        spanFirst = first + i;
      }
      out.source.push_back(source);
    }
    bindSamples(spanFirst, first + count, out);
    if (spine.closed && spanFirst == first) {
      for (std::uint32_t i = first; i < first + count; ++i)
        out.samples[i].spanLast = last;
    }
  }
}

SpineSamples
sampleSegments(const PolylineSet& lines, const LineSpans& spans, const LineScene& scene) {
  const glm::dmat4 toClip = clipFromGrid(scene);
  const glm::dvec2 size(scene.viewport.width, scene.viewport.height);
  SpineSamples out;
  out.farther = fartherIn(scene.viewport);
  std::size_t spanFirst = 0;
  std::uint32_t last = kNone;  // span
  for (const PolylineSet::Line& line : lines.lines) {
    for (std::uint32_t k = 0; k < line.segmentCount(); ++k) {
      const std::uint32_t point = line.begin + k;
      const std::uint32_t next = point + 1 < line.end ? point + 1 : line.begin;
      const glm::dvec4 a = toClip * glm::dvec4(lines.points[point], 1.0);
      const glm::dvec4 b = toClip * glm::dvec4(lines.points[next], 1.0);
      const ClipSpan span = clipSegment(a, b);
      if (span.empty()) continue;
      const glm::dvec3 from = pixelFromClip(a + span.begin * (b - a), scene.viewport);
      const glm::dvec3 to = pixelFromClip(a + span.end * (b - a), scene.viewport);
      const glm::dvec2 along(to - from);
      const double length = glm::length(along);
      const SegmentFacts& facts = spans.facts[point];
      SpineSample sample;
      if (length > 1e-6)
        sample.outward = glm::vec2(
            glm::dvec2(-along.y, along.x) * (static_cast<double>(facts.openSide) / length));
      // An odd number, so that one is in the middle.
      const std::uint32_t count = 2 * static_cast<std::uint32_t>(0.5 * std::ceil(length)) + 1;
      for (std::uint32_t i = 0; i < count; ++i) {
        const double t = (i + 0.5) / count;
        const glm::dvec2 outwards =
            static_cast<double>(facts.standOutPx) * glm::dvec2(sample.outward);
        sample.position = glm::vec2((glm::dvec2(from) + t * along + outwards) / size);
        sample.depth = static_cast<float>(glm::mix(from.z, to.z, t));
        sample.bias = facts.bias;
        sample.neededFree = kFreeNeighbours;
        const std::uint32_t at = spans.spanAt(point, static_cast<float>(t));
        applySpan(spans, at, point, sample);
        if (at != last) bindSamples(spanFirst, out.samples.size(), out);
        if (at != last) spanFirst = out.samples.size();
        last = at;
        out.samples.push_back(sample);
        out.source.push_back(point);
      }
    }
  }
  bindSamples(spanFirst, out.samples.size(), out);
  return out;
}

}  // namespace limn
