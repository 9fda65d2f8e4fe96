// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/camera.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

/// Where lines pass behind edges in the picture. Edges are put into a grid of square cells, so that
/// a line meets only those near it. Add every edge, then build(), then ask.
class LineCrossings {
 public:
  explicit LineCrossings(const Viewport& viewport);

  /// An edge between two points in clip space. What lies outside the picture is left out.
  void addEdge(const glm::dvec4& a, const glm::dvec4& b);

  /// Cost: O(edges + cells they touch).
  void build();

  /// Appends to `cuts`, in no order, the places t (0 at a, 1 at b; strictly between, affine in
  /// space) where an edge crosses a → b in the picture and is nearer than it there. One that only
  /// touches an end of a → b does not count.
  void cross(const glm::dvec4& a, const glm::dvec4& b, std::vector<double>& cuts) const;

 private:
  struct Edge {
    glm::dvec3 a;  // x, y in pixels, window depth
    glm::dvec3 b;
  };

  /// visit(cell) for every cell that the segment passes through; some may come twice.
  template <class Visit>
  void forCells(const glm::dvec2& a, const glm::dvec2& b, Visit visit) const;

  Viewport viewport_;
  glm::dvec2 low_;  // pixel of the grid's corner
  double cellPx_ = 8.0;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> cellBegin_;  // by cell, and one past the last: into cellEdges_
  std::vector<std::uint32_t> cellEdges_;
};

}  // namespace limn
