// SPDX-License-Identifier: Apache-2.0
// Based on: P. Mohr, "Silhouette Rendering of Complex Shapes with Stylized Lines" (thesis), 2013,
// §3.4: strokes as textured billboards with arc-length texture coordinates.
// Deviations: the billboard is built in the picture plane, so its width is exact; neighbouring
// segments share corners instead of overlapping as separate quads; the texture's scale is in pixels
// instead of a fraction of the longest line, so that it does not change with the view.
#include "client/stroke/tessellate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

/// Turns up to here (cosine) are mitred: the corner is then at most 1/cos(35°) = 1.22 half widths
/// away from the spine.
constexpr float kMitreCosine = 0.34F;

/// Limits below which lines fade are at most this share of the whole drawing's extent, so that a
/// small picture of a model is not an empty one.
constexpr float kLargestFade = 0.08F;

/// A place along a spine where the strip has corners.
struct Station {
  glm::vec2 point{0.0F};
  float arc = 0.0F;
  float halfWidth = 0.0F;
};

glm::vec2 leftOf(const glm::vec2& direction) {
  return {direction.y, -direction.x};
}

/// Where in the texture a line starts: every line differently, the same one in every frame.
float startOfTexture(const PolylineSet& lines, const SpineSet::Spine& spine) {
  const glm::vec3 p = lines.points[lines.lines[spine.line].begin];
  std::uint32_t hash = 2166136261U;
  for (const float value : {p.x, p.y, p.z}) {
    hash = (hash ^ std::bit_cast<std::uint32_t>(value)) * 16777619U;
    hash ^= hash >> 15U;
  }
  return static_cast<float>(hash >> 8U) / 16777216.0F;
}

