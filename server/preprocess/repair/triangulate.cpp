// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/repair/repair_steps.h"

#include <algorithm>

namespace limn::repair {

Triangulation triangulate(const QuantizedPolygons& polygons) {
  Triangulation result;
  result.triangles.reserve(polygons.corners.size() / 3);
  std::vector<std::uint32_t> corners;
  for (std::size_t p = 0; p + 1 < polygons.polygonBegin.size(); ++p) {
    // Merging may have made neighbours equal: an edge of no length.
    corners.clear();
    for (std::uint32_t c = polygons.polygonBegin[p]; c < polygons.polygonBegin[p + 1]; ++c) {
      if (corners.empty() || corners.back() != polygons.corners[c])
        corners.push_back(polygons.corners[c]);
    }
    while (corners.size() > 1 && corners.front() == corners.back())
      corners.pop_back();
    if (corners.size() > 3) ++result.triangulated;
    const std::size_t before = result.triangles.size();
    if (corners.size() == 3) {
      result.triangles.emplace_back(corners[0], corners[1], corners[2]);
    } else if (corners.size() > 3) {
      triangulatePolygon(polygons.positions, corners, result.triangles);
      const auto degenerate = [](const glm::uvec3& t) {
        return t.x == t.y || t.y == t.z || t.z == t.x;
      };
      result.triangles.erase(
          std::remove_if(
              result.triangles.begin() + static_cast<std::ptrdiff_t>(before),
              result.triangles.end(),
              degenerate),
          result.triangles.end());
    }
    if (result.triangles.size() == before) ++result.droppedFaces;
    result.polygons.resize(result.triangles.size(), static_cast<std::uint32_t>(p));
  }
  return result;
}

}  // namespace limn::repair
