// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/camera.h"
#include "shared/core/ids.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

/// Where lines pass behind edges in the picture. Edges are put into a grid of square cells, so that
/// a line meets only those near it. Add every edge, then build(), then ask.
class LineCrossings {
 public:
  LineCrossings() = default;

  explicit LineCrossings(const Viewport& viewport) { begin(viewport); }

  /// Forgets every edge, for another picture.
  void begin(const Viewport& viewport);

  /// On which side of an edge, walking along it in the picture, the surface that ends there lies.
  enum class Surface : std::uint8_t { kLeft, kRight };

  /// Where a line passes behind an edge.
  struct Crossing {
    double inSpace = 0.0;    // share of a → b, affine in space
    double inPicture = 0.0;  // share of its part in the picture (clipSegment), affine there
    bool enters = false;     // goes behind the surface there, or comes out from behind it
    double gap = 0.0;        // how much farther away than the edge the line is, window depth
    FaceId face = kNone;     // of the edge
    std::uint32_t edge = 0;  // its number in the order of adding
  };

  /// An edge of a face between two points in clip space. What lies outside the picture is left out.
  void addEdge(const glm::dvec4& a, const glm::dvec4& b, Surface side, FaceId face);

  /// The same between two places in the picture (pixels, window depth).
  void addEdgeInPicture(const glm::dvec3& a, const glm::dvec3& b, Surface side, FaceId face) {
    if (!edges_.empty()) edges_.back().isJoined = edges_.back().b == a;
    edges_.push_back({a, b, boxAround(a, b), side, face});
  }

  /// Cost: O(edges + cells they touch).
  void build();

  /// Appends to `out`, from a to b, the places strictly between them where an edge crosses a → b in
  /// the picture and is nearer than it there. One that only touches an end does not count.
  void cross(const glm::dvec4& a, const glm::dvec4& b, std::vector<Crossing>& out) const;

  /// The same between two places in the picture (pixels, window depth); inSpace is not set.
  void crossInPicture(const glm::dvec3& p, const glm::dvec3& q, std::vector<Crossing>& out) const;

  /// What else is found beside a line: edges by their numbers in the order of adding.
  struct Beside {
    float reachPx = 0.0F;
    /// Edges from … to − 1 do not count.
    std::uint32_t exceptFrom = 0;
    std::uint32_t exceptTo = 0;
    /// Appended to: those of the cells that the line passes through whose box comes within reachPx
    /// of the line's; some may come twice.
    std::vector<std::uint32_t>& edges;

    void add(std::uint32_t edge) const {
      if (edge < exceptFrom || edge >= exceptTo) edges.push_back(edge);
    }
  };

  /// The same along an edge that was added, by its number (what build() found is not found again),
  /// and what there is beside it.
  void crossAlong(std::uint32_t edge, std::vector<Crossing>& out, const Beside& beside) const;

  /// Whether an edge comes within reachPx of a place and is nearer to the eye where it does.
  [[nodiscard]] bool isBefore(std::uint32_t edge, const glm::dvec3& place, double reachPx) const;

  /// The same for a segment that does not cross the edge, where it is closest to it.
  [[nodiscard]] bool
  isBefore(std::uint32_t edge, const glm::dvec3& from, const glm::dvec3& to, double reachPx) const;

 private:
  /// A box in the picture.
  struct Box {
    float lowX;
    float highX;
    float lowY;
    float highY;
  };

  struct Edge {
    glm::dvec3 a;  // x, y in pixels, window depth
    glm::dvec3 b;
    Box box;
    Surface side;
    FaceId face;
    bool isJoined = false;  // the next one begins where it ends
  };

  /// An edge as a cell has it: a box around it, so that most are passed over unseen.
  struct Entry {
    Box box;
    float nearest;  // least window depth
    std::uint32_t edge;
  };

  /// An edge's place in a cell.
  struct Touch {
    std::uint32_t cell;
    std::uint32_t edge;
  };

  [[nodiscard]] static Box boxAround(const glm::dvec3& a, const glm::dvec3& b);

  /// A line that is asked about.
  struct Course {
    const glm::dvec3& from;
    const glm::dvec3& to;
    const Box& box;
    /// Edges from … to − 1 are it or share an end with it: they do not cross it.
    std::uint32_t joinedFrom = 0;
    std::uint32_t joinedTo = 0;
  };

  template <class ForCells, class VisitNear>
  void crossCells(
      const Course& course,
      float reachPx,
      ForCells forEachCell,
      VisitNear visitNear,
      std::vector<Crossing>& out) const;

  /// visit(cell) for every cell that the segment passes through; some may come twice.
  template <class Visit>
  void forCells(const glm::dvec2& a, const glm::dvec2& b, Visit visit) const;

  Viewport viewport_;
  glm::dvec2 low_;  // pixel of the grid's corner
  double cellsPerPx_ = 0.125;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> cellBegin_;  // by cell, and one past the last: into cellEdges_
  std::vector<Entry> cellEdges_;
  std::vector<Touch> touches_;             // edge by edge
  std::vector<std::uint32_t> touchBegin_;  // by edge, and one past the last: into touches_
};

}  // namespace limn
