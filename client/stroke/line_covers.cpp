// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/line_covers.h"

#include "client/stroke/view_distance.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr float kStepPx = 2.0F;
/// A bump's contour and the outline that it interrupts lie within this of one another.
constexpr float kReachPx = 2.5F;
/// A bump's contour that lies farther than this inside of what the outline bounds leaves the
/// outline to be seen, and would double it.
constexpr float kInsidePx = 0.75F;
/// Outlines farther behind are no bump's, but what lies at its place behind the model.
constexpr float kHighestPx = 24.0F;
constexpr float kCellPx = 8.0F;
constexpr int kMostCells = 512;  // along a side: pictures are no larger than 4096

bool isOutline(const SpineSet::Spine& spine) {
  return !isInner(spine.kind);
}

/// A short piece of a spine.
struct Step {
  glm::vec2 at;
  glm::vec2 along;  // as long as the step
  float depth;
};

/// visit(Step) for every step along a spine.
template <class Visit>
void walk(const SpineSet& spines, const SpineSet::Spine& spine, Visit visit) {
  for (std::uint32_t i = spine.begin; i < spine.end; ++i) {
    if (i + 1 == spine.end && !spine.closed) return;
    const std::uint32_t next = i + 1 < spine.end ? i + 1 : spine.begin;
    const glm::vec2 along = spines.points[next] - spines.points[i];
    const float length2 = glm::dot(along, along);
    const float steps =
        length2 <= kStepPx * kStepPx ? 1.0F : std::ceil(std::sqrt(length2) / kStepPx);
    for (float k = 0.5F; k < steps; ++k) {
      const float t = k / steps;
      visit(Step{
          spines.points[i] + t * along,
          along / steps,
          glm::mix(spines.depth[i], spines.depth[next], t)});
    }
  }
}

/// Places along small outlines, by cell of the picture.
class SmallOutlines {
 public:
  struct Place {
    Step step;
    std::uint32_t spine;
  };

  SmallOutlines(const SpineSet& spines, std::span<const std::uint8_t> isSmall) {
    std::vector<Place> unsorted;
    for (std::uint32_t s = 0; s < spines.spines.size(); ++s) {
      if (isSmall[s] == 0 || !isOutline(spines.spines[s])) continue;
      low_ = unsorted.empty() ? spines.spines[s].low : glm::min(low_, spines.spines[s].low);
      high_ = unsorted.empty() ? spines.spines[s].high : glm::max(high_, spines.spines[s].high);
      walk(spines, spines.spines[s], [&](const Step& step) { unsorted.push_back({step, s}); });
    }
    if (unsorted.empty()) return;
    size_ = glm::clamp(cellOf(high_) + 1, glm::ivec2(1), glm::ivec2(kMostCells));
    // First how many, then where each cell ends; filling from the back leaves where it begins.
    cells_.assign(static_cast<std::size_t>(size_.x * size_.y) + 1, 0);
    for (const Place& place : unsorted)
      ++cells_[numberOf(cellOf(place.step.at))];
    for (std::size_t i = 1; i < cells_.size(); ++i)
      cells_[i] += cells_[i - 1];
    places_.resize(unsorted.size());
    isNear_.assign(cells_.size(), 0);
    for (const Place& place : unsorted) {
      forRows(place.step.at, [&](std::size_t first, std::size_t last) {
        std::fill(isNear_.begin() + first, isNear_.begin() + last + 1, 1);
      });
    }
    for (std::size_t i = unsorted.size(); i-- > 0;)
      places_[--cells_[numberOf(cellOf(unsorted[i].step.at))]] = unsorted[i];
  }

  [[nodiscard]] bool isEmpty() const { return places_.empty(); }

  [[nodiscard]] bool mayMeet(const SpineSet::Spine& spine) const {
    return glm::all(glm::lessThan(spine.low - kReachPx, high_)) &&
           glm::all(glm::greaterThan(spine.high + kReachPx, low_));
  }

  /// visit(place) for those in the cells within reach of a point.
  template <class Visit>
  void forNear(const glm::vec2& at, Visit visit) const {
    if (isNear_[numberOf(cellOf(at))] == 0) return;
    forRows(at, [&](std::size_t first, std::size_t last) {
      for (std::uint32_t i = cells_[first]; i < cells_[last + 1]; ++i)
        visit(places_[i]);
    });
  }

 private:
  /// visit(first, last) for the cells of each row within reach of a point.
  template <class Visit>
  void forRows(const glm::vec2& at, Visit visit) const {
    const glm::ivec2 first = glm::max(cellOf(at - kReachPx), glm::ivec2(0));
    const glm::ivec2 last = glm::min(cellOf(at + kReachPx), size_ - 1);
    if (first.x > last.x) return;
    for (int y = first.y; y <= last.y; ++y)
      visit(numberOf({first.x, y}), numberOf({last.x, y}));
  }

  [[nodiscard]] glm::ivec2 cellOf(const glm::vec2& at) const {
    return glm::ivec2((at - low_) * (1.0F / kCellPx));
  }

  [[nodiscard]] std::size_t numberOf(const glm::ivec2& cell) const {
    const glm::ivec2 c = glm::clamp(cell, glm::ivec2(0), size_ - 1);
    return static_cast<std::size_t>(c.y * size_.x + c.x);
  }

  glm::vec2 low_{0.0F};
  glm::vec2 high_{0.0F};
  glm::ivec2 size_{0};
  std::vector<std::uint32_t> cells_;  // first place of each cell, and one past the last
  std::vector<Place> places_;
  std::vector<std::uint8_t> isNear_;  // by cell: there is a place within reach of it
};

}  // namespace

std::vector<float> coveredLengths(
    const SpineSet& spines,
    std::span<const std::uint8_t> isSmall,
    const Camera& camera,
    const Viewport& viewport) {
  std::vector<float> covered(spines.spines.size(), 0.0F);
  const SmallOutlines small(spines, isSmall);
  if (small.isEmpty()) return covered;
  std::vector<std::uint32_t> lastStep(spines.spines.size(), 0);
  std::uint32_t number = 0;
  for (std::uint32_t s = 0; s < spines.spines.size(); ++s) {
    const SpineSet::Spine& spine = spines.spines[s];
    if (isSmall[s] != 0 || !isOutline(spine) || !small.mayMeet(spine)) continue;
    walk(spines, spine, [&](const Step& step) {
      ++number;
      small.forNear(step.at, [&](const SmallOutlines::Place& place) {
        const glm::vec2 away = place.step.at - step.at;
        if (glm::dot(away, away) > kReachPx * kReachPx || place.step.depth >= step.depth ||
            lastStep[place.spine] == number)
          return;
        // Outlines have what they bound to their left: the bump bounds it to the same side.
        if (!(glm::dot(place.step.along, step.along) > 0.0F)) return;
        const glm::vec2 inside(step.along.y, -step.along.x);
        if (glm::dot(away, inside) > kInsidePx * glm::length(inside)) return;
        const float distance = viewDistance(camera, step.depth);
        const float behind = (distance - viewDistance(camera, place.step.depth)) *
                             pixelsPerUnit(camera, viewport, distance);
        if (behind > kHighestPx) return;
        lastStep[place.spine] = number;
        covered[place.spine] += glm::length(step.along);
      });
    });
  }
  return covered;
}

}  // namespace limn