/// One at full size, 0 at half of it: how much a line of this extent is to be seen.
float fade(float extentPx, float belowPx) {
  if (!(belowPx > 0.0F)) return 1.0F;
  const float t = std::clamp(extentPx / belowPx - 1.0F, 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

/// Builds the strip of one spine at a time.
class StripBuilder {
 public:
  StripBuilder(const SpineSet& spines, const StrokeStyle& style, float widthPx, StrokeMesh& out)
      : style_(style),
        widthPx_(widthPx),
        out_(out) {
    if (spines.points.empty()) return;
    largestFade_ =
        kLargestFade * extentOf(spines, 0, static_cast<std::uint32_t>(spines.points.size()));
  }

  void build(
      const SpineSet& spines,
      const SpineArcs& arcs,
      const SpineSamples& samples,
      const PolylineSet& lines,
      std::uint32_t index) {
    const SpineSet::Spine& spine = spines.spines[index];
    const float length = arcs.length[index];
    if (!(length > 0.0F)) return;
    const bool isThin = spine.kind == LineKind::kCrease || spine.kind == LineKind::kSeam;
    const float ink = widthPx_ * (isThin ? style_.creaseWidth : 1.0F);
    length_ = length;
    fullHalfWidth_ = 0.5F * ink / style_.body;
    sampleBegin_ = static_cast<float>(samples.begin[index]);
    samplePerPx_ = samples.perPx[index];
    // Textures grow with the stroke's width, else a wide stroke's would look squashed.
    const float scale = widthPx_ / style_.widthPx;
    visiblePerPx_ = repeatsPerPx(style_.visible.lengthPx * scale, spine.closed);
    hiddenPerPx_ = repeatsPerPx(style_.hidden.lengthPx * scale, spine.closed);
    start_ = startOfTexture(lines, spine);
    const float extent = extentOf(spines, spine.begin, spine.end);
    // Short creases are mostly noise of a scan.
    const float factor = isThin ? style_.creaseFade : 1.0F;
    visibleFade_ = fade(extent, std::min(factor * style_.fadeBelowPx, largestFade_));
    hiddenFade_ = fade(extent, std::min(factor * style_.fadeHiddenBelowPx, largestFade_));
    if (visibleFade_ <= 0.0F && hiddenFade_ <= 0.0F) return;

    collectStations(spines, arcs, spine);
    emit(spine.closed);
  }

 private:
  [[nodiscard]] float repeatsPerPx(float repeatPx, bool closed) const {
    if (!closed) return 1.0F / repeatPx;
    return std::max(1.0F, std::round(length_ / repeatPx)) / length_;
  }

  static float extentOf(const SpineSet& spines, std::uint32_t begin, std::uint32_t end) {
    glm::vec2 low = spines.points[begin];
    glm::vec2 high = low;
    for (std::uint32_t i = begin; i < end; ++i) {
      low = glm::min(low, spines.points[i]);
      high = glm::max(high, spines.points[i]);
    }
    return glm::distance(low, high);
  }

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

  void
  collectStations(const SpineSet& spines, const SpineArcs& arcs, const SpineSet::Spine& spine) {
    stations_.clear();
    const float radius = fullHalfWidth_ * style_.body;
    const float extra = style_.overshootPx + radius;
    const float before = !spine.closed && spine.freeStart ? extra : 0.0F;
    const float after = !spine.closed && spine.freeEnd ? extra : 0.0F;
    const auto endDistance = [&](float arc) {
      float distance = 1e9F;
      if (before > 0.0F) distance = std::min(distance, arc + before);
      if (after > 0.0F) distance = std::min(distance, length_ + after - arc);
      return distance;
    };
    const auto add = [&](const glm::vec2& point, float arc) {
      stations_.push_back({point, arc, spine.closed ? fullHalfWidth_ : profile(endDistance(arc))});
    };
    // The cap and the taper need stations of their own, whatever the spacing of the spine.
    const float shaped = std::max(
        {style_.taperPx, 2.0F * fullHalfWidth_ * (style_.pool > 0.0F ? 2.0F : 1.0F), extra});
    const float steps[] = {0.0F, 0.06F * radius, 0.2F * radius, 0.5F * radius, radius};
    if (before > 0.0F) {
      const glm::vec2 a = spines.points[spine.begin];
      const glm::vec2 direction = glm::normalize(spines.points[spine.begin + 1] - a);
      for (const float step : steps) {
        if (step < before) add(a - direction * (before - step), step - before);
      }
    }
    for (std::uint32_t i = spine.begin; i < spine.end; ++i) {
      add(spines.points[i], arcs.arc[i]);
      const bool isLast = i + 1 == spine.end;
      if (isLast && !spine.closed) break;
      const glm::vec2 next = isLast ? spines.points[spine.begin] : spines.points[i + 1];
      const float from = arcs.arc[i];
      const float to = isLast ? length_ : arcs.arc[i + 1];
      // Long segments are divided where the width changes.
      if (spine.closed || to - from < 3.0F) continue;
      constexpr int kParts = 6;
      float cuts[2 * kParts];
      int count = 0;
      for (int k = 1; k < kParts; ++k) {
        const float d = shaped * static_cast<float>(k) / kParts;
        if (before > 0.0F && d > from && d < to) cuts[count++] = d;
        if (after > 0.0F && length_ - d > from && length_ - d < to) cuts[count++] = length_ - d;
      }
      std::sort(cuts, cuts + count);
      for (int k = 0; k < count; ++k) {
        add(glm::mix(spines.points[i], next, (cuts[k] - from) / (to - from)), cuts[k]);
      }
    }
    if (after > 0.0F) {
      const glm::vec2 b = spines.points[spine.end - 1];
      const glm::vec2 direction = glm::normalize(b - spines.points[spine.end - 2]);
      for (auto step = std::rbegin(steps); step != std::rend(steps); ++step) {
        if (*step < after) add(b + direction * (after - *step), length_ + after - *step);
      }
    }
  }

  std::uint32_t vertex(const glm::vec2& position, float across, float arc, float half) {
    const float onLine = std::clamp(arc, 0.0F, length_);
    out_.vertices.push_back(
        {position,
         across,
         sampleBegin_ + samplePerPx_ * onLine,
         start_ + visiblePerPx_ * arc,
         start_ + hiddenPerPx_ * arc,
         visibleFade_,
         hiddenFade_,
         half});
    return static_cast<std::uint32_t>(out_.vertices.size() - 1);
  }

  struct Pair {
    std::uint32_t left = 0;
    std::uint32_t right = 0;
  };

  Pair pair(const glm::vec2& point, const glm::vec2& aside, float arc, float half) {
    return {vertex(point + aside, -1.0F, arc, half), vertex(point - aside, 1.0F, arc, half)};
  }

  void quad(const Pair& a, const Pair& b) {
    out_.indices.insert(out_.indices.end(), {a.left, a.right, b.left, b.left, a.right, b.right});
  }

  /// Closes the outer side of a sharp corner: a fan around the spine from normal n0 to n1.
  void fan(const Station& at, float arc, const glm::vec2& n0, const glm::vec2& n1) {
    const float cross = n0.x * n1.y - n0.y * n1.x;
    // Turning right in a picture whose y runs down has cross > 0: the left side is the outer one.
    const float side = cross >= 0.0F ? 1.0F : -1.0F;
    const float turn = side * std::acos(std::clamp(glm::dot(n0, n1), -1.0F, 1.0F));
    const int parts = std::max(2, static_cast<int>(std::ceil(std::abs(turn) / 0.4F)));
    const std::uint32_t centre = vertex(at.point, 0.0F, arc, at.halfWidth);
    std::uint32_t previous = 0;
    for (int k = 0; k <= parts; ++k) {
      const float angle = turn * static_cast<float>(k) / static_cast<float>(parts);
      const glm::vec2 n(
          std::cos(angle) * n0.x - std::sin(angle) * n0.y,
          std::sin(angle) * n0.x + std::cos(angle) * n0.y);
      const std::uint32_t rim =
          vertex(at.point + side * at.halfWidth * n, -side, arc, at.halfWidth);
      if (k > 0) out_.indices.insert(out_.indices.end(), {centre, previous, rim});
      previous = rim;
    }
  }

  void emit(bool closed) {
    const std::size_t count = stations_.size();
    if (count < 2) return;
    const std::size_t segments = closed ? count : count - 1;
    directions_.resize(segments);
    glm::vec2 known(1.0F, 0.0F);
    for (std::size_t i = 0; i < segments; ++i) {
      const glm::vec2 step = stations_[(i + 1) % count].point - stations_[i].point;
      const float size = glm::length(step);
      if (size > 1e-4F) known = step / size;
      directions_[i] = known;
    }
    Pair previous;
    for (std::size_t i = 0; i <= segments; ++i) {
      const Station& at = stations_[i % count];
      const float arc = i == count ? length_ : at.arc;  // a loop's end is its start, one lap on
      const bool hasIn = closed || i > 0;
      const bool hasOut = closed || i < segments;
      const glm::vec2 in = directions_[(i + segments - 1) % segments];
      const glm::vec2 out = directions_[i % segments];
      const glm::vec2 n0 = leftOf(hasIn ? in : out);
      const glm::vec2 n1 = leftOf(hasOut ? out : in);
      const float cosine = glm::dot(n0, n1);
      if (cosine > kMitreCosine) {
        // |n0 + n1|² = 2 + 2 cos; the mitre is (n0 + n1) / (1 + cos).
        const Pair here =
            pair(at.point, (n0 + n1) * (at.halfWidth / (1.0F + cosine)), arc, at.halfWidth);
        if (i > 0) quad(previous, here);
        previous = here;
      } else {
        if (i > 0) quad(previous, pair(at.point, n0 * at.halfWidth, arc, at.halfWidth));
        // A loop's last corner has its fan from when it was the first.
        if (i < count) fan(at, arc, n0, n1);
        previous = pair(at.point, n1 * at.halfWidth, arc, at.halfWidth);
      }
    }
  }

  const StrokeStyle& style_;
  float widthPx_;
  StrokeMesh& out_;
  float largestFade_ = 0.0F;
  std::vector<Station> stations_;
  std::vector<glm::vec2> directions_;
  // Of the spine being built.
  float length_ = 0.0F;
  float fullHalfWidth_ = 0.0F;
  float sampleBegin_ = 0.0F;
  float samplePerPx_ = 0.0F;
  float visiblePerPx_ = 0.0F;
  float hiddenPerPx_ = 0.0F;
  float start_ = 0.0F;
  float visibleFade_ = 1.0F;
  float hiddenFade_ = 1.0F;
};

}  // namespace

StrokeMesh tessellate(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const SpineSamples& samples,
    const PolylineSet& lines,
    const StrokeStyle& style,
    float widthPx) {
  StrokeMesh mesh;
  mesh.vertices.reserve(2 * spines.points.size());
  mesh.indices.reserve(6 * spines.points.size());
  StripBuilder builder(spines, style, widthPx, mesh);
  for (std::uint32_t i = 0; i < spines.spines.size(); ++i) {
    builder.build(spines, arcs, samples, lines, i);
  }
  return mesh;
}

}  // namespace limn
