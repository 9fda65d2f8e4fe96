// SPDX-License-Identifier: Apache-2.0
#include "client/svg/visible_runs.h"

#include "client/stroke/visibility/visibility.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

/// The shortest run that stays, in pixels, where the picture leaves out so many samples, a pixel
/// apart.
constexpr float shortestPx(int leftOut) {
  return static_cast<float>(leftOut) + 0.5F;
}

/// A run of one visibility up to distance `end` along its spine.
struct Stretch {
  float end = 0.0F;
  bool visible = false;
};

/// Cuts one spine after another.
class SpineCutter {
 public:
  SpineCutter(
      const SpineSet& spines,
      const SpineArcs& arcs,
      const PolylineSet& lines,
      const ResolvedLines& resolved,
      const LineScene& scene,
      const SpineSamples& samples,
      int closedGap)
      : spines_(spines),
        arcs_(arcs),
        lines_(lines),
        resolved_(resolved),
        viewport_(scene.viewport),
        clipFromGrid_(clipFromGrid(scene)),
        samples_(samples),
        closedGap_(closedGap) {}

  /// Which samples of a spine are visible, whatever is drawn.
  void see(std::uint32_t index) {
    isSeen_.resize(samples_.samples.size(), 0);
    length_ = arcs_.length[index];
    const SpineSet::Spine& spine = spines_.spines[index];
    if (!(length_ > 0.0F) || spine.isBridge()) return;
    collect(spine);
    join();
    std::size_t k = 0;
    for (std::uint32_t i = samples_.begin[index]; i < endOfSamples(index); ++i) {
      while (k + 1 < stretches_.size() && stretches_[k].end < arcOf(index, i))
        ++k;
      isSeen_[i] = stretches_[k].visible ? 1 : 0;
    }
  }

  /// After see() of every spine.
  void cut(std::uint32_t index, std::vector<VisibleRun>& out) {
    const SpineSet::Spine& spine = spines_.spines[index];
    length_ = arcs_.length[index];
    if (!(length_ > 0.0F)) return;
    if (spine.isBridge()) {
      const bool isVisible =
          isJoinedVisible(spine.joints[0], out) && isJoinedVisible(spine.joints[1], out);
      stretches_.assign(1, {length_, isVisible});
    } else {
      collect(spine);
      join();
      leaveOutDoubled(index);
      suppress(spine.closed, false, shortestPx(closedGap_));
      suppress(spine.closed, true, shortestPx(kShortRun));
    }
    emit(spine, index, out);
  }

 private:
  [[nodiscard]] std::uint32_t endOfSamples(std::uint32_t index) const {
    return index + 1 < samples_.begin.size() ? samples_.begin[index + 1]
                                             : static_cast<std::uint32_t>(samples_.samples.size());
  }

  [[nodiscard]] float arcOf(std::uint32_t index, std::uint32_t sample) const {
    return static_cast<float>(sample - samples_.begin[index]) / samples_.perPx[index];
  }

  [[nodiscard]] bool isDoubled(std::uint32_t sample) const {
    const float outer = samples_.samples[sample].nestedIn;
    return outer >= 0.0F && isSeen_[static_cast<std::size_t>(outer)] != 0;
  }

  /// Makes stretches hidden around samples that are nested in what is seen.
  void leaveOutDoubled(std::uint32_t index) {
    whole_.swap(stretches_);
    stretches_.clear();
    std::uint32_t sample = samples_.begin[index];
    const std::uint32_t end = endOfSamples(index);
    for (const Stretch& stretch : whole_) {
      // A sample stands for the half pixel to either side of it.
      for (; sample + 1 < end && arcOf(index, sample) + 0.5F / samples_.perPx[index] < stretch.end;
           ++sample) {
        if (isDoubled(sample) != isDoubled(sample + 1))
          stretches_.push_back(
              {arcOf(index, sample) + 0.5F / samples_.perPx[index],
               stretch.visible && !isDoubled(sample)});
      }
      stretches_.push_back({stretch.end, stretch.visible && !isDoubled(sample)});
    }
    join();
  }

  [[nodiscard]] std::uint32_t after(const SpineSet::Spine& spine, std::uint32_t i) const {
    return i + 1 < spine.end ? i + 1 : spine.begin;
  }

