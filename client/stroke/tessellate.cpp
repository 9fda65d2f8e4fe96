// SPDX-License-Identifier: Apache-2.0
// Based on: P. Mohr, "Silhouette Rendering of Complex Shapes with Stylized Lines" (thesis), 2013,
// §3.4: strokes as textured billboards with arc-length texture coordinates.
// Deviations: the billboard is built in the picture plane, so its width is exact; neighbouring
// segments share corners instead of overlapping as separate quads; the texture's scale is in pixels
// instead of a fraction of the longest line, so that it does not change with the view.
#include "client/stroke/tessellate.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limn {
namespace {

/// Turns up to here (cosine) are mitred: the corner is then at most 1/cos(35°) = 1.22 half widths
/// away from the spine.
constexpr float kMitreCosine = 0.34F;

/// How far the strip's middle may run from the spine, pixels.
constexpr float kSimplifyPx = 0.08F;
/// How long its segments may be made that way.
constexpr float kLongestPx = 24.0F;

/// A place along a spine where the strip has corners.
struct Station {
  glm::vec2 point{0.0F};
  float arc = 0.0F;
  float parameter = 0.0F;
  float halfWidth = 0.0F;
};

glm::vec2 leftOf(const glm::vec2& direction) {
  return {direction.y, -direction.x};
}

float cross(const glm::vec2& a, const glm::vec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// Follows points from an anchor and says how far a straight line stays within a tolerance of all
/// of them [Zhao, Saalfeld 1997, "sleeve-fitting"].
class Sleeve {
 public:
  void start(const glm::vec2& anchor) {
    anchor_ = anchor;
    isEmpty_ = true;
  }

  /// Whether the line from the anchor to p passes every point added so far; then p is added.
  bool add(const glm::vec2& p) {
    const glm::vec2 d = p - anchor_;
    const float size2 = glm::dot(d, d);
    if (size2 <= 4.0F * kSimplifyPx * kSimplifyPx) return true;  // in reach from any direction
    if (!isEmpty_ &&
        (cross(low_, d) < 0.0F || cross(d, high_) < 0.0F || glm::dot(d, last_) <= 0.0F))
      return false;
    // The directions that pass p: turned by asin(tolerance / distance) to either side.
    const float sine = kSimplifyPx / std::sqrt(size2);
    const float cosine = std::sqrt(1.0F - sine * sine);
    const glm::vec2 low(cosine * d.x + sine * d.y, cosine * d.y - sine * d.x);
    const glm::vec2 high(cosine * d.x - sine * d.y, cosine * d.y + sine * d.x);
    if (isEmpty_ || cross(low_, low) > 0.0F) low_ = low;
    if (isEmpty_ || cross(high, high_) > 0.0F) high_ = high;
    last_ = d;
    isEmpty_ = false;
    return true;
  }

 private:
  glm::vec2 anchor_{0.0F};
  glm::vec2 low_{0.0F};
  glm::vec2 high_{0.0F};
  glm::vec2 last_{0.0F};
  bool isEmpty_ = true;
};

/// Builds the strip of one spine at a time.
class StripBuilder {
 public:
  StripBuilder(
      const StrokeSpines& in,
      const StrokeStyle& style,
      float widthPx,
      const Brush& brush,
      StrokeMesh& out)
      : in_(in),
        style_(style),
        widthPx_(widthPx),
        brush_(brush),
        period_(texturePeriod(style, widthPx)),
        visiblePerPx_(repeatsAPeriod(style, style.visible) / period_),
        hiddenPerPx_(repeatsAPeriod(style, style.hidden) / period_),
        out_(out) {}

  void build(std::uint32_t index) {
    const SpineSet::Spine& spine = in_.spines.spines[index];
    length_ = in_.arcs.length[index];
    if (!(length_ > 0.0F)) return;
    visibleFade_ = in_.fades[index].visible;
    hiddenFade_ = in_.fades[index].hidden;
    if (visibleFade_ <= 0.0F && hiddenFade_ <= 0.0F) return;
    const float ink = widthPx_ * (isInner(spine.kind) ? style_.creaseWidth : 1.0F);
    fullHalfWidth_ = 0.5F * ink / style_.body;
    sampleBegin_ = static_cast<float>(in_.samples.begin[index]);
    samplePerPx_ = in_.samples.perPx[index];
    closingParameter_ = in_.parameters.to[spine.end - 1];
    collectStations(spine);
    if (brush_.kind != BrushKind::kPlain) leadOff(spine.closed);
    emit(spine);
  }

 private:
  /// Half the strip's width at a distance from the nearer free end.
  [[nodiscard]] float profile(float fromEndPx) const {
    const float full = fullHalfWidth_;
    float half = full;
    if (style_.taperPx > 0.0F) {
      // Never to nothing: an ink or pencil tip has a size.
      const float t = std::clamp(fromEndPx / std::min(style_.taperPx, 0.5F * length_), 0.0F, 1.0F);
      half *= 0.3F + 0.7F * t * (2.0F - t);
    }
    if (style_.pool > 0.0F) {
      const float t = (fromEndPx - full) / full;
      half *= 1.0F + style_.pool * std::exp(-t * t);
    }
    // A round cap of the ink's own radius.
    const float radius = full * style_.body;
    if (fromEndPx < radius) {
      const float t = 1.0F - fromEndPx / radius;
      half *= std::sqrt(std::max(0.0F, 1.0F - t * t));
    }
    return half;
  }

  void collectStations(const SpineSet::Spine& spine) {
    stations_.clear();
    const SpineSet& spines = in_.spines;
    const float radius = fullHalfWidth_ * style_.body;
    const float extra = style_.overshootPx + radius;
    const float before = !spine.closed && spine.freeStart ? extra : 0.0F;
    const float after = !spine.closed && spine.freeEnd ? extra : 0.0F;
    // The cap and the taper need stations of their own, whatever the spacing of the spine.
    const float shaped = std::max(
        {style_.taperPx, 2.0F * fullHalfWidth_ * (style_.pool > 0.0F ? 2.0F : 1.0F), extra});
    const auto add = [&](const glm::vec2& point, float arc, float parameter, float width) {
      float fromEnd = 1e9F;
      if (before > 0.0F) fromEnd = std::min(fromEnd, arc + before);
      if (after > 0.0F) fromEnd = std::min(fromEnd, length_ + after - arc);
      const bool isShaped = fromEnd < 2.0F * shaped;
      Station& station = stations_.emplace_back();
      station.point = point;
      station.arc = arc;
      station.parameter = parameter;
      station.halfWidth = width * (isShaped ? profile(fromEnd) : fullHalfWidth_);
    };
    const std::array<float, 5> steps = {0.0F, 0.06F * radius, 0.2F * radius, 0.5F * radius, radius};
    if (before > 0.0F) {
      const glm::vec2 a = spines.points[spine.begin];
      const glm::vec2 direction = directionFrom(a, spines.points[spine.begin + 1]);
      const float start = in_.parameters.from[spine.begin];
      for (const float step : steps) {
        if (step < before)
          add(a - direction * (before - step),
              step - before,
              start + step - before,
              widthAt(spine.begin));
      }
    }
    addInner(spine, before > 0.0F ? shaped : 0.0F, after > 0.0F ? shaped : 0.0F, add);
    if (after > 0.0F) {
      const glm::vec2 b = spines.points[spine.end - 1];
      const glm::vec2 direction = directionFrom(spines.points[spine.end - 2], b);
      const float end = in_.parameters.to[spine.end - 2];
      for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
        if (*step < after)
          add(b + direction * (after - *step),
              length_ + after - *step,
              end + after - *step,
              widthAt(spine.end - 1));
      }
    }
  }

  [[nodiscard]] float widthAt(std::uint32_t point) const {
    return in_.widths.empty() ? 1.0F : in_.widths[point];
  }

  /// Moves the strip off its spine by the brush, with stations as close as that takes.
  void leadOff(bool closed) {
    const float step = std::clamp(brush_.wavelengthPx / 8.0F, 0.6F, 3.0F);
    refined_.clear();
    const std::size_t count = stations_.size();
    for (std::size_t i = 0; i < count; ++i) {
      const Station& a = stations_[i];
      refined_.push_back(a);
      if (i + 1 == count && !closed) break;
      Station b = stations_[i + 1 < count ? i + 1 : 0];
      if (i + 1 == count) {
        b.arc = length_;
        b.parameter = closingParameter_;
      }
      const auto parts = static_cast<int>(std::ceil((b.arc - a.arc) / step));
      for (int k = 1; k < parts; ++k) {
        const float t = static_cast<float>(k) / static_cast<float>(parts);
        refined_.push_back(
            {glm::mix(a.point, b.point, t),
             glm::mix(a.arc, b.arc, t),
             glm::mix(a.parameter, b.parameter, t),
             glm::mix(a.halfWidth, b.halfWidth, t)});
      }
    }
    stations_.resize(refined_.size());
    const std::size_t size = refined_.size();
    for (std::size_t i = 0; i < size; ++i) {
      const Station& at = refined_[i];
      const std::size_t before = i > 0 ? i - 1 : (closed ? size - 1 : 0);
      const std::size_t after = i + 1 < size ? i + 1 : (closed ? 0 : size - 1);
      const glm::vec2 along = directionFrom(refined_[before].point, refined_[after].point);
      const glm::vec2 offset = brushOffset(brush_, at.parameter, period_);
      stations_[i] = at;
      stations_[i].point += offset.x * along + offset.y * leftOf(along);
    }
  }

  static glm::vec2 directionFrom(const glm::vec2& a, const glm::vec2& b) {
    const float size = glm::distance(a, b);
    return size > 0.0F ? (b - a) / size : glm::vec2(1.0F, 0.0F);
  }

  /// Stations on the spine itself: the points it cannot do without, and more where the width
  /// changes (over so much of its start and end).
  template <class Add>
  void addInner(const SpineSet::Spine& spine, float shapedStart, float shapedEnd, Add add) {
    const glm::vec2* points = in_.spines.points.data();
    const float* arcs = in_.arcs.arc.data();
    const float* from = in_.parameters.from.data();
    const float* to = in_.parameters.to.data();
    const std::uint32_t last = spine.end - 1;
    const auto pointAt = [&](std::uint32_t i) { return points[i < spine.end ? i : spine.begin]; };
    const auto arcAt = [&](std::uint32_t i) { return i < spine.end ? arcs[i] : length_; };
    add(points[spine.begin], 0.0F, from[spine.begin], widthAt(spine.begin));
    Sleeve sleeve;
    std::uint32_t anchor = spine.begin;
    // One past the last point: the end of a closed line's last segment, which emit() adds.
    const std::uint32_t stop = spine.closed ? spine.end : last;
    while (anchor < stop) {
      sleeve.start(points[anchor]);
      std::uint32_t next = anchor + 1;
      sleeve.add(pointAt(next));
      const bool mayBeLong = arcs[anchor] >= shapedStart;
      while (next < stop && mayBeLong && arcAt(next + 1) - arcs[anchor] < kLongestPx &&
             arcAt(next + 1) <= length_ - shapedEnd && from[next] == to[next - 1] &&
             sleeve.add(pointAt(next + 1))) {
        ++next;
      }
      const float begin = arcs[anchor];
      const float end = arcAt(next);
      const float parameterEnd = to[next - 1];
      if (end - begin >= 3.0F && (begin < shapedStart || end > length_ - shapedEnd)) {
        constexpr int kParts = 6;
        for (int k = 1; k < 2 * kParts; ++k) {
          const float cut = k < kParts
                                ? shapedStart * static_cast<float>(k) / kParts
                                : length_ - shapedEnd * static_cast<float>(2 * kParts - k) / kParts;
          const float t = (cut - begin) / (end - begin);
          if (!(cut > stations_.back().arc) || !(t > 0.0F && t < 1.0F)) continue;
          add(glm::mix(points[anchor], pointAt(next), t),
              cut,
              glm::mix(from[anchor], parameterEnd, t),
              glm::mix(widthAt(anchor), widthAt(next < spine.end ? next : spine.begin), t));
        }
      }
      if (next < spine.end) {
        add(points[next], end, parameterEnd, widthAt(next));
        // A seam: two stations at one place.
        if (next < last && from[next] != parameterEnd)
          add(points[next], end, from[next], widthAt(next));
      }
      anchor = next;
    }
  }

  std::uint32_t
  vertex(const glm::vec2& position, float across, float arc, float parameter, float half) {
    const float onLine = std::clamp(arc, 0.0F, length_);
    // Where it stays, as stations: a copy would wait for its parts to be written.
    StrokeVertex& at = out_.vertices.emplace_back();
    at.position = position;
    at.across = across;
    at.sample = sampleBegin_ + samplePerPx_ * onLine;
    at.visibleU = visiblePerPx_ * parameter;
    at.hiddenU = hiddenPerPx_ * parameter;
    at.visibleFade = visibleFade_;
    at.hiddenFade = hiddenFade_;
    at.margin = half;
    return static_cast<std::uint32_t>(out_.vertices.size() - 1);
  }

  struct Pair {
    std::uint32_t left = 0;
    std::uint32_t right = 0;
  };

  Pair pair(const Station& at, const glm::vec2& aside) {
    return {
        vertex(at.point + aside, -1.0F, at.arc, at.parameter, at.halfWidth),
        vertex(at.point - aside, 1.0F, at.arc, at.parameter, at.halfWidth)};
  }

  void quad(const Pair& a, const Pair& b) {
    const std::size_t size = out_.indices.size();
    out_.indices.resize(size + 6);
    std::uint32_t* i = &out_.indices[size];
    i[0] = a.left;
    i[1] = a.right;
    i[2] = b.left;
    i[3] = b.left;
    i[4] = a.right;
    i[5] = b.right;
  }

  /// Closes the outer side of a sharp corner: a fan around the spine from normal n0 to n1.
  void fan(const Station& at, const glm::vec2& n0, const glm::vec2& n1) {
    // Turning right in a picture whose y runs down has cross > 0: the left side is the outer one.
    const float side = cross(n0, n1) >= 0.0F ? 1.0F : -1.0F;
    const float turn = side * std::acos(std::clamp(glm::dot(n0, n1), -1.0F, 1.0F));
    const int parts = std::max(2, static_cast<int>(std::ceil(std::abs(turn) / 0.4F)));
    const std::uint32_t centre = vertex(at.point, 0.0F, at.arc, at.parameter, at.halfWidth);
    std::uint32_t previous = 0;
    for (int k = 0; k <= parts; ++k) {
      const float angle = turn * static_cast<float>(k) / static_cast<float>(parts);
      const glm::vec2 n(
          std::cos(angle) * n0.x - std::sin(angle) * n0.y,
          std::sin(angle) * n0.x + std::cos(angle) * n0.y);
      const std::uint32_t rim =
          vertex(at.point + side * at.halfWidth * n, -side, at.arc, at.parameter, at.halfWidth);
      if (k > 0) out_.indices.insert(out_.indices.end(), {centre, previous, rim});
      previous = rim;
    }
  }

  void emit(const SpineSet::Spine& spine) {
    const bool closed = spine.closed;
    const std::size_t count = stations_.size();
    if (count < 2) return;
    const std::size_t segments = closed ? count : count - 1;
    directions_.resize(segments);
    glm::vec2 known(1.0F, 0.0F);
    for (std::size_t i = 0; i < segments; ++i) {
      const glm::vec2 step = stations_[i + 1 < count ? i + 1 : 0].point - stations_[i].point;
      const float size2 = glm::dot(step, step);
      if (size2 > 1e-8F) known = step / std::sqrt(size2);
      directions_[i] = known;
    }
    Pair previous;
    for (std::size_t i = 0; i <= segments; ++i) {
      Station at = stations_[i < count ? i : 0];
      if (i == count) {  // a loop's end is its start, one lap on
        at.arc = length_;
        at.parameter = closingParameter_;
      }
      const bool hasIn = closed || i > 0;
      const bool hasOut = closed || i < segments;
      const glm::vec2 in = directions_[i > 0 ? i - 1 : segments - 1];
      const glm::vec2 out = directions_[i < segments ? i : 0];
      const glm::vec2 n0 = leftOf(hasIn ? in : out);
      const glm::vec2 n1 = leftOf(hasOut ? out : in);
      const float cosine = glm::dot(n0, n1);
      if (cosine > kMitreCosine) {
        // |n0 + n1|² = 2 + 2 cos; the mitre is (n0 + n1) / (1 + cos).
        const Pair here = pair(at, (n0 + n1) * (at.halfWidth / (1.0F + cosine)));
        if (i > 0) quad(previous, here);
        previous = here;
      } else {
        if (i > 0) quad(previous, pair(at, n0 * at.halfWidth));
        // A loop's last corner has its fan from when it was the first.
        if (i < count) fan(at, n0, n1);
        previous = pair(at, n1 * at.halfWidth);
      }
    }
  }

  const StrokeSpines& in_;
  const StrokeStyle& style_;
  float widthPx_;
  const Brush& brush_;
  float period_;
  float visiblePerPx_;
  float hiddenPerPx_;
  StrokeMesh& out_;
  std::vector<Station> stations_;
  std::vector<Station> refined_;
  std::vector<glm::vec2> directions_;
  // Of the spine being built.
  float length_ = 0.0F;
  float closingParameter_ = 0.0F;
  float fullHalfWidth_ = 0.0F;
  float sampleBegin_ = 0.0F;
  float samplePerPx_ = 0.0F;
  float visibleFade_ = 1.0F;
  float hiddenFade_ = 1.0F;
};

}  // namespace

float texturePeriod(const StrokeStyle& style, float widthPx) {
  // Textures grow with the stroke's width, else a wide stroke's would look squashed.
  return std::max({style.visible.lengthPx, style.hidden.lengthPx, 1.0F}) * widthPx / style.widthPx;
}

float repeatsAPeriod(const StrokeStyle& style, const StrokeTexture& texture) {
  const float longer = std::max({style.visible.lengthPx, style.hidden.lengthPx, 1.0F});
  return std::max(1.0F, std::round(longer / std::max(texture.lengthPx, 1.0F)));
}

void tessellate(
    const StrokeSpines& strokes,
    const StrokeStyle& style,
    float widthPx,
    const Brush& brush,
    StrokeMesh& out) {
  out.vertices.clear();
  out.indices.clear();
  out.vertices.reserve(strokes.spines.points.size());
  out.indices.reserve(3 * strokes.spines.points.size());
  StripBuilder builder(strokes, style, widthPx, brush, out);
  for (std::uint32_t i = 0; i < strokes.spines.spines.size(); ++i)
    builder.build(i);
}

}  // namespace limn
