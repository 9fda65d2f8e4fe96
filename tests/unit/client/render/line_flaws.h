// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/image.h"
#include "tests/unit/client/render/pixel_groups.h"
#include "tests/unit/client/render/skeleton.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

/// What an illustrator would mark in a finished drawing: lines that break off and go on, and lines
/// drawn twice. An oracle that has the picture alone, dark lines on white paper, and knows nothing
/// of how lines are found.
///
/// A break: two ends of lines that face each other over a little paper.
///
/// Doubled lines: slits that are too narrow are taken for ink, and where that makes ink thicker
/// than a line for a while, there are two lines, or more, that look like one drawn twice; with a
/// slit in between or without. Lines that meet or cross do so too, but not for long before they
/// part, hence `joinPx`. Parts that a model has close together, such as fins, are found like any
/// other.
namespace limn::flaws {

struct FlawOptions {
  int darkness = 96;       // of a pixel that is ink; 255 is black on white
  double widthPx = 2.6;    // of a line
  double leastSpurPx = 4;  // shorter branches of a skeleton, and dots, are no lines

  double leastBreakPx = 2.5;
  double mostBreakPx = 12;
  double facing = 35;  // degrees that an end may point away from the other end

  double nearness = 2;     // line widths from middle to middle of lines that are too near
  double thickness = 1.7;  // line widths, from which ink is more than a line
  double solid = 3.2;      // the same, more than two lines with their slit: a flaw however short
  double leastDoublePx = 6;
  int bridgePx = 3;   // between parts of one run
  double joinPx = 8;  // that two lines may stay near where they part
  double fork = 55;   // degrees up to which lines that leave a junction part
};

/// A break, from ink to ink; or a run of doubled lines, along them. Its corners in pixels.
struct Flaw {
  glm::ivec2 low{0};
  glm::ivec2 high{0};
  double px = 0;
};

struct Flaws {
  std::vector<Flaw> breaks;  // largest first, as are
  std::vector<Flaw> doubles;
};

/// Dots are no lines, and none in the way of one.
inline void dropDots(PixelMarks& ink, double leastPx) {
  for (const std::vector<glm::ivec2>& group : pixelGroups(ink, 1)) {
    const auto isFar = [&](glm::ivec2 p) { return chessboard(p - group.front()) >= leastPx; };
    if (std::any_of(group.begin(), group.end(), isFar)) continue;
    for (const glm::ivec2& p : group)
      ink.marks[ink.index(p)] = 0;
  }
}

inline double cosine(double degrees) {
  return std::cos(glm::radians(degrees));
}

/// How much paper there is between two pixels of ink; 0 if there is ink in the middle of it.
inline double paperBetween(const PixelMarks& ink, glm::ivec2 a, glm::ivec2 b) {
  const double length = glm::distance(glm::dvec2(a), glm::dvec2(b));
  const int steps = static_cast<int>(4 * length) + 1;
  int first = steps;
  int last = 0;
  int paper = 0;
  for (int k = 0; k <= steps; ++k) {
    const glm::dvec2 p = glm::mix(glm::dvec2(a), glm::dvec2(b), k / static_cast<double>(steps));
    if (ink.at(glm::ivec2(glm::round(p))) != 0) continue;
    first = std::min(first, k);
    last = k;
    ++paper;
  }
  return paper == last - first + 1 ? length * paper / steps : 0.0;
}

/// Each end is of one break at most, the shortest.
inline std::vector<Flaw>
findBreaks(const PixelMarks& ink, const PixelMarks& skeleton, const FlawOptions& options) {
  struct End {
    glm::ivec2 at;
    glm::dvec2 direction;
  };

  struct Pair {
    std::size_t a;
    std::size_t b;
    double px;
  };

  std::vector<End> ends;
  for (const glm::ivec2& end : endsOf(skeleton)) {
    const glm::ivec2 before = back(skeleton, end, 6).pixels.back().first;
    ends.push_back({end, glm::normalize(glm::dvec2(end - before))});
  }
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < ends.size(); ++a) {
    for (std::size_t b = a + 1; b < ends.size(); ++b) {
      const glm::dvec2 across = ends[b].at - ends[a].at;
      const double length = glm::length(across);
      if (length > options.mostBreakPx + 2 * options.widthPx) continue;
      const double least = length * cosine(options.facing);
      if (glm::dot(ends[a].direction, across) < least) continue;
      if (glm::dot(ends[b].direction, -across) < least) continue;
      const double px = paperBetween(ink, ends[a].at, ends[b].at);
      if (px >= options.leastBreakPx && px <= options.mostBreakPx) pairs.push_back({a, b, px});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) {
    return p.px < q.px;
  });
  std::vector<bool> taken(ends.size(), false);
  std::vector<Flaw> breaks;
  for (const auto& [a, b, px] : pairs) {
    if (taken[a] || taken[b]) continue;
    taken[a] = taken[b] = true;
    breaks.push_back({glm::min(ends[a].at, ends[b].at), glm::max(ends[a].at, ends[b].at), px});
  }
  return breaks;
}

