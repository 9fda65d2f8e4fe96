// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/spine.h"

#include "client/stroke/clip_segment.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace limn {
namespace {

/// Points nearer than this in the picture are one point, whatever the use.
constexpr float kSamePx = 0.05F;

/// How far before its end a line is asked whether it is visible there, pixels.
constexpr float kBeforeJointPx = 2.0F;

/// How far smoothing looks, in standard deviations: where (1 − t²)² has the deviation asked for.
constexpr float kBellReach = 2.65F;

/// Whether a line turns back by more than 120° between two places beside it: a contour's cusp.
/// Averaged with what is before and behind it, that would draw in, and not reach what it ends at.
bool isTip(const glm::vec2& back, const glm::vec2& forth) {
  const float cosine = glm::dot(back, forth);
  return cosine > 0.0F && 4.0F * cosine * cosine > glm::dot(back, back) * glm::dot(forth, forth);
}

/// Builds the spines of one line at a time.
class SpineBuilder {
 public:
  SpineBuilder(const Viewport& viewport, float mergePx, SpineSet& out)
      : scale_(0.5 * viewport.width, 0.5 * viewport.height),
        nearest2_(mergePx * mergePx),
        out_(out) {}

  void begin(LineKind kind, std::uint32_t line, bool isFree) {
    current_ = {};
    current_.kind = kind;
    current_.line = line;
    current_.freeStart = isFree;
    current_.begin = static_cast<std::uint32_t>(out_.points.size());
    open_ = true;
  }

  void add(const glm::dvec4& clip, std::uint32_t source) {
    const double inverse = 1.0 / clip.w;
    const glm::vec2 point(
        static_cast<float>((clip.x * inverse + 1.0) * scale_.x),
        static_cast<float>((1.0 - clip.y * inverse) * scale_.y));
    if (out_.points.size() > current_.begin) {
      const glm::vec2 step = point - out_.points.back();
      if (glm::dot(step, step) < nearest2_) {
        // The next segment starts here, so it is its source that counts.
        out_.source.back() = source;
        return;
      }
      current_.low = glm::min(current_.low, point);
      current_.high = glm::max(current_.high, point);
    } else {
      current_.low = current_.high = point;
    }
    out_.points.push_back(point);
    out_.depth.push_back(static_cast<float>(0.5 * (clip.z * inverse + 1.0)));
    out_.source.push_back(source);
  }

  /// An end: where the line really ends, however near the point before is.
  void addLast(const glm::dvec4& clip, std::uint32_t source) {
    const std::size_t before = out_.points.size();
    add(clip, source);
    if (out_.points.size() > before || before <= current_.begin + 1) return;
    drop(static_cast<std::uint32_t>(before - 1));
    add(clip, source);
  }

