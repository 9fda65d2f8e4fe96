// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/fold_backs.h"

#include "client/stroke/scene_faces.h"

#include <algorithm>
#include <limits>

namespace limn {
namespace {

/// A swallowtail's line is at most so many times as long as it reaches out.
constexpr float kLongest = 3.5F;

/// Cosine of the largest turn of a line where a swallowtail is cut out of it.
constexpr float kStraightOn = 0.5F;

/// Branches as near as this touch.
constexpr float kTouchPx = 0.7F;

/// Longer segments are no noise, and leaving a part of one out would show.
constexpr float kLongestSegmentPx = 4.0F;

bool cross(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c, const glm::vec2& d) {
  const auto side = [](const glm::vec2& p, const glm::vec2& q, const glm::vec2& r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  };
  return side(a, b, c) * side(a, b, d) <= 0.0F && side(c, d, a) * side(c, d, b) <= 0.0F;
}

/// Looks for the swallowtails of one spine after another.
class FoldFinder {
 public:
  FoldFinder(const PolylineSet& lines, const LineScene& scene, float reachPx, SpineSet& spines)
      : lines_(lines),
        faces_(scene),
        reachPx_(reachPx),
        spines_(spines) {}

  /// Moves what is left of a spine to `size` and on; the new size.
  std::uint32_t keep(SpineSet::Spine& spine, std::uint32_t size) {
    const std::uint32_t begin = size;
    const bool isFoldable = mayFold(spine);
    std::uint32_t i = spine.begin;
    // Where it turns back next, and again: a swallowtail does twice.
    std::uint32_t turn = isFoldable ? nextTurn(spine, i + 1) : spine.end;
    std::uint32_t again = nextTurn(spine, turn + 1);
    while (i < spine.end) {
      spines_.movePoints(i, i + 1, size++);
      while (turn <= i) {
        turn = again;
        again = nextTurn(spine, turn + 1);
      }
      const bool isNear = again < spine.end && isInReach(i, turn) && isInReach(i, again);
      i = isNear ? endOfFold(spine, i, {begin, size}) : i + 1;
    }
    spine.begin = begin;
    spine.end = size;
    if (spine.size() < 3) spine.closed = false;
    return size;
  }

 private:
  /// The first point from i on at which a spine turns back, or its end.
  [[nodiscard]] std::uint32_t nextTurn(const SpineSet::Spine& spine, std::uint32_t i) const {
    while (i + 1 < spine.end && !turnsBack(spines_.points, i - 1, i, i + 1))
      ++i;
    return i + 1 < spine.end ? i : spine.end;
  }

  [[nodiscard]] bool isInReach(std::uint32_t a, std::uint32_t b) const {
    const glm::vec2 step = spines_.points[b] - spines_.points[a];
    return glm::dot(step, step) < reachPx_ * reachPx_;
  }

  [[nodiscard]] bool mayFold(const SpineSet::Spine& spine) const {
    const PolylineSet::Line& line = lines_.lines[spine.line];
    return line.isContour() && line.back != PolylineSet::Back::kSeen;
  }

  /// What is kept of a spine so far, its points one after another.
  struct Kept {
    std::uint32_t begin;
    std::uint32_t end;
  };

  /// Where a spine goes on after point i, the last one kept: i + 1, or past a swallowtail that
  /// begins there.
  [[nodiscard]] std::uint32_t
  endOfFold(const SpineSet::Spine& spine, std::uint32_t i, const Kept& kept) const {
    const std::vector<glm::vec2>& p = spines_.points;
    // It turns back twice.
    float length = 0.0F;
    int turns = 0;
    std::uint32_t found = i + 1;
    float nearest = kTouchPx;
    for (std::uint32_t j = i + 1; j + 1 < spine.end; ++j) {
      length += glm::distance(p[j - 1], p[j]);
      if (length > kLongest * reachPx_ || glm::distance(p[i], p[j]) > reachPx_) break;
      if (turnsBack(p, j - 1, j, j + 1)) ++turns;
      if (turns < 2) continue;
      if (glm::distance(p[j], p[j + 1]) > kLongestSegmentPx) continue;
      if (cross(p[i], p[i + 1], p[j], p[j + 1])) {
        found = j + 1;
        nearest = 0.0F;
      } else if (glm::distance(p[i], p[j + 1]) < nearest) {
        nearest = glm::distance(p[i], p[j + 1]);
        found = j + 1;
      }
    }
    const bool isFold = found > i + 1 && goesOn(spine, kept, found) &&
                        isHiddenBetween(lines_.lines[spine.line], i, found);
    return isFold ? found : i + 1;
  }

  /// Whether what is kept and the branch that begins at a point are of one line: at a corner a tip
  /// is where others end.
  [[nodiscard]] bool goesOn(const SpineSet::Spine& spine, const Kept& kept, std::uint32_t start)
      const {
    const std::vector<glm::vec2>& p = spines_.points;
    const std::uint32_t end = kept.end - 1;
    std::uint32_t before = end;
    while (before > kept.begin && glm::distance(p[before], p[end]) < reachPx_)
      --before;
    std::uint32_t after = start;
    while (after + 1 < spine.end && glm::distance(p[after], p[start]) < reachPx_)
      ++after;
    const glm::vec2 in = p[end] - p[before];
    const glm::vec2 out = p[after] - p[start];
    return glm::dot(in, out) > kStraightOn * glm::length(in) * glm::length(out);
  }

  [[nodiscard]] bool
  isHiddenBetween(const PolylineSet::Line& line, std::uint32_t from, std::uint32_t to) const {
    for (std::uint32_t i = from; i < to; ++i) {
      if (faces_.hidesSmooth(lines_, line, spines_.source[i])) return true;
    }
    return false;
  }

  const PolylineSet& lines_;
  SceneFaces faces_;
  float reachPx_;
  SpineSet& spines_;
};

}  // namespace

void cutFoldBacks(
    const PolylineSet& lines,
    const LineScene& scene,
    float reachPx,
    SpineSet& spines) {
  FoldFinder finder(lines, scene, reachPx, spines);
  std::uint32_t size = 0;
  for (SpineSet::Spine& spine : spines.spines)
    size = finder.keep(spine, size);
  spines.resizePoints(size);
}

}  // namespace limn
