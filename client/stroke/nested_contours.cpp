// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/nested_contours.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

/// Contours so many widths of a stroke inside another are nested in it: from there on there is
/// paper between them.
constexpr float kNestedWidths = 1.3F;

/// A place stands for so many samples, a pixel apart: enough for what is some pixels long.
constexpr std::uint32_t kStep = 3;

constexpr float kCellPx = 6.0F;

/// Contours are nested where their directions differ by at most this angle's cosine.
constexpr float kSameWay = 0.85F;

/// Nearer than this they are one line to the eye already, and which is outside is rounding.
constexpr float kLeastPx = 0.4F;

/// Aside from where a place looks for an outer one, at most.
constexpr float kAsidePx = 1.6F;

// Along a line, in reaches:
constexpr float kOwnReaches = 4.0F;    // as near, it is the same contour
constexpr float kLeastReaches = 2.5F;  // nested for less is a crossing, or noise
constexpr float kScrapReaches = 1.5F;  // apart for less, before or after what is nested, is a scrap

}  // namespace

void NestedContours::begin(const Viewport& viewport, float reachPx) {
  reachPx_ = reachPx;
  ownPlaces_ = static_cast<std::uint32_t>(std::ceil(kOwnReaches * reachPx / kStep));
  size_ = glm::ivec2(glm::ceil(glm::vec2(viewport.width, viewport.height) / kCellPx));
  cells_.assign(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y), {});
  places_.clear();
}

glm::ivec2 NestedContours::cellOf(const glm::vec2& pixel) const {
  return glm::clamp(glm::ivec2(pixel / kCellPx), glm::ivec2(0), size_ - 1);
}

bool NestedContours::isOwn(std::uint32_t a, std::uint32_t b) const {
  return places_[a].stretch == places_[b].stretch && (a < b ? b - a : a - b) <= ownPlaces_;
}

void NestedContours::add(
    const glm::vec2& pixel,
    const glm::vec2& outward,
    std::uint32_t sample,
    bool goesOn) {
  const glm::ivec2 at = cellOf(pixel);
  Cell& cell = cells_[static_cast<std::size_t>(at.y * size_.x + at.x)];
  const auto index = static_cast<std::uint32_t>(places_.size());
  Place& place = places_.emplace_back();
  place.pixel = pixel;
  place.outward = outward;
  place.stretch = index == 0 ? 0 : places_[index - 1].stretch + (goesOn ? 0 : 1);
  place.sample = sample;
  place.next = cell.first;
  if (cell.first != kNone && !isOwn(cell.first, index)) cell.hasOthers = true;
  cell.first = index;
}

std::uint32_t NestedContours::outside(std::uint32_t index) const {
  const Place& place = places_[index];
  const glm::vec2 end = place.pixel + reachPx_ * place.outward;
  const glm::ivec2 low = cellOf(glm::min(place.pixel, end) - kAsidePx);
  const glm::ivec2 high = cellOf(glm::max(place.pixel, end) + kAsidePx);
  std::uint32_t found = kNone;
  float nearest = reachPx_;
  for (int y = low.y; y <= high.y; ++y) {
    for (int x = low.x; x <= high.x; ++x) {
      const Cell& cell = cells_[static_cast<std::size_t>(y * size_.x + x)];
      if (cell.first == kNone || (!cell.hasOthers && isOwn(cell.first, index))) continue;
      for (std::uint32_t i = cell.first; i != kNone; i = places_[i].next) {
        const Place& other = places_[i];
        const glm::vec2 step = other.pixel - place.pixel;
        const float away = glm::dot(step, place.outward);
        if (away < kLeastPx || away >= nearest || other.fade < place.fade) continue;
        if (std::abs(step.x * place.outward.y - step.y * place.outward.x) > kAsidePx) continue;
        if (glm::dot(other.outward, place.outward) < kSameWay || isOwn(i, index)) continue;
        nearest = away;
        found = i;
      }
    }
  }
  return found;
}

// Short parts take on what is around them.
void NestedContours::evenOut() {
  const auto count = static_cast<std::uint32_t>(places_.size());
  const auto forParts = [&](auto visit) {
    for (std::uint32_t begin = 0, end = 0; begin < count; begin = end) {
      const bool isNested = outer_[begin] != kNone;
      while (end < count && (outer_[end] != kNone) == isNested &&
             places_[end].stretch == places_[begin].stretch)
        ++end;
      visit(begin, end, isNested);
    }
  };
  const auto set = [&](std::uint32_t begin, std::uint32_t end, std::uint32_t outer) {
    std::fill(outer_.begin() + begin, outer_.begin() + end, outer);
  };
  const auto isShorter = [&](std::uint32_t places, float reaches) {
    return static_cast<float>(kStep * places) < reaches * reachPx_;
  };
  forParts([&](std::uint32_t begin, std::uint32_t end, bool isNested) {
    if (isNested && isShorter(end - begin, kLeastReaches)) set(begin, end, kNone);
  });
  forParts([&](std::uint32_t begin, std::uint32_t end, bool isNested) {
    if (isNested || !isShorter(end - begin, kScrapReaches)) return;
    const std::uint32_t stretch = places_[begin].stretch;
    const auto outerAt = [&](std::uint32_t i) {
      return i < count && places_[i].stretch == stretch ? outer_[i] : kNone;
    };
    const std::uint32_t before = begin > 0 ? outerAt(begin - 1) : kNone;
    set(begin, end, before != kNone ? before : outerAt(end));
  });
}

void NestedContours::find(
    const Viewport& viewport,
    float widthPx,
    std::span<const LineFade> fades,
    SpineSamples& samples) {
  begin(viewport, kNestedWidths * widthPx);
  const glm::vec2 size(viewport.width, viewport.height);
  const auto sampleCount = static_cast<std::uint32_t>(samples.samples.size());
  for (std::size_t spine = 0; spine < samples.begin.size(); ++spine) {
    const std::uint32_t first = samples.begin[spine];
    const std::uint32_t end =
        spine + 1 < samples.begin.size() ? samples.begin[spine + 1] : sampleCount;
    for (std::uint32_t i = first; i < end; i += kStep) {
      const SpineSample& sample = samples.samples[i];
      if (sample.bias < 0.0F || sample.outward == glm::vec2(0.0F)) continue;
      const bool goesOn = i != first && !places_.empty() && places_.back().sample + kStep == i;
      add(sample.position * size, sample.outward, i, goesOn);
      places_.back().fade = fades[spine].visible;
    }
  }
  const auto count = static_cast<std::uint32_t>(places_.size());
  outer_.resize(count);
  isNested_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    outer_[i] = outside(i);
    isNested_[i] = outer_[i] != kNone ? 1 : 0;
  }
  for (std::uint32_t& outer : outer_) {
    if (outer != kNone && isNested_[outer] != 0) outer = kNone;
  }
  evenOut();
  for (std::uint32_t i = 0; i < count; ++i) {
    if (outer_[i] == kNone) continue;
    const std::uint32_t first = places_[i].sample;
    for (std::uint32_t k = first; k < std::min<std::uint32_t>(first + kStep, sampleCount); ++k) {
      if (samples.samples[k].first == samples.samples[first].first)
        samples.samples[k].nestedIn = static_cast<float>(places_[outer_[i]].sample);
    }
  }
}

}  // namespace limn
