// SPDX-License-Identifier: Apache-2.0
#include "client/svg/stroke_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace limn {
namespace {

struct Run {
  bool inked = false;
  std::size_t length = 0;
  std::size_t begin = 0;  // its first column
};

/// Neighbouring runs of one kind become one; the repeat is a circle.
void join(std::vector<Run>& runs) {
  std::vector<Run> joined;
  for (const Run& run : runs) {
    if (!joined.empty() && joined.back().inked == run.inked) {
      joined.back().length += run.length;
    } else {
      joined.push_back(run);
    }
  }
  if (joined.size() > 1 && joined.front().inked == joined.back().inked) {
    joined.front().length += joined.back().length;
    joined.front().begin = joined.back().begin;
    joined.pop_back();
  }
  runs = std::move(joined);
}

/// Ink and gap in turn, from an ink; nothing when there is no gap (or nothing but).
std::vector<Run> dashesOf(std::span<const std::uint8_t> inked) {
  std::vector<Run> runs;
  for (std::size_t x = 0; x < inked.size(); ++x)
    runs.push_back({inked[x] != 0, 1, x});
  join(runs);
  const std::size_t least = std::max<std::size_t>(1, inked.size() / 50);
  while (runs.size() > 1) {
    const auto shortest =
        std::min_element(runs.begin(), runs.end(), [](const Run& a, const Run& b) {
          return a.length < b.length;
        });
    if (shortest->length >= least) break;
    shortest->inked = !shortest->inked;
    join(runs);
  }
  if (runs.size() < 2) return {};
  if (!runs.front().inked) std::rotate(runs.begin(), runs.begin() + 1, runs.end());
  return runs;
}

/// Whether the dashes (or the gaps) differ by no more than a drawing hand's unsteadiness.
bool areAlike(std::span<const Run> runs, bool inked) {
  std::size_t least = std::numeric_limits<std::size_t>::max();
  std::size_t most = 0;
  for (const Run& run : runs) {
    if (run.inked != inked) continue;
    least = std::min(least, run.length);
    most = std::max(most, run.length);
  }
  return most <= 2 * least;
}

/// Where the first of equal dashes begins if those of `runs` are to have their middles where they
/// are, in the mean; dash and result: shares of the repeat.
float meanStart(std::span<const Run> runs, float dash, std::size_t columns) {
  const auto count = static_cast<float>(runs.size() / 2);
  const auto width = static_cast<float>(columns);
  float sum = 0.0F;
  for (std::size_t i = 0; i < runs.size(); i += 2) {
    const Run& run = runs[i];
    // The first may begin before the picture does.
    const std::size_t begin = run.begin < runs[0].begin ? run.begin + columns : run.begin;
    const float middle =
        (static_cast<float>(begin) + 0.5F * static_cast<float>(run.length)) / width;
    sum += middle - static_cast<float>(i / 2) / count;
  }
  const float start = sum / count - 0.5F * dash;
  return start - std::floor(start);
}

}  // namespace

StrokeShape strokeShape(std::span<const std::uint8_t> ink, int width) {
  StrokeShape shape;
  if (width < 1 || ink.size() < static_cast<std::size_t>(width)) return shape;
  const auto columns = static_cast<std::size_t>(width);
  std::vector<std::uint64_t> sums(columns, 0);
  for (std::size_t i = 0; i < ink.size(); ++i)
    sums[i % columns] += ink[i];
  // Inked is what holds half of what a well-inked column does.
  std::vector<std::uint64_t> sorted = sums;
  std::sort(sorted.begin(), sorted.end());
  const std::uint64_t limit = sorted[columns * 9 / 10] / 2;
  std::vector<std::uint8_t> isInked(columns);
  std::size_t inkedColumns = 0;
  std::size_t inkedPixels = 0;
  for (std::size_t x = 0; x < columns; ++x) {
    isInked[x] = sums[x] > limit ? 1 : 0;
    if (isInked[x] == 0) continue;
    ++inkedColumns;
    for (std::size_t i = x; i < ink.size(); i += columns) {
      if (ink[i] >= 128) ++inkedPixels;
    }
  }
  if (inkedColumns > 0 && inkedPixels > 0) {
    shape.thickness =
        static_cast<float>(inkedPixels) / static_cast<float>(inkedColumns * (ink.size() / columns));
  }
  const std::vector<Run> runs = dashesOf(isInked);
  const auto share = [columns](std::size_t n, std::size_t of) {
    return static_cast<float>(n) / static_cast<float>(of * columns);
  };
  if (runs.size() > 2 && areAlike(runs, true) && areAlike(runs, false)) {
    const std::size_t count = runs.size() / 2;
    std::size_t lengths[2] = {0, 0};
    for (const Run& run : runs)
      lengths[run.inked ? 0 : 1] += run.length;
    shape.dashes = {share(lengths[0], count), share(lengths[1], count)};
    shape.dashStart = meanStart(runs, shape.dashes[0], columns);
  } else {
    for (const Run& run : runs)
      shape.dashes.push_back(share(run.length, 1));
    if (!runs.empty()) shape.dashStart = share(runs.front().begin, 1);
  }
  return shape;
}

}  // namespace limn
