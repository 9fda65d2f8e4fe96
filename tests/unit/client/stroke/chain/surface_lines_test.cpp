// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain/surface_lines.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

SurfaceSegment segment(std::uint32_t from, std::uint32_t to) {
  const auto end = [](std::uint32_t node) {
    return SurfaceSegment::End{node, glm::vec3(static_cast<float>(node)), 0.5F};
  };
  return {from, {end(from), end(to)}};
}

TEST(SurfaceLines, SegmentsChainThroughNodesOfTwoAndLoopsClose) {
  PolylineSet lines;
  lines.points.emplace_back(0.0F);  // of another kind, before
  lines.halfEdges.push_back(kNone);
  lines.faces.push_back(kNone);
  // 1-2-3-4 in no order, one of them the other way round; a loop 10-11-12; a fork at 20.
  const std::vector<SurfaceSegment> segments{
      segment(3, 4),
      segment(1, 2),
      segment(2, 3),
      segment(11, 12),
      segment(10, 11),
      segment(12, 10),
      segment(20, 21),
      segment(20, 22),
      segment(20, 23)};
  chainSegments(segments, LineKind::kRidge, lines);
  ASSERT_EQ(lines.lines.size(), 5U);
  std::size_t loops = 0;
  std::size_t count = 0;
  for (const PolylineSet::Line& line : lines.lines) {
    EXPECT_EQ(line.kind, LineKind::kRidge);
    EXPECT_TRUE(line.onSurface);
    count += line.segmentCount();
    if (line.closed) {
      ++loops;
      EXPECT_EQ(line.segmentCount(), 3U);
    } else if (line.segmentCount() == 3) {
      for (std::uint32_t k = 0; k < 4; ++k)
        EXPECT_EQ(lines.points[line.begin + k].x, static_cast<float>(k + 1));
      EXPECT_EQ(lines.faces[line.begin], 1U);
      EXPECT_EQ(lines.faces[line.end - 1], kNone);
    }
  }
  EXPECT_EQ(loops, 1U);
  EXPECT_EQ(count, segments.size());
  ASSERT_EQ(lines.strengths.size(), lines.points.size());
  EXPECT_EQ(lines.strengths.front(), 1.0F);
  EXPECT_EQ(lines.strengths.back(), 0.5F);
}

TEST(SurfaceLines, OnlyWhatIsAskedForIsFoundAndViewsChangeWhatDependsOnThem) {
  const TriangleMesh shape = primitives::bumpySphere(5, 5);
  const auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
  ASSERT_TRUE(mesh);
  SurfaceLines finder(*mesh, shape.positions, {}, {.suggestive = true, .ridge = true});
  const auto linesFrom = [&](const glm::dvec3& eye) {
    PolylineSet lines;
    finder.append({eye, {}, false}, lines);
    return lines;
  };
  const PolylineSet front = linesFrom({8000.0, 8000.0, 60000.0});
  const PolylineSet back = linesFrom({8000.0, 8000.0, -60000.0});
  const auto countOf = [](const PolylineSet& lines, LineKind kind) {
    std::size_t segments = 0;
    for (const PolylineSet::Line& line : lines.lines)
      segments += line.kind == kind ? line.segmentCount() : 0;
    return segments;
  };
  EXPECT_GT(countOf(front, LineKind::kSuggestive), 50U);
  EXPECT_GT(countOf(front, LineKind::kRidge), 50U);
  EXPECT_EQ(countOf(front, LineKind::kValley), 0U);
  EXPECT_EQ(countOf(front, LineKind::kIntersection), 0U);
  EXPECT_EQ(countOf(front, LineKind::kRidge), countOf(back, LineKind::kRidge));
  EXPECT_NE(front.points, back.points);
}

}  // namespace
}  // namespace limn
