// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/repair/edge_groups.h"

#include <algorithm>

namespace limn::repair {

EdgeGroups::EdgeGroups(std::uint32_t vertexCount, std::span<const glm::uvec3> triangles) {
  // Bucket by the smaller vertex (one counting pass), then sort each small bucket.
  const auto halfEdges = static_cast<std::uint32_t>(3 * triangles.size());
  std::vector<std::uint32_t> bucket(std::size_t{vertexCount} + 1, 0);
  const auto ends = [&](HalfEdgeId h) {
    return std::minmax({originOf(triangles, h), targetOf(triangles, h)});
  };
  for (HalfEdgeId h = 0; h < halfEdges; ++h)
    ++bucket[ends(h).first + 1];
  for (std::uint32_t v = 0; v < vertexCount; ++v)
    bucket[v + 1] += bucket[v];
  halfEdges_.resize(halfEdges);
  {
    std::vector<std::uint32_t> next(bucket.begin(), bucket.end() - 1);
    for (HalfEdgeId h = 0; h < halfEdges; ++h)
      halfEdges_[next[ends(h).first]++] = h;
  }
  begin_.reserve(halfEdges / 2 + 2);
  begin_.push_back(0);
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const auto first = halfEdges_.begin() + bucket[v];
    const auto last = halfEdges_.begin() + bucket[v + 1];
    std::sort(first, last, [&](HalfEdgeId a, HalfEdgeId b) {
      const std::uint32_t far = ends(a).second;
      const std::uint32_t other = ends(b).second;
      return far != other ? far < other : a < b;
    });
    for (std::uint32_t i = bucket[v]; i < bucket[v + 1]; ++i) {
      const bool lastOfGroup =
          i + 1 == bucket[v + 1] || ends(halfEdges_[i]).second != ends(halfEdges_[i + 1]).second;
      if (lastOfGroup) begin_.push_back(i + 1);
    }
  }
}

void EdgeGroups::renumberFlipped(std::span<const std::uint8_t> flipped) {
  // (x, y, z) becomes (x, z, y): edge 0 is now traversed as edge 2, and 2 as 0.
  for (HalfEdgeId& h : halfEdges_) {
    if (flipped[h / 3] != 0) h = h / 3 * 3 + (2 - h % 3);
  }
}

}  // namespace limn::repair
