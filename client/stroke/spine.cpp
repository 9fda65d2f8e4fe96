// SPDX-License-Identifier: Apache-2.0
// Based on: Y.-D. Liang, B. A. Barsky, "A New Concept and Method for Line Clipping", ACM TOG 3(1),
// 1984, for cutting a segment by planes in homogeneous coordinates.
#include "client/stroke/spine.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limn {
namespace {

/// Points nearer than this in the picture are one point: nothing shorter can be seen.
constexpr float kMergePx = 0.05F;

struct Span {
  double begin = 0.0;
  double end = 1.0;

  [[nodiscard]] bool empty() const { return begin >= end; }
};

/// The part of a → b inside the near plane and the picture with its margin, in clip space.
Span clipSegment(const glm::dvec4& a, const glm::dvec4& b) {
  const double wide = 1.0 + 2.0 * kSpineMargin;
  // Signed distances to: near plane; left, right, bottom, top.
  const auto distances = [wide](const glm::dvec4& p) {
    return std::array<double, 5>{
        p.z + p.w,
        wide * p.w + p.x,
        wide * p.w - p.x,
        wide * p.w + p.y,
        wide * p.w - p.y};
  };
  const auto from = distances(a);
  const auto to = distances(b);
  Span span;
  for (std::size_t plane = 0; plane < from.size(); ++plane) {
    if (from[plane] < 0.0 && to[plane] < 0.0) return {1.0, 0.0};
    if (from[plane] >= 0.0 && to[plane] >= 0.0) continue;
    const double t = from[plane] / (from[plane] - to[plane]);
    if (from[plane] < 0.0) {
      span.begin = std::max(span.begin, t);
    } else {
      span.end = std::min(span.end, t);
    }
  }
  return span;
}

/// Builds the spines of one line at a time.
class SpineBuilder {
 public:
  SpineBuilder(const Viewport& viewport, SpineSet& out) : viewport_(viewport), out_(out) {}

  void begin(LineKind kind, std::uint32_t line, bool isFree) {
    current_ = {};
    current_.kind = kind;
    current_.line = line;
    current_.freeStart = isFree;
    current_.begin = static_cast<std::uint32_t>(out_.points.size());
    open_ = true;
  }

  void add(const glm::dvec4& clip, std::uint32_t source) {
    const glm::dvec3 pixel = pixelFromClip(clip, viewport_);
    const glm::vec2 point(pixel);
    if (out_.points.size() > current_.begin &&
        glm::distance(out_.points.back(), point) < kMergePx) {
      // The next segment starts here, so it is its source that counts.
      out_.source.back() = source;
      return;
    }
    out_.points.push_back(point);
    out_.depth.push_back(static_cast<float>(pixel.z));
    out_.source.push_back(source);
  }

  void finish(bool closed, bool isFree) {
    if (!open_) return;
    open_ = false;
    current_.end = static_cast<std::uint32_t>(out_.points.size());
    current_.closed = closed;
    current_.freeEnd = isFree;
    if (closed && current_.size() > 1 &&
        glm::distance(out_.points.back(), out_.points[current_.begin]) < kMergePx) {
      drop(current_.end - 1);
      --current_.end;
    }
    if (closed && current_.size() < 3) current_.closed = false;
    if (current_.size() < 2) {
      drop(current_.begin);
      return;
    }
    out_.spines.push_back(current_);
  }

  [[nodiscard]] bool isOpen() const { return open_; }

 private:
  void drop(std::uint32_t size) {
    out_.points.resize(size);
    out_.depth.resize(size);
    out_.source.resize(size);
  }

  Viewport viewport_;
  SpineSet& out_;
  SpineSet::Spine current_;
  bool open_ = false;
};

}  // namespace

