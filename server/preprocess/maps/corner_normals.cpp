// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/maps/corner_normals.h"

#include <cmath>
#include <cstddef>

namespace limn {

std::vector<glm::vec3> cornerNormals(const TriangleMesh& mesh, double creaseAngleDegrees) {
  const std::size_t faces = mesh.triangles.size();
  std::vector<glm::dvec3> normals(faces, glm::dvec3(0.0));
  std::vector<double> angles(3 * faces, 0.0);
  std::vector<std::uint32_t> begin(mesh.positions.size() + 1, 0);
  for (std::size_t f = 0; f < faces; ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    const auto edge = [&](int from, int to) {
      return glm::dvec3(mesh.positions[t[to]]) - glm::dvec3(mesh.positions[t[from]]);
    };
    const glm::dvec3 cross = glm::cross(edge(0, 1), edge(0, 2));
    const double length = glm::length(cross);
    if (length > 0.0) normals[f] = cross / length;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 a = edge(k, (k + 1) % 3);
      const glm::dvec3 b = edge(k, (k + 2) % 3);
      angles[3 * f + static_cast<std::size_t>(k)] =
          std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
      ++begin[t[k] + 1];
    }
  }
  for (std::size_t v = 1; v < begin.size(); ++v)
    begin[v] += begin[v - 1];
  std::vector<std::uint32_t> corners(3 * faces);
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::uint32_t corner = 0; corner < 3 * faces; ++corner)
    corners[next[mesh.triangles[corner / 3][static_cast<int>(corner % 3)]]++] = corner;

  const double limit = std::cos(glm::radians(creaseAngleDegrees));
  std::vector<glm::vec3> result(3 * faces);
  for (std::uint32_t corner = 0; corner < 3 * faces; ++corner) {
    const std::uint32_t v = mesh.triangles[corner / 3][static_cast<int>(corner % 3)];
    const glm::dvec3& own = normals[corner / 3];
    const bool hasArea = own != glm::dvec3(0.0);
    glm::dvec3 sum{0.0};
    for (std::uint32_t i = begin[v]; i < begin[v + 1]; ++i) {
      const glm::dvec3& other = normals[corners[i] / 3];
      if (!hasArea || glm::dot(own, other) >= limit) sum += angles[corners[i]] * other;
    }
    const double length = glm::length(sum);
    result[corner] = length > 0.0 ? glm::vec3(sum / length)
                     : hasArea    ? glm::vec3(own)
                                  : glm::vec3(0.0F, 0.0F, 1.0F);
  }
  return result;
}

}  // namespace limn