/// Where a picture is ink, with so many marks to a pixel's side.
inline PixelMarks inkOf(const Image& picture, int scale, int darkness) {
  PixelMarks ink{picture.width * scale, picture.height * scale, {}};
  ink.marks.reserve(static_cast<std::size_t>(ink.width) * static_cast<std::size_t>(ink.height));
  const auto dark = [&](int x, int y) {
    const glm::ivec2 p = glm::clamp({x, y}, glm::ivec2(0), {picture.width - 1, picture.height - 1});
    const auto i = static_cast<std::size_t>(p.y) * static_cast<std::size_t>(picture.width) +
                   static_cast<std::size_t>(p.x);
    return 255.0 - picture.rgba[4 * i + 1];
  };
  for (int y = 0; y < ink.height; ++y) {
    for (int x = 0; x < ink.width; ++x) {
      const glm::dvec2 at = (glm::dvec2(x, y) + 0.5) / static_cast<double>(scale) - 0.5;
      const glm::ivec2 p(glm::floor(at));
      const glm::dvec2 t = at - glm::dvec2(p);
      const double upper = glm::mix(dark(p.x, p.y), dark(p.x + 1, p.y), t.x);
      const double lower = glm::mix(dark(p.x, p.y + 1), dark(p.x + 1, p.y + 1), t.x);
      ink.marks.push_back(glm::mix(upper, lower, t.y) >= darkness ? 1 : 0);
    }
  }
  return ink;
}

/// Whether two of the lines that leave a junction go much the same way.
inline bool isFork(const PixelMarks& skeleton, glm::ivec2 junction, double armPx, double degrees) {
  std::vector<glm::ivec2> arms;
  for (const auto& [p, px] : around(skeleton, junction, armPx).pixels) {
    const auto isSame = [&p = p](glm::ivec2 q) { return chessboard(p - q) <= 2; };
    if (px > armPx - 1.5 && std::none_of(arms.begin(), arms.end(), isSame)) arms.push_back(p);
  }
  const auto direction = [&](glm::ivec2 p) { return glm::normalize(glm::dvec2(p - junction)); };
  for (std::size_t k = 0; k < arms.size(); ++k) {
    for (std::size_t l = 0; l < k; ++l) {
      if (glm::dot(direction(arms[k]), direction(arms[l])) > cosine(degrees)) return true;
    }
  }
  return false;
}

/// Junctions where lines part that may have been together before.
inline std::vector<glm::ivec2> forksOf(const PixelMarks& skeleton, double armPx, double degrees) {
  std::vector<glm::ivec2> forks;
  for (const glm::ivec2& p : pixelsOf(skeleton)) {
    if (neighbours(skeleton, p) < 3 || !isFork(skeleton, p, armPx, degrees)) continue;
    // The pixels of a junction are one.
    const auto isSame = [&](glm::ivec2 q) { return chessboard(p - q) <= 4; };
    if (std::none_of(forks.begin(), forks.end(), isSame)) forks.push_back(p);
  }
  return forks;
}

/// Runs of lines too near one another: one line that is too thick, once their slits are ink.
inline std::vector<Flaw> findDoubles(const Image& picture, const FlawOptions& options) {
  constexpr int kScale = 2;  // a slit may be as wide as a pixel
  constexpr double kAxisPx = 4;
  constexpr double kArmPx = 12;
  constexpr int kForkPx = 5;
  const double widthPx = kScale * options.widthPx;
  const PixelMarks ink = closed(
      inkOf(picture, kScale, options.darkness),
      discOf((options.nearness - 1) * widthPx / 2));
  PixelMarks skeleton = ink;
  thin(skeleton);
  dropSpurs(skeleton, kScale * options.leastSpurPx);
  const Disc thick = discOf((options.thickness * widthPx + 1) / 2);
  const Disc solid = discOf((options.solid * widthPx + 1) / 2);
  const std::vector<glm::ivec2> forks = forksOf(skeleton, kScale * kArmPx, options.fork);
  PixelMarks doubled = skeleton;
  for (const glm::ivec2& p : pixelsOf(skeleton))
    doubled.marks[ink.index(p)] = isFull(ink, p, thick) ? 1 : 0;
  std::vector<Flaw> doubles;
  for (const std::vector<glm::ivec2>& group : pixelGroups(doubled, kScale * options.bridgePx)) {
    Flaw flaw{group.front(), group.front(), 0.0};
    for (const glm::ivec2& p : group) {
      flaw.low = glm::min(flaw.low, p);
      flaw.high = glm::max(flaw.high, p);
      const glm::dvec2 along = axis(around(skeleton, p, kScale * kAxisPx));
      flaw.px += 1.0 / (kScale * std::max(std::abs(along.x), std::abs(along.y)));
    }
    int parts = 0;
    for (const glm::ivec2& p : forks) {
      const int away = chessboard(p - glm::clamp(p, flaw.low, flaw.high));
      parts += away <= kScale * kForkPx ? 1 : 0;
    }
    // Lines part at the two ends of a run at most; in a tangle they part everywhere.
    const double exempt = options.joinPx * std::min(parts, 2);
    const double extent = glm::distance(glm::dvec2(flaw.low), glm::dvec2(flaw.high)) / kScale;
    const bool isSolid = std::any_of(group.begin(), group.end(), [&](glm::ivec2 p) {
      return isFull(ink, p, solid);
    });
    if (!isSolid && extent - exempt < options.leastDoublePx) continue;
    flaw.px = std::max(flaw.px, extent);
    flaw.low /= kScale;
    flaw.high /= kScale;
    doubles.push_back(flaw);
  }
  return doubles;
}

/// Cost: some 0.1 s for a picture of 1024 x 1024.
inline Flaws find(const Image& picture, const FlawOptions& options = {}) {
  PixelMarks ink = inkOf(picture, 1, options.darkness);
  dropDots(ink, options.leastSpurPx);
  PixelMarks skeleton = ink;
  thin(skeleton);
  dropSpurs(skeleton, options.leastSpurPx);
  Flaws flaws{findBreaks(ink, skeleton, options), findDoubles(picture, options)};
  const auto larger = [](const Flaw& a, const Flaw& b) { return a.px > b.px; };
  std::stable_sort(flaws.breaks.begin(), flaws.breaks.end(), larger);
  std::stable_sort(flaws.doubles.begin(), flaws.doubles.end(), larger);
  return flaws;
}

}  // namespace limn::flaws
