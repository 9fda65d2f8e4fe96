// SPDX-License-Identifier: Apache-2.0
// Based on: A. Hertzmann, D. Zorin, "Illustrating Smooth Surfaces", SIGGRAPH 2000 (the field
// normal · view, interpolated over a mesh). G. Thürmer, C. A. Wüthrich, "Computing Vertex Normals
// from Polygonal Facets", J. Graphics Tools 3(1), 1998 (angle weights).
// Deviations: integer normals, exact up to their last rounding; corner angles by the polynomial
// 4.4.45 of Abramowitz and Stegun (7e-5 rad), which unlike std::acos is the same on every platform.
#include "shared/silhouette/field.h"

#include "shared/core/assert.h"
#include "shared/core/integer_vectors.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limn {
namespace {

glm::vec4 planeThrough(const glm::dvec3& normal, const glm::ivec3& point) {
  const glm::vec3 n(normal);
  return {n, static_cast<float>(-glm::dot(glm::dvec3(n), glm::dvec3(point)))};
}

double angleFromCosine(double cosine) {
  const double x = std::min(std::abs(cosine), 1.0);
  const double angle =
      std::sqrt(1.0 - x) * (1.5707288 + x * (-0.2121144 + x * (0.0742610 - 0.0187293 * x)));
  return cosine < 0.0 ? 3.14159265358979 - angle : angle;
}

std::vector<glm::vec4> facePlanes(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    const glm::ivec3& center) {
  std::vector<glm::vec4> planes;
  planes.reserve(mesh.faceCount());
  for (const glm::uvec3& t : mesh.triangles()) {
    const glm::ivec3 a = positions[t.x];
    const glm::i64vec3 normal =
        crossExact(glm::i64vec3(positions[t.y] - a), glm::i64vec3(positions[t.z] - a));
    planes.push_back(planeThrough(glm::dvec3(normal), a - center));
  }
  return planes;
}

std::vector<VertexSite> vertexSites(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    const glm::ivec3& center) {
  std::vector<glm::dvec3> sums(mesh.vertexCount(), glm::dvec3(0.0));
  for (const glm::uvec3& t : mesh.triangles()) {
    const std::array<glm::ivec3, 3> corners = {positions[t.x], positions[t.y], positions[t.z]};
    const glm::dvec3 normal(
        crossExact(glm::i64vec3(corners[1] - corners[0]), glm::i64vec3(corners[2] - corners[0])));
    const double area = glm::length(normal);
    if (area == 0.0) continue;
    const glm::dvec3 unit = normal / area;
    std::array<glm::dvec3, 3> edges;  // edge k: from corner k to the next
    std::array<double, 3> lengths{};
    for (std::size_t k = 0; k < 3; ++k) {
      edges[k] = glm::dvec3(corners[(k + 1) % 3] - corners[k]);
      lengths[k] = glm::length(edges[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t before = (k + 2) % 3;
      const double cosine = -glm::dot(edges[k], edges[before]) / (lengths[k] * lengths[before]);
      sums[t[static_cast<int>(k)]] += angleFromCosine(cosine) * unit;
    }
  }
  std::vector<VertexSite> sites(mesh.vertexCount());
  for (std::size_t v = 0; v < sums.size(); ++v) {
    const double length = glm::length(sums[v]);
    // Faces that cancel out (a flat flap) leave no direction: back, like a face without area.
    if (length > 1e-9) sites[v].plane = planeThrough(sums[v] / length, positions[v] - center);
    sites[v].position = glm::vec4(glm::vec3(positions[v]), 0.0F);
  }
  return sites;
}

}  // namespace

SilhouetteField::SilhouetteField(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    SilhouetteKind kind)
    : mesh_(&mesh),
      positions_(positions),
      kind_(kind) {
  LIMN_ASSERT(positions.size() == mesh.vertexCount());
  if (!positions.empty()) {
    glm::ivec3 low = positions[0];
    glm::ivec3 high = positions[0];
    for (const glm::ivec3& p : positions) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    center_ = low + (high - low) / 2;
  }
  hasBorder_ = std::find(mesh.twins.begin(), mesh.twins.end(), kNone) != mesh.twins.end();
  if (kind == SilhouetteKind::kEdges) {
    facePlanes_ = facePlanes(mesh, positions, center_);
  } else {
    vertices_ = vertexSites(mesh, positions, center_);
  }
}

glm::vec4 SilhouetteField::eyeOf(const SilhouetteView& view) const {
  if (view.orthographic) return glm::vec4(glm::vec3(-view.forward), 0.0F);
  return glm::vec4(glm::vec3(view.eye - glm::dvec3(center_)), 1.0F);
}

}  // namespace limn
