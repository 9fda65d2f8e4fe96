// SPDX-License-Identifier: GPL-3.0-or-later
// GPL because of CGAL's hole filling. Based on: P. Liepa, "Filling Holes in Meshes", 2003, as CGAL
// has it; the choice of holes and the checks are ours.
#include "server/preprocess/hulls/close_holes.h"

#include "shared/mesh/half_edge.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/utility.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace limn {
namespace {

using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
/// A border's vertices in the order in which a triangle that fills it runs.
using Border = std::vector<std::uint32_t>;

/// Longer borders are closed with a fan: the least area takes cubic time.
constexpr std::size_t kMaxLeastArea = 400;

std::vector<Border> bordersOf(const HalfEdgeMesh& mesh) {
  std::vector<Border> borders;
  std::vector<std::uint8_t> seen(mesh.twins.size(), 0);
  for (HalfEdgeId h = 0; h < mesh.twins.size(); ++h) {
    if (mesh.twins[h] != kNone || seen[h] != 0) continue;
    Border& border = borders.emplace_back();
    for (HalfEdgeId i = h; seen[i] == 0; i = mesh.outgoing[mesh.target(i)]) {
      seen[i] = 1;
      border.push_back(mesh.origin(i));
    }
    std::reverse(border.begin(), border.end());
  }
  return borders;
}

double diagonal(const TriangleMesh& mesh, std::span<const std::uint32_t> vertices) {
  glm::ivec3 low(INT32_MAX);
  glm::ivec3 high(INT32_MIN);
  for (const std::uint32_t v : vertices) {
    low = glm::min(low, mesh.positions[v]);
    high = glm::max(high, mesh.positions[v]);
  }
  return glm::length(glm::dvec3(high) - glm::dvec3(low));
}

/// Triangles of the least area, as indices into the border; empty when CGAL has none.
std::vector<glm::uvec3> leastArea(const TriangleMesh& mesh, const Border& border) {
  std::vector<Point> points;
  for (const std::uint32_t v : border) {
    const glm::ivec3& p = mesh.positions[v];
    points.emplace_back(p.x, p.y, p.z);
  }
  std::vector<CGAL::Triple<int, int, int>> found;
  try {
    CGAL::Polygon_mesh_processing::triangulate_hole_polyline(points, std::back_inserter(found));
  } catch (const std::exception&) {
    return {};
  }
  std::vector<glm::uvec3> triangles;
  for (const auto& t : found)
    triangles.emplace_back(
        border[static_cast<std::size_t>(t.first)],
        border[static_cast<std::size_t>(t.second)],
        border[static_cast<std::size_t>(t.third)]);
  return triangles;
}

class Filler {
 public:
  Filler(TriangleMesh& mesh, const HalfEdgeMesh& links) : mesh_(mesh), links_(links) {}

  void fill(const Border& border) {
    std::vector<glm::uvec3> triangles;
    if (border.size() == 3) {
      triangles.emplace_back(border[0], border[1], border[2]);
    } else if (border.size() <= kMaxLeastArea) {
      triangles = leastArea(mesh_, border);
    }
    if (triangles.size() + 2 != border.size() || !isSimple(border, triangles))
      triangles = fan(border);
    mesh_.triangles.insert(mesh_.triangles.end(), triangles.begin(), triangles.end());
  }

 private:
  using DirectedEdge = std::pair<std::uint32_t, std::uint32_t>;

  /// Whether the triangles close the border and no edge inside it exists already.
  bool isSimple(const Border& border, const std::vector<glm::uvec3>& triangles) {
    std::set<DirectedEdge> inner;
    for (const glm::uvec3& t : triangles) {
      for (int k = 0; k < 3; ++k) {
        if (!inner.insert({t[k], t[(k + 1) % 3]}).second) return false;
      }
    }
    for (std::size_t i = 0; i < border.size(); ++i) {
      if (inner.erase({border[i], border[(i + 1) % border.size()]}) == 0) return false;
    }
    for (const auto& [a, b] : inner) {
      if (!inner.contains({b, a}) || added_.contains({a, b}) || links_.find(a, b) != kNone ||
          links_.find(b, a) != kNone) {
        return false;
      }
    }
    added_.insert(inner.begin(), inner.end());
    return true;
  }

  std::vector<glm::uvec3> fan(const Border& border) {
    glm::dvec3 middle(0.0);
    for (const std::uint32_t v : border)
      middle += glm::dvec3(mesh_.positions[v]);
    const auto hub = static_cast<std::uint32_t>(mesh_.positions.size());
    mesh_.positions.emplace_back(glm::round(middle / static_cast<double>(border.size())));
    std::vector<glm::uvec3> triangles;
    for (std::size_t i = 0; i < border.size(); ++i)
      triangles.emplace_back(border[i], border[(i + 1) % border.size()], hub);
    return triangles;
  }

  TriangleMesh& mesh_;
  const HalfEdgeMesh& links_;
  std::set<DirectedEdge> added_;
};

}  // namespace

Result<ClosedMesh> closeHoles(const TriangleMesh& mesh, const HoleOptions& options) {
  const auto links =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  if (!links) return tl::unexpected(links.error());
  const std::vector<Border> borders = bordersOf(*links);
  ClosedMesh result{mesh, 0};
  if (borders.empty()) return result;

  glm::ivec3 low(INT32_MAX);
  glm::ivec3 high(INT32_MIN);
  for (const glm::ivec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const double model = glm::length(glm::dvec3(high) - glm::dvec3(low));
  double largest = 0.0;
  for (const Border& border : borders)
    largest = std::max(largest, diagonal(mesh, border));
  if (largest > options.largestHole * model) {
    return fail(
        ErrorCode::kUnsupported,
        "the mesh is open: its largest border of " + std::to_string(borders.size()) + " measures " +
            std::to_string(std::lround(100.0 * largest / model)) +
            " % of the model, and only holes up to " +
            std::to_string(std::lround(100.0 * options.largestHole)) + " % are closed");
  }
  Filler filler(result.mesh, *links);
  for (const Border& border : borders) {
    filler.fill(border);
    ++result.filledHoles;
  }
  return result;
}

}  // namespace limn
