// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reference_simplifiers.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

namespace limn::bench {
namespace {

namespace Sms = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

Mesh toCgal(const PlainMesh& mesh) {
  Mesh result;
  std::vector<Mesh::Vertex_index> vertices;
  for (const glm::dvec3& p : mesh.positions)
    vertices.push_back(result.add_vertex({p.x, p.y, p.z}));
  for (const glm::uvec3& t : mesh.triangles)
    result.add_face(vertices[t.x], vertices[t.y], vertices[t.z]);
  return result;
}

PlainMesh fromCgal(Mesh& mesh) {
  mesh.collect_garbage();
  PlainMesh result;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    result.positions.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : mesh.faces()) {
    glm::uvec3 t;
    int k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f)))
      t[k++] = static_cast<glm::uint>(v.idx());
    result.triangles.push_back(t);
  }
  return result;
}

// Stops at a number of faces; CGAL 5.5 has predicates on edges only.
class FaceStop {
 public:
  FaceStop(const Mesh& mesh, std::size_t faces) : mesh_(&mesh), faces_(faces) {}

  template <class Cost, class Profile>
  bool operator()(const Cost&, const Profile&, std::size_t, std::size_t) const {
    return mesh_->number_of_faces() <= faces_;
  }

 private:
  const Mesh* mesh_;
  std::size_t faces_;
};

}  // namespace

PlainMesh simplifyLindstromTurk(const PlainMesh& mesh, std::size_t faces) {
  Mesh work = toCgal(mesh);
  const FaceStop stop(work, faces);
  Sms::edge_collapse(
      work,
      stop,
      CGAL::parameters::get_cost(Sms::LindstromTurk_cost<Mesh>())
          .get_placement(Sms::LindstromTurk_placement<Mesh>()));
  return fromCgal(work);
}

PlainMesh simplifyGarlandHeckbert(const PlainMesh& mesh, std::size_t faces) {
  Mesh work = toCgal(mesh);
  const FaceStop stop(work, faces);
  const Sms::GarlandHeckbert_plane_policies<Mesh, Kernel> policies(work);
  Sms::edge_collapse(
      work,
      stop,
      CGAL::parameters::get_cost(policies.get_cost()).get_placement(policies.get_placement()));
  return fromCgal(work);
}

}  // namespace limn::bench