  void finish(bool closed, bool isFree) {
    if (!open_) return;
    open_ = false;
    current_.end = static_cast<std::uint32_t>(out_.points.size());
    current_.closed = closed;
    current_.freeEnd = isFree;
    if (closed && current_.size() > 1 &&
        glm::distance(out_.points.back(), out_.points[current_.begin]) < std::sqrt(nearest2_)) {
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

  glm::dvec2 scale_;
  float nearest2_;
  SpineSet& out_;
  SpineSet::Spine current_;
  bool open_ = false;
};

/// Cuts a line that leaves the picture: a spine for each piece inside. clip: its points.
void cutLine(
    const PolylineSet::Line& line,
    std::uint32_t index,
    std::span<const glm::dvec4> clip,
    SpineBuilder& builder) {
  const auto count = static_cast<std::uint32_t>(clip.size());
  const std::uint32_t segments = line.segmentCount();
  const auto spanOf = [&](std::uint32_t i) { return clipSegment(clip[i], clip[(i + 1) % count]); };
  // A cut loop is walked from where it comes into the picture, so that no piece is split at the
  // loop's arbitrary start.
  std::uint32_t first = 0;
  bool isCut = false;
  for (std::uint32_t i = 0; line.closed && !isCut && i < segments; ++i) {
    const ClipSpan span = spanOf(i);
    if (span.begin > 0.0 || span.empty()) {
      first = i;
      isCut = true;
    } else if (span.end < 1.0) {
      first = (i + 1) % segments;
      isCut = true;
    }
  }
  for (std::uint32_t k = 0; k < segments; ++k) {
    const std::uint32_t i = (first + k) % segments;
    const ClipSpan span = spanOf(i);
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
      builder.addLast(a + span.end * (b - a), source);
      builder.finish(false, false);
    } else if (isLast) {
      const bool closed = line.closed && !isCut;
      if (!closed) builder.addLast(b, source);
      builder.finish(closed, !isCut);
    }
  }
}

}  // namespace

void SpineProjector::project(
    const PolylineSet& lines,
    const LineScene& scene,
    float mergePx,
    SpineSet& out) {
  const glm::dmat4 toClip = clipFromGrid(scene);

  out.points.clear();
  out.depth.clear();
  out.source.clear();
  out.spines.clear();
  SpineBuilder builder(scene.viewport, std::max(mergePx, kSamePx), out);
  for (std::uint32_t index = 0; index < lines.lines.size(); ++index) {
    const PolylineSet::Line& line = lines.lines[index];
    const std::uint32_t count = line.end - line.begin;
    if (count < 2) continue;
    clip_.resize(count);
    bool isWhole = true;
    for (std::uint32_t i = 0; i < count; ++i) {
      const glm::dvec3 p(lines.points[line.begin + i]);
      clip_[i] = toClip[0] * p.x + toClip[1] * p.y + toClip[2] * p.z + toClip[3];
      isWhole = isWhole && isInPicture(clip_[i]);
    }
    if (isWhole) {
      builder.begin(line.kind, index, true);
      const std::uint32_t inner = line.closed ? count : count - 1;
      for (std::uint32_t i = 0; i < inner; ++i)
        builder.add(clip_[i], line.begin + i);
      if (!line.closed) builder.addLast(clip_[inner], line.begin + inner - 1);
      builder.finish(line.closed, true);
    } else {
      cutLine(line, index, clip_, builder);
    }
  }
  out.exact = out.points;
}

SpineSet projectLines(const PolylineSet& lines, const LineScene& scene) {
  SpineSet out;
  SpineProjector().project(lines, scene, kSamePx, out);
  return out;
}

void markDrawn(const SpineSet& spines, std::size_t points, std::vector<std::uint8_t>& isDrawn) {
  isDrawn.assign(points, 0);
  for (const std::uint32_t point : spines.source)
    isDrawn[point] = 1;
}

void smoothSpines(float sigmaPx, SpineSet& spines) {
  if (!(sigmaPx > 0.0F)) return;
  const float reach = kBellReach * sigmaPx;
  const float perReach2 = 1.0F / (reach * reach);
  std::vector<glm::vec2> before;
  std::vector<float> gaps;    // from each point to the next
  std::vector<float> shares;  // the length of line that a point stands for
  for (const SpineSet::Spine& spine : spines.spines) {
    const std::uint32_t count = spine.size();
    glm::vec2* points = &spines.points[spine.begin];
    before.assign(points, points + count);
    gaps.resize(count);
    shares.resize(count);
    for (std::uint32_t i = 0; i + 1 < count; ++i)
      gaps[i] = glm::distance(before[i], before[i + 1]);
    gaps[count - 1] = spine.closed ? glm::distance(before[count - 1], before[0]) : 0.0F;
    // Uneven spacing must not pull.
    float last = std::min(gaps[count - 1], reach);
    for (std::uint32_t i = 0; i < count; ++i) {
      const float gap = std::min(gaps[i], reach);
      shares[i] = 0.5F * (last + gap);
      last = gap;
    }
    // Round a small loop both ways end at the same place.
    const bool hasTips =
        !spine.closed || std::accumulate(gaps.begin(), gaps.end(), 0.0F) > 4.0F * reach;
    const std::uint32_t firstMoving = spine.closed ? 0 : 1;
    const std::uint32_t lastMoving = spine.closed ? count : count - 1;
    for (std::uint32_t i = firstMoving; i < lastMoving; ++i) {
      glm::vec2 sum = shares[i] * before[i];
      float weight = shares[i];
      // The window is cut to what both sides have, else the ends of a line would draw in.
      const std::uint32_t room = spine.closed ? count / 2 : std::min(i, count - 1 - i);
      float awayBack = 0.0F;
      float awayForth = 0.0F;
      std::uint32_t back = i;
      std::uint32_t forth = i;
      for (std::uint32_t step = 0; step < room; ++step) {
        awayForth += gaps[forth];
        forth = forth + 1 == count ? 0 : forth + 1;
        back = back == 0 ? count - 1 : back - 1;
        awayBack += gaps[back];
        if (awayBack > reach || awayForth > reach) break;
        const float nearBack = 1.0F - awayBack * awayBack * perReach2;
        const float nearForth = 1.0F - awayForth * awayForth * perReach2;
        const float weightBack = shares[back] * nearBack * nearBack;
        const float weightForth = shares[forth] * nearForth * nearForth;
        sum += weightBack * before[back] + weightForth * before[forth];
        weight += weightBack + weightForth;
      }
      if (!(weight > 0.0F)) continue;
      if (hasTips && isTip(before[back] - before[i], before[forth] - before[i])) continue;
      points[i] = sum / weight;
    }
  }
}

float arcBefore(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const SpineSet::Spine::Joint& joint) {
  const float length = arcs.length[joint.spine];
  const float arc = arcs.arc[joint.point] + (joint.isEnd ? -kBeforeJointPx : kBeforeJointPx);
  return spines.spines[joint.spine].closed ? arc - length * std::floor(arc / length)
                                           : std::clamp(arc, 0.0F, length);
}

SpineArcs measureSpines(const SpineSet& spines) {
  SpineArcs arcs;
  measureSpines(spines, arcs);
  return arcs;
}

void measureSpines(const SpineSet& spines, SpineArcs& arcs) {
  arcs.arc.resize(spines.points.size());
  arcs.length.clear();
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
}

}  // namespace limn