  /// Where along the spine's segment i (0 … 1) the line's segment `point` is at t.
  [[nodiscard]] float shareOf(std::uint32_t i, std::uint32_t next, std::uint32_t point, float t)
      const {
    const PolylineSet::Line& line = lines_.lines[line_];
    const std::uint32_t to = point + 1 < line.end ? point + 1 : line.begin;
    const glm::dvec3 p =
        glm::mix(glm::dvec3(lines_.points[point]), glm::dvec3(lines_.points[to]), double{t});
    const glm::dvec4 clip = clipFromGrid_ * glm::dvec4(p, 1.0);
    if (clip.z < -clip.w || !(clip.w > 0.0)) return 0.0F;  // before the near plane
    const glm::vec2 pixel(pixelFromClip(clip, viewport_));
    const glm::vec2 along = spines_.exact[next] - spines_.exact[i];
    const float length2 = glm::dot(along, along);
    if (!(length2 > 0.0F)) return 1.0F;
    return std::clamp(glm::dot(pixel - spines_.exact[i], along) / length2, 0.0F, 1.0F);
  }

  void collect(const SpineSet::Spine& spine) {
    stretches_.clear();
    line_ = spine.line;
    const PolylineSet::Line& line = lines_.lines[line_];
    const std::uint32_t segments = spine.closed ? spine.size() : spine.size() - 1;
    for (std::uint32_t k = 0; k < segments; ++k) {
      const std::uint32_t i = spine.begin + k;
      const std::uint32_t next = after(spine, i);
      const float from = arcs_.arc[i];
      const float to = k + 1 == segments && spine.closed ? length_ : arcs_.arc[next];
      // Points that fell together left their segments to the one that goes on.
      std::uint32_t point = spines_.source[i];
      const std::uint32_t past = spines_.source[next];
      float share = 0.0F;
      bool visible = false;
      do {
        for (const ResolvedLines::Piece& piece : resolved_.piecesOf(point)) {
          visible = piece.visible;
          share = std::max(share, shareOf(i, next, point, piece.end));
          stretches_.push_back({from + share * (to - from), visible});
        }
        point = point + 1 < line.end ? point + 1 : line.begin;
      } while (point != past && past != spines_.source[i] && share < 1.0F);
      stretches_.push_back({to, visible});
    }
    stretches_.back().end = length_;
  }

  /// Stretches of one visibility become one; those of no length go.
  void join() {
    std::size_t kept = 0;
    float begin = 0.0F;
    for (const Stretch& stretch : stretches_) {
      if (!(stretch.end > begin)) continue;
      begin = stretch.end;
      if (kept > 0 && stretches_[kept - 1].visible == stretch.visible) {
        stretches_[kept - 1].end = stretch.end;
      } else {
        stretches_[kept++] = stretch;
      }
    }
    stretches_.resize(kept);
  }

  [[nodiscard]] float lengthOf(std::size_t i, bool closed) const {
    const float own = stretches_[i].end - (i > 0 ? stretches_[i - 1].end : 0.0F);
    // On a loop the first and the last may be one.
    const bool wraps =
        closed && stretches_.size() > 1 && stretches_.front().visible == stretches_.back().visible;
    if (wraps && i == 0) return own + lengthOf(stretches_.size() - 1, false);
    if (wraps && i + 1 == stretches_.size()) return own + stretches_.front().end;
    return own;
  }