SpineSet projectLines(const PolylineSet& lines, const LineScene& scene) {
  const glm::dmat4 clipFromWorld = scene.camera.clipFromWorld(scene.viewport.aspect());
  glm::dmat4 clipFromGrid = clipFromWorld * scene.grid.step;
  clipFromGrid[3] = clipFromWorld * glm::dvec4(scene.grid.origin, 1.0);

  SpineSet out;
  out.points.reserve(lines.points.size());
  out.depth.reserve(lines.points.size());
  out.source.reserve(lines.points.size());
  SpineBuilder builder(scene.viewport, out);
  std::vector<glm::dvec4> clip;
  std::vector<Span> spans;
  for (std::uint32_t index = 0; index < lines.lines.size(); ++index) {
    const PolylineSet::Line& line = lines.lines[index];
    const std::uint32_t count = line.end - line.begin;
    if (count < 2) continue;
    clip.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      clip[i] = clipFromGrid * glm::dvec4(lines.points[line.begin + i], 1.0);
    }
    const std::uint32_t segments = line.segmentCount();
    spans.resize(segments);
    std::uint32_t first = 0;
    bool isCut = false;
    for (std::uint32_t i = 0; i < segments; ++i) {
      spans[i] = clipSegment(clip[i], clip[(i + 1) % count]);
      // A cut loop is walked from where it comes into the picture, so that no piece is split at
      // the loop's arbitrary start.
      if (line.closed && (spans[i].begin > 0.0 || spans[i].empty()) && !isCut) {
        first = i;
        isCut = true;
      }
      if (line.closed && spans[i].end < 1.0 && !isCut) {
        first = (i + 1) % segments;
        isCut = true;
      }
    }
    for (std::uint32_t k = 0; k < segments; ++k) {
      const std::uint32_t i = (first + k) % segments;
      const Span& span = spans[i];
      const std::uint32_t source = line.begin + i;
      if (span.empty()) {
        builder.finish(false, false);
        continue;
      }
      const glm::dvec4& a = clip[i];
      const glm::dvec4& b = clip[(i + 1) % count];
      if (span.begin > 0.0) builder.finish(false, false);
      if (!builder.isOpen()) builder.begin(line.kind, index, span.begin == 0.0 && !isCut && k == 0);
      builder.add(a + span.begin * (b - a), source);
      const bool isLast = k + 1 == segments;
      if (span.end < 1.0) {
        builder.add(a + span.end * (b - a), source);
        builder.finish(false, false);
      } else if (isLast) {
        const bool closed = line.closed && !isCut;
        if (!closed) builder.add(b, source);
        builder.finish(closed, !isCut);
      }
    }
  }
  out.exact = out.points;
  return out;
}

void smoothSpines(float sigmaPx, SpineSet& spines) {
  if (!(sigmaPx > 0.0F)) return;
  const std::vector<glm::vec2> before = spines.points;
  const float reach = 2.5F * sigmaPx;
  for (const SpineSet::Spine& spine : spines.spines) {
    const std::uint32_t count = spine.size();
    const auto at = [&](std::uint32_t i) { return before[spine.begin + i % count]; };
    // Length of line that a point stands for, so that uneven spacing does not pull.
    const auto share = [&](std::uint32_t i) {
      const bool hasPrev = spine.closed || i > 0;
      const bool hasNext = spine.closed || i + 1 < count;
      const float prev = hasPrev ? glm::distance(at(i + count - 1), at(i)) : 0.0F;
      const float next = hasNext ? glm::distance(at(i), at(i + 1)) : 0.0F;
      return 0.5F * (std::min(prev, reach) + std::min(next, reach));
    };
    const std::uint32_t firstMoving = spine.closed ? 0 : 1;
    const std::uint32_t lastMoving = spine.closed ? count : count - 1;
    for (std::uint32_t i = firstMoving; i < lastMoving; ++i) {
      glm::vec2 sum = share(i) * at(i);
      float weight = share(i);
      // The window is cut to what both sides have, else the ends of a line would draw in.
      float away[2] = {0.0F, 0.0F};
      std::uint32_t back = i;
      std::uint32_t forth = i;
      for (std::uint32_t step = 1; step < count / 2 + 1; ++step) {
        if (!spine.closed && (back == 0 || forth + 1 >= count)) break;
        const std::uint32_t newBack = (back + count - 1) % count;
        const std::uint32_t newForth = (forth + 1) % count;
        away[0] += glm::distance(at(back), at(newBack));
        away[1] += glm::distance(at(forth), at(newForth));
        back = newBack;
        forth = newForth;
        if (away[0] > reach || away[1] > reach) break;
        const float backWeight =
            share(back) * std::exp(-away[0] * away[0] / (2.0F * sigmaPx * sigmaPx));
        const float forthWeight =
            share(forth) * std::exp(-away[1] * away[1] / (2.0F * sigmaPx * sigmaPx));
        sum += backWeight * at(back) + forthWeight * at(forth);
        weight += backWeight + forthWeight;
      }
      if (weight > 0.0F) spines.points[spine.begin + i] = sum / weight;
    }
  }
}

SpineArcs measureSpines(const SpineSet& spines) {
  SpineArcs arcs;
  arcs.arc.resize(spines.points.size());
  arcs.length.reserve(spines.spines.size());
  for (const SpineSet::Spine& spine : spines.spines) {
    float arc = 0.0F;
    arcs.arc[spine.begin] = 0.0F;
    for (std::uint32_t i = spine.begin + 1; i < spine.end; ++i) {
      arc += glm::distance(spines.points[i - 1], spines.points[i]);
      arcs.arc[i] = arc;
    }
    if (spine.closed)
      arc += glm::distance(spines.points[spine.end - 1], spines.points[spine.begin]);
    arcs.length.push_back(arc);
  }
  return arcs;
}

}  // namespace limn
