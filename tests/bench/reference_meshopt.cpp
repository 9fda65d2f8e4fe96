// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/reference_simplifiers.h"

#include <meshoptimizer.h>

namespace limn::bench {

PlainMesh simplifyMeshopt(const PlainMesh& mesh, std::size_t faces) {
  std::vector<glm::vec3> positions(mesh.positions.begin(), mesh.positions.end());
  PlainMesh result{mesh.positions, {}};
  std::vector<unsigned> indices(3 * mesh.triangles.size());
  const std::size_t count = meshopt_simplify(
      indices.data(),
      &mesh.triangles[0].x,
      indices.size(),
      &positions[0].x,
      positions.size(),
      sizeof(glm::vec3),
      3 * faces,
      1.0F,
      0,
      nullptr);
  for (std::size_t i = 0; i + 2 < count; i += 3)
    result.triangles.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
  return result;
}

}  // namespace limn::bench