  /// Stretches of a visibility that are shorter than the picture shows take on that of what is
  /// around them.
  void suppress(bool closed, bool visible, float shortest) {
    const std::size_t count = stretches_.size();
    if (count < 2) return;
    std::vector<std::uint8_t> goes(count, 0);
    for (std::size_t i = 0; i < count; ++i)
      goes[i] = stretches_[i].visible == visible && lengthOf(i, closed) < shortest ? 1 : 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (goes[i] != 0) stretches_[i].visible = !visible;
    }
    join();
  }

  /// Whether what a bridge joins is visible a little before it. runs: with those of its spine.
  [[nodiscard]] bool isJoinedVisible(
      const SpineSet::Spine::Joint& joint,
      const std::vector<VisibleRun>& runs) const {
    const float arc = arcBefore(spines_, arcs_, joint);
    const VisibleRun* at = nullptr;    // the last that begins before it
    const VisibleRun* last = nullptr;  // of a loop: goes on over its start
    for (const VisibleRun& run : runs) {
      if (run.spine != joint.spine) continue;
      if (run.arc <= arc && (at == nullptr || run.arc > at->arc)) at = &run;
      if (last == nullptr || run.arc > last->arc) last = &run;
    }
    if (at == nullptr) at = last;
    return at != nullptr && at->visible;
  }

  [[nodiscard]] glm::vec2 pointAt(const SpineSet::Spine& spine, float arc) const {
    const auto first = arcs_.arc.begin() + spine.begin;
    const auto past = arcs_.arc.begin() + spine.end;
    const auto above = std::upper_bound(first, past, arc);
    const auto i = static_cast<std::uint32_t>(std::max<std::ptrdiff_t>(above - first, 1) - 1);
    const std::uint32_t at = spine.begin + i;
    if (at + 1 == spine.end && !spine.closed) return spines_.points[at];
    const float to = at + 1 == spine.end ? length_ : arcs_.arc[at + 1];
    const float span = to - arcs_.arc[at];
    const float share = span > 0.0F ? std::clamp((arc - arcs_.arc[at]) / span, 0.0F, 1.0F) : 0.0F;
    return glm::mix(spines_.points[at], spines_.points[after(spine, at)], share);
  }

  /// The points strictly between two distances.
  void appendBetween(
      const SpineSet::Spine& spine,
      float from,
      float to,
      std::vector<glm::vec2>& points) const {
    for (std::uint32_t i = spine.begin; i < spine.end; ++i) {
      if (arcs_.arc[i] > from && arcs_.arc[i] < to) points.push_back(spines_.points[i]);
    }
  }

  void emit(const SpineSet::Spine& spine, std::uint32_t index, std::vector<VisibleRun>& out) const {
    if (stretches_.size() == 1) {
      VisibleRun run{{}, index, 0.0F, stretches_.front().visible, spine.closed};
      run.points.assign(spines_.points.begin() + spine.begin, spines_.points.begin() + spine.end);
      out.push_back(std::move(run));
      return;
    }
    const bool wraps = spine.closed && stretches_.front().visible == stretches_.back().visible;
    const std::size_t count = stretches_.size() - (wraps ? 1 : 0);
    for (std::size_t k = 0; k < count; ++k) {
      const bool isAcross = wraps && k == 0;  // from the last cut over the loop's start
      const float from = isAcross ? stretches_[count - 1].end
                         : k > 0  ? stretches_[k - 1].end
                                  : 0.0F;
      const float to = stretches_[k].end;
      VisibleRun run{{pointAt(spine, from)}, index, from, stretches_[k].visible, false};
      if (isAcross) {
        appendBetween(spine, from, length_, run.points);
        run.points.push_back(spines_.points[spine.begin]);
        appendBetween(spine, 0.0F, to, run.points);
      } else {
        appendBetween(spine, from, to, run.points);
      }
      // The end of a loop is its beginning.
      run.points.push_back(
          to < length_ ? pointAt(spine, to)
                       : spines_.points[spine.closed ? spine.begin : spine.end - 1]);
      out.push_back(std::move(run));
    }
  }

  const SpineSet& spines_;
  const SpineArcs& arcs_;
  const PolylineSet& lines_;
  const ResolvedLines& resolved_;
  Viewport viewport_;
  glm::dmat4 clipFromGrid_;
  const SpineSamples& samples_;
  int closedGap_;
  std::vector<std::uint8_t> isSeen_;  // by sample
  // Of the spine at hand.
  float length_ = 0.0F;
  std::uint32_t line_ = 0;
  std::vector<Stretch> stretches_;
  std::vector<Stretch> whole_;  // what it was
};

}  // namespace

std::vector<VisibleRun> cutAtVisibility(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const PolylineSet& lines,
    const ResolvedLines& resolved,
    const LineScene& scene,
    const SpineSamples& samples,
    int closedGap) {
  std::vector<VisibleRun> runs;
  SpineCutter cutter(spines, arcs, lines, resolved, scene, samples, closedGap);
  for (std::uint32_t i = 0; i < spines.spines.size(); ++i)
    cutter.see(i);
  for (std::uint32_t i = 0; i < spines.spines.size(); ++i)
    cutter.cut(i, runs);
  return runs;
}

}  // namespace limn
