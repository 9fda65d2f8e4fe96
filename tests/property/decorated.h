// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/rng.h"
#include "shared/mesh/half_edge.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/progressive/vertex_split.h"

#include <glm/glm.hpp>

#include <cmath>
#include <cstdint>
#include <vector>

namespace limn {

/// Which of two materials a face has, by the stripe that its corners lie in.
inline bool isStriped(const TriangleMesh& mesh, const glm::uvec3& t) {
  const glm::ivec3 sum = mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z];
  return (sum.x / 6000 & 1) != 0;
}

/// Gives a mesh what painted and scanned models have: stripes of flat colour, gradients and noise;
/// normals of its faces, a few of them wild. kinds: AttributeKind bits.
inline TriangleMesh decorated(TriangleMesh mesh, unsigned kinds) {
  Rng rng(5);
  std::vector<glm::dvec3> normals(mesh.positions.size(), glm::dvec3(1e-9));
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]);
    const glm::dvec3 n =
        glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a);
    for (int k = 0; k < 3; ++k)
      normals[t[k]] += n;
  }
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::ivec3& p = mesh.positions[v];
    const auto byte = [&](double x) {
      return static_cast<std::uint8_t>(127.5 + 127.4 * std::sin(x));
    };
    if ((kinds & kAttributeColors) != 0) {
      const bool flat = (p.x / 2000 & 1) != 0;
      mesh.attributes.colors.emplace_back(
          flat ? 200 : byte(p.x / 3000.0),
          flat ? 30 : byte(p.y / 2000.0),
          flat ? 10 : rng.below(256));
    }
    if ((kinds & kAttributeNormals) != 0) {
      const bool wild = rng.below(16) == 0;
      const auto any = [&] { return static_cast<double>(rng.below(2001)) - 1000.5; };
      mesh.attributes.normals.push_back(
          encodeNormal(wild ? glm::dvec3(any(), any(), any()) : normals[v]));
    }
  }
  return mesh;
}

/// Edges between stripes, as buildForest() takes them. None for meshes without attributes.
inline std::vector<std::uint8_t> stripeSeams(const TriangleMesh& mesh) {
  if (mesh.attributes.kinds() == 0) return {};
  const auto links =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  std::vector<std::uint8_t> seams(3 * mesh.triangles.size(), 0);
  for (HalfEdgeId h = 0; h < seams.size(); ++h) {
    const HalfEdgeId twin = links->twin(h);
    if (twin != kNone &&
        isStriped(mesh, mesh.triangles[h / 3]) != isStriped(mesh, mesh.triangles[twin / 3])) {
      seams[h] = kFeatureSeam;
    }
  }
  return seams;
}

}  // namespace limn
