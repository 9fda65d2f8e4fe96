// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/segment_cells.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace limn {
namespace {

double distanceTo(const Segment& segment, const glm::dvec3& p) {
  const double squared = glm::dot(segment.along, segment.along);
  const double t = squared > 0.0
                       ? std::clamp(glm::dot(p - segment.from, segment.along) / squared, 0.0, 1.0)
                       : 0.0;
  return glm::distance(p, segment.from + t * segment.along);
}

/// Short ones among one another, points, and some right across them all.
std::vector<Segment> segmentsOfAllLengths(Rng& rng) {
  const auto within = [&rng](double size) {
    return size * (glm::dvec3(rng.uniform(), rng.uniform(), rng.uniform()) - 0.5);
  };
  std::vector<Segment> segments;
  for (int i = 0; i < 400; ++i)
    segments.push_back({within(200.0), within(i % 10 == 0 ? 0.0 : 12.0)});
  for (int i = 0; i < 5; ++i)
    segments.push_back({within(200.0), within(3000.0)});
  return segments;
}

TEST(SegmentCells, NoneNearAPlaceIsMissed) {
  constexpr double kReach = 2.0;
  Rng rng(5);
  const std::vector<Segment> segments = segmentsOfAllLengths(rng);
  const SegmentCells cells(segments, kReach);
  std::size_t near = 0;
  std::size_t named = 0;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    // Many on a segment, where cells end as well.
    const Segment& on = segments[i % segments.size()];
    const glm::dvec3 away(rng.uniform(), rng.uniform(), rng.uniform());
    const glm::dvec3 p = on.from + rng.uniform() * on.along + 2.0 * kReach * (away - 0.5);
    const auto found = cells.near(p);
    EXPECT_TRUE(std::ranges::is_sorted(found));
    for (std::uint32_t k = 0; k < segments.size(); ++k) {
      if (distanceTo(segments[k], p) > kReach) continue;
      ++near;
      EXPECT_TRUE(std::ranges::binary_search(found, k)) << k;
    }
    named += found.size();
  }
  EXPECT_GT(near, 2000U);
  EXPECT_LT(named, 4000U * segments.size() / 10) << "nearly all are named: nothing is saved";
}

TEST(SegmentCells, NoneNearASegmentIsMissed) {
  constexpr double kReach = 2.0;
  Rng rng(6);
  const std::vector<Segment> segments = segmentsOfAllLengths(rng);
  const SegmentCells cells(segments, kReach);
  for (const Segment& segment : segments) {
    std::set<std::uint32_t> found;
    cells.visitNear(segment, [&](std::uint32_t k) { found.insert(k); });
    for (std::uint32_t k = 0; k < segments.size(); ++k) {
      for (const double t : {0.0, 0.3, 0.5, 0.8, 1.0}) {
        if (distanceTo(segments[k], segment.from + t * segment.along) > kReach) continue;
        EXPECT_TRUE(found.contains(k));
      }
    }
  }
}

TEST(SegmentCells, OfNoSegmentsNoneAreNear) {
  const SegmentCells cells({}, 2.0);
  EXPECT_TRUE(cells.near({1.0, 2.0, 3.0}).empty());
}

}  // namespace
}  // namespace limn
