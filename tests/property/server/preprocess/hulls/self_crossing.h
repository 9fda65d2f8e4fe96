// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "shared/mesh/triangle_mesh.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

namespace limn {

/// Whether faces of a mesh cross or touch others than their neighbours: CGAL's exact answer.
inline bool crossesItself(const TriangleMesh& mesh) {
  using CgalMesh = CGAL::Surface_mesh<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3>;
  CgalMesh cgal;
  for (const glm::ivec3& p : mesh.positions)
    cgal.add_vertex({p.x, p.y, p.z});
  for (const glm::uvec3& t : mesh.triangles) {
    cgal.add_face(
        CgalMesh::Vertex_index(t.x),
        CgalMesh::Vertex_index(t.y),
        CgalMesh::Vertex_index(t.z));
  }
  return CGAL::Polygon_mesh_processing::does_self_intersect(cgal);
}

}  // namespace limn
