// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/repair/repair_steps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace limn::repair {

namespace {

bool isFinite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// Numbers distinct grid positions in order of insertion: an open-addressing table.
class PositionTable {
 public:
  PositionTable(std::size_t capacity, std::vector<glm::ivec3>& positions)
      : positions_(positions),
        slots_(std::bit_ceil(2 * capacity + 1), kNone) {}

  std::uint32_t insert(const glm::ivec3& p) {
    // 18 bits a coordinate: the key is exact; the multiplier spreads it over the high bits.
    const std::uint64_t key = static_cast<std::uint64_t>(p.x) << 36 |
                              static_cast<std::uint64_t>(p.y) << 18 |
                              static_cast<std::uint64_t>(p.z);
    const std::uint64_t mask = slots_.size() - 1;
    const int shift = 64 - std::countr_zero(slots_.size());
    for (std::uint64_t slot = (key * 0x9E3779B97F4A7C15ULL) >> shift;; slot = (slot + 1) & mask) {
      if (slots_[slot] == kNone) {
        slots_[slot] = static_cast<std::uint32_t>(positions_.size());
        positions_.push_back(p);
        return slots_[slot];
      }
      if (positions_[slots_[slot]] == p) return slots_[slot];
    }
  }

 private:
  std::vector<glm::ivec3>& positions_;
  std::vector<std::uint32_t> slots_;
};

}  // namespace

Result<QuantizedPolygons> quantize(const ImportedMesh& input, int bits) {
  QuantizedPolygons result;
  const std::size_t vertices = input.positions.size();
  const std::size_t polygons = input.polygonBegin.empty() ? 0 : input.polygonBegin.size() - 1;
  constexpr double kHuge = std::numeric_limits<double>::infinity();
  glm::dvec3 low(kHuge);
  glm::dvec3 high(-kHuge);
  std::vector<std::uint32_t> vertexOf(vertices, kNone);  // 0 where referenced, until numbered
  std::size_t referenced = 0;
  result.corners.reserve(input.corners.size());
  result.polygonBegin.reserve(polygons + 1);
  for (std::size_t p = 0; p < polygons; ++p) {
    const std::uint32_t begin = input.polygonBegin[p];
    const std::uint32_t end = input.polygonBegin[p + 1];
    bool usable = end >= begin + 3 && end <= input.corners.size();
    for (std::uint32_t c = begin; usable && c < end; ++c) {
      usable = input.corners[c] < vertices && isFinite(input.positions[input.corners[c]]);
    }
    if (!usable) {
      ++result.droppedFaces;
      continue;
    }
    for (std::uint32_t c = begin; c < end; ++c) {
      const std::uint32_t v = input.corners[c];
      result.corners.push_back(v);
      if (vertexOf[v] != kNone) continue;
      vertexOf[v] = 0;
      ++referenced;
      low = glm::min(low, input.positions[v]);
      high = glm::max(high, input.positions[v]);
    }
    result.polygonBegin.push_back(static_cast<std::uint32_t>(result.corners.size()));
    result.polygons.push_back(static_cast<std::uint32_t>(p));
  }
  if (result.corners.empty()) {
    return fail(
        ErrorCode::kCorrupt,
        "no face has three valid, finite corners: the model is damaged; export it again");
  }
  const glm::dvec3 extent = high - low;
  const double longest = std::max({extent.x, extent.y, extent.z});
  if (!std::isfinite(longest)) {
    return fail(ErrorCode::kCorrupt, "the model is larger than a double can measure: rescale it");
  }
  const double cells = static_cast<double>((std::int64_t{1} << bits) - 1);
  result.grid = {low, longest / cells, bits};
  // Below the smallest normal number steps lose their digits; none is left at zero.
  if (!(result.grid.step >= std::numeric_limits<double>::min())) {
    return fail(
        ErrorCode::kCorrupt,
        "all vertices are at one point: the model has no extent; check its scale");
  }
  result.droppedVertices = vertices - referenced;
  result.positions.reserve(referenced);
  PositionTable table(referenced, result.positions);
  for (std::size_t v = 0; v < vertices; ++v) {
    if (vertexOf[v] == kNone) continue;
    const glm::dvec3 cell = glm::floor((input.positions[v] - low) / result.grid.step + 0.5);
    vertexOf[v] = table.insert(glm::ivec3(glm::clamp(cell, 0.0, cells)));
  }
  result.sources = result.corners;
  for (std::uint32_t& corner : result.corners)
    corner = vertexOf[corner];
  result.mergedVertices = referenced - result.positions.size();
  return result;
}

}  // namespace limn::repair
