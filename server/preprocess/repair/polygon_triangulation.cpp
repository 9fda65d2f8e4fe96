// SPDX-License-Identifier: GPL-3.0-or-later
// GPL because of CGAL's triangulations. Constrained Delaunay with faces marked by nesting, as in
// CGAL's manual, "2D Triangulations", example polygon_triangulation; our checks around it.
#include "server/preprocess/repair/repair_steps.h"

#include "shared/core/integer_vectors.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <vector>

namespace limn::repair {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<
    int,
    Kernel,
    CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel,
    CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
    CGAL::No_constraint_intersection_tag>;
using Point = glm::i64vec2;
using Corners = std::span<const std::uint32_t>;

/// The ears' O(n²) to O(n³) stays below a blink.
constexpr std::size_t kMaxEars = 512;

glm::i64vec3 normalOf(std::span<const glm::ivec3> positions, Corners corners) {
  // Newell's sum, relative to the first corner: exact.
  glm::i64vec3 normal(0);
  const glm::i64vec3 base(positions[corners[0]]);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    normal += crossExact(
        glm::i64vec3(positions[corners[i]]) - base,
        glm::i64vec3(positions[corners[i + 1]]) - base);
  }
  return normal;
}

void addQuad(std::span<const glm::ivec3> positions, Corners q, std::vector<glm::uvec3>& out) {
  const auto at = [&](int k) { return glm::i64vec3(positions[q[static_cast<std::size_t>(k)]]); };
  const glm::dvec3 normal(normalOf(positions, q));
  const auto faces = [&](int a, int b, int c) {
    return glm::dot(glm::dvec3(crossExact(at(b) - at(a), at(c) - at(a))), normal) > 0.0;
  };
  const auto length2 = [&](int a, int b) {
    const glm::i64vec3 d = at(b) - at(a);
    return d.x * d.x + d.y * d.y + d.z * d.z;
  };
  const bool first = faces(0, 1, 2) && faces(0, 2, 3);
  const bool second = faces(1, 2, 3) && faces(1, 3, 0);
  // Ties go by vertex number, so that both sides of a sheet are cut alike.
  const bool shorter = length2(0, 2) != length2(1, 3) ? length2(0, 2) < length2(1, 3)
                                                      : std::min(q[0], q[2]) < std::min(q[1], q[3]);
  if (first != second ? first : shorter) {
    out.emplace_back(q[0], q[1], q[2]);
    out.emplace_back(q[0], q[2], q[3]);
  } else {
    out.emplace_back(q[1], q[2], q[3]);
    out.emplace_back(q[1], q[3], q[0]);
  }
}

/// Marks faces by how many constraints lie between them and infinity: odd is inside.
void markNesting(Cdt& cdt) {
  for (const auto face : cdt.all_face_handles())
    face->info() = -1;
  std::vector<std::pair<Cdt::Face_handle, int>> front{{cdt.infinite_face(), 0}};
  std::size_t done = 0;
  while (done < front.size()) {
    const auto [seed, nesting] = front[done++];
    if (seed->info() != -1) continue;
    std::vector<Cdt::Face_handle> region{seed};
    while (!region.empty()) {
      const Cdt::Face_handle face = region.back();
      region.pop_back();
      if (face->info() != -1) continue;
      face->info() = nesting;
      for (int k = 0; k < 3; ++k) {
        const Cdt::Face_handle neighbor = face->neighbor(k);
        if (neighbor->info() != -1) continue;
        if (cdt.is_constrained({face, k})) {
          front.emplace_back(neighbor, nesting + 1);
        } else {
          region.push_back(neighbor);
        }
      }
    }
  }
}

/// False, with `out` as it was, when the outline crosses or touches itself.
bool addDelaunay(
    std::span<const Point> points,
    Corners corners,
    bool clockwise,
    std::vector<glm::uvec3>& out) {
  const std::size_t before = out.size();
  try {
    Cdt cdt;
    std::vector<Cdt::Vertex_handle> handles;
    handles.reserve(points.size());
    Cdt::Face_handle hint;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto handle =
          cdt.insert({static_cast<double>(points[i].x), static_cast<double>(points[i].y)}, hint);
      if (cdt.number_of_vertices() != i + 1) return false;
      handle->info() = corners[i];
      hint = handle->face();
      handles.push_back(handle);
    }
    for (std::size_t i = 0; i < handles.size(); ++i)
      cdt.insert_constraint(handles[i], handles[(i + 1) % handles.size()]);
    markNesting(cdt);
    for (const auto face : cdt.finite_face_handles()) {
      if (face->info() % 2 == 0) continue;
      const std::array<std::uint32_t, 3> t{
          face->vertex(0)->info(),
          face->vertex(1)->info(),
          face->vertex(2)->info()};
      out.emplace_back(t[0], clockwise ? t[2] : t[1], clockwise ? t[1] : t[2]);
    }
  } catch (const std::exception&) {  // an intersection of constraints, or a failed precondition
    out.resize(before);
    return false;
  }
  // A simple polygon has exactly this many; a T-shaped contact would have fewer.
  if (out.size() - before == corners.size() - 2) return true;
  out.resize(before);
  return false;
}

std::int64_t turn(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Ear clipping: for outlines that touch themselves, as where a hole is bridged to the border.
bool addEars(
    std::vector<Point> points,
    Corners corners,
    bool clockwise,
    std::vector<glm::uvec3>& out) {
  const std::size_t before = out.size();
  if (clockwise) {
    for (Point& p : points)
      p.x = -p.x;
  }
  std::vector<std::uint32_t> left(corners.size());
  for (std::uint32_t i = 0; i < left.size(); ++i)
    left[i] = i;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    const auto isEar = [&](std::size_t i) {
      const Point& a = points[left[(i + n - 1) % n]];
      const Point& b = points[left[i]];
      const Point& c = points[left[(i + 1) % n]];
      if (turn(a, b, c) <= 0) return false;
      return std::none_of(left.begin(), left.end(), [&](std::uint32_t other) {
        const Point& p = points[other];
        return p != a && p != b && p != c && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 &&
               turn(c, a, p) >= 0;
      });
    };
    std::size_t ear = 0;
    while (ear < n && !isEar(ear))
      ++ear;
    if (ear == n) {
      out.resize(before);
      return false;
    }
    out.emplace_back(
        corners[left[(ear + n - 1) % n]],
        corners[left[ear]],
        corners[left[(ear + 1) % n]]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  out.emplace_back(corners[left[0]], corners[left[1]], corners[left[2]]);
  return true;
}

}  // namespace

void triangulatePolygon(
    std::span<const glm::ivec3> positions,
    std::span<const std::uint32_t> corners,
    std::vector<glm::uvec3>& out) {
  if (corners.size() == 4) return addQuad(positions, corners, out);
  const glm::i64vec3 normal = normalOf(positions, corners);
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
  }
  if (normal[axis] != 0) {
    std::vector<Point> points;
    points.reserve(corners.size());
    for (const std::uint32_t corner : corners) {
      points.emplace_back(positions[corner][(axis + 1) % 3], positions[corner][(axis + 2) % 3]);
    }
    const bool clockwise = normal[axis] < 0;
    if (addDelaunay(points, corners, clockwise, out)) return;
    if (corners.size() <= kMaxEars && addEars(std::move(points), corners, clockwise, out)) return;
  }
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    out.emplace_back(corners[0], corners[i], corners[i + 1]);
}

}  // namespace limn::repair
