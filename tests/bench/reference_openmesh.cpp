// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/reference_simplifiers.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

namespace limn::bench {
namespace {

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};

using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

}  // namespace

PlainMesh simplifyOpenMesh(const PlainMesh& mesh, std::size_t faces) {
  Mesh work;
  std::vector<Mesh::VertexHandle> vertices;
  for (const glm::dvec3& p : mesh.positions)
    vertices.push_back(work.add_vertex({p.x, p.y, p.z}));
  for (const glm::uvec3& t : mesh.triangles)
    work.add_face(vertices[t.x], vertices[t.y], vertices[t.z]);

  OpenMesh::Decimater::DecimaterT<Mesh> decimater(work);
  OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
  decimater.add(quadric);
  decimater.module(quadric).unset_max_err();
  decimater.initialize();
  decimater.decimate_to_faces(0, faces);
  work.garbage_collection();

  PlainMesh result;
  for (const auto v : work.vertices()) {
    const auto& p = work.point(v);
    result.positions.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : work.faces()) {
    glm::uvec3 t;
    int k = 0;
    for (const auto v : work.fv_range(f))
      t[k++] = static_cast<glm::uint>(v.idx());
    result.triangles.push_back(t);
  }
  return result;
}

}  // namespace limn::bench
