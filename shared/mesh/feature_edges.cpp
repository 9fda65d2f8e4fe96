// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/feature_edges.h"

#include <cmath>

namespace limn {

std::vector<std::uint8_t>
findCreases(const HalfEdgeMesh& mesh, std::span<const glm::ivec3> positions, double angleDegrees) {
  const auto normal = [&](FaceId f) {
    const glm::dvec3 a(positions[mesh.origins[3 * f]]);
    return glm::cross(
        glm::dvec3(positions[mesh.origins[3 * f + 1]]) - a,
        glm::dvec3(positions[mesh.origins[3 * f + 2]]) - a);
  };
  const double leastCosine = std::cos(glm::radians(angleDegrees));
  std::vector<std::uint8_t> features(mesh.origins.size(), 0);
  for (HalfEdgeId h = 0; h < features.size(); ++h) {
    const HalfEdgeId twin = mesh.twin(h);
    if (twin == kNone || twin < h) continue;
    const glm::dvec3 n = normal(HalfEdgeMesh::face(h));
    const glm::dvec3 m = normal(HalfEdgeMesh::face(twin));
    const double lengths = std::sqrt(glm::dot(n, n) * glm::dot(m, m));
    if (lengths > 0.0 && glm::dot(n, m) < leastCosine * lengths) features[h] = features[twin] = 1;
  }
  return features;
}

}  // namespace limn
