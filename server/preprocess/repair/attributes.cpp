// SPDX-License-Identifier: Apache-2.0
//
// Faces go, turn and part while a mesh is repaired, so attributes do not travel with them: each
// face that is left finds the polygon that it was cut from, and with it the corners that the file
// has. A vertex takes the mean of its own corners, weighted by their angles, so what repair parts
// keeps its own colours, and how faces were cut makes no difference.
#include "server/preprocess/repair/repair_steps.h"

#include "shared/mesh/half_edge.h"
#include "shared/mesh/vertex_attributes.h"
#include "shared/progressive/vertex_split.h"

#include <algorithm>
#include <cmath>

namespace limn::repair {

namespace {

/// Colours further apart than this at both ends of an edge, in some channel, are a seam.
constexpr int kSeamContrast = 16;
/// Normals of one vertex that differ by more than this (cosine) are counted as blended.
constexpr double kSameNormalCosine = 0.9998;

std::array<std::uint32_t, 3> sorted(const glm::uvec3& t) {
  std::array<std::uint32_t, 3> result{t.x, t.y, t.z};
  std::sort(result.begin(), result.end());
  return result;
}

SrgbColor srgbOf(const glm::dvec3& linear) {
  return {srgbFromLinear(linear.x), srgbFromLinear(linear.y), srgbFromLinear(linear.z)};
}

bool isContrast(const SrgbColor& a, const SrgbColor& b) {
  const glm::ivec3 difference = glm::abs(glm::ivec3(a) - glm::ivec3(b));
  return std::max({difference.x, difference.y, difference.z}) > kSeamContrast;
}

bool isDirection(const glm::dvec3& v) {
  const double length = glm::length(v);
  return std::isfinite(length) && length > 1e-6;
}

/// Twice the area times the unit normal.
glm::dvec3 areaNormal(const Manifold& mesh, const glm::uvec3& t) {
  const glm::dvec3 a(mesh.positions[t.x]);
  return glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a);
}

/// Of corner k, radians; never 0, so that faces without area count for something.
double cornerAngle(const Manifold& mesh, const glm::uvec3& t, int k) {
  const glm::dvec3 p(mesh.positions[t[k]]);
  const glm::dvec3 a = glm::dvec3(mesh.positions[t[(k + 1) % 3]]) - p;
  const glm::dvec3 b = glm::dvec3(mesh.positions[t[(k + 2) % 3]]) - p;
  return std::max(1e-6, std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

}  // namespace

AttributeSource::AttributeSource(
    const ImportedMesh& input,
    const QuantizedPolygons& polygons,
    const Triangulation& triangulation)
    : input_(input),
      polygons_(polygons) {
  if (input.colors.empty() && input.normals.empty() && input.materials.empty()) return;
  faces_.reserve(triangulation.triangles.size());
  for (std::size_t t = 0; t < triangulation.triangles.size(); ++t) {
    const auto corners = sorted(triangulation.triangles[t]);
    faces_.push_back({corners[0], corners[1], corners[2], triangulation.polygons[t]});
  }
  std::sort(faces_.begin(), faces_.end());
}

std::array<AttributeSource::Corner, 3> AttributeSource::cornersOf(const glm::uvec3& merged) const {
  const auto key = sorted(merged);
  // Of copies of a face the first in the file speaks.
  const auto face = std::lower_bound(
      faces_.begin(),
      faces_.end(),
      std::array<std::uint32_t, 4>{key[0], key[1], key[2], 0});
  const std::uint32_t polygon = (*face)[3];
  std::array<Corner, 3> result;
  for (int k = 0; k < 3; ++k) {
    const auto begin = polygons_.corners.begin() + polygons_.polygonBegin[polygon];
    const auto end = polygons_.corners.begin() + polygons_.polygonBegin[polygon + 1];
    const auto at = std::find(begin, end, merged[k]) - polygons_.corners.begin();
    result[static_cast<std::size_t>(k)] = {
        polygon,
        polygons_.sources[static_cast<std::size_t>(at)]};
  }
  return result;
}

glm::dvec3 AttributeSource::colorOf(const Corner& corner) const {
  glm::dvec3 color(1.0);
  if (!input_.colors.empty()) color = input_.colors[corner.source];
  if (!input_.materials.empty() && !input_.materialColors.empty())
    color *=
        glm::dvec3(input_.materialColors[input_.materials[polygons_.polygons[corner.polygon]]]);
  return color;
}

AttributeSource::Carried AttributeSource::carry(const Manifold& mesh) const {
  Carried carried;
  if (faces_.empty()) return carried;
  const bool hasColors = !input_.colors.empty() || !input_.materialColors.empty();
  const bool hasNormals = !input_.normals.empty();
  const std::size_t vertices = mesh.positions.size();
  const std::size_t originals = vertices - mesh.copyOf.size();
  const auto merged = [&](std::uint32_t v) {
    return v < originals ? v : mesh.copyOf[v - originals];
  };

  std::vector<std::array<Corner, 3>> corners;
  corners.reserve(mesh.triangles.size());
  std::vector<glm::dvec3> colors(hasColors ? vertices : 0, glm::dvec3(0.0));
  std::vector<glm::dvec3> normals(hasNormals ? vertices : 0, glm::dvec3(0.0));
  std::vector<double> angles(vertices, 0.0);
  // Of the first corner of each vertex, to see whether others differ.
  std::vector<SrgbColor> firstColors(hasColors ? vertices : 0);
  std::vector<glm::dvec3> firstNormals(hasNormals ? vertices : 0);
  std::vector<std::uint8_t> differs(vertices, 0);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    corners.push_back(cornersOf({merged(t.x), merged(t.y), merged(t.z)}));
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = t[k];
      const Corner& corner = corners.back()[static_cast<std::size_t>(k)];
      const double angle = cornerAngle(mesh, t, k);
      const bool isFirst = angles[v] == 0.0;
      angles[v] += angle;
      if (hasColors) {
        const glm::dvec3 color = colorOf(corner);
        colors[v] += angle * color;
        if (isFirst) firstColors[v] = srgbOf(color);
        if (srgbOf(color) != firstColors[v]) differs[v] = 1;
      }
      if (hasNormals) {
        glm::dvec3 normal(input_.normals[corner.source]);
        if (!isDirection(normal)) continue;
        normal = glm::normalize(normal) * (mesh.flipped[f] != 0 ? -1.0 : 1.0);
        normals[v] += angle * normal;
        if (firstNormals[v] == glm::dvec3(0.0)) firstNormals[v] = normal;
        if (glm::dot(normal, firstNormals[v]) < kSameNormalCosine) differs[v] = 1;
      }
    }
  }
  for (const std::uint8_t is : differs)
    carried.blended += is;
  for (std::size_t v = 0; v < vertices && hasColors; ++v)
    carried.attributes.colors.push_back(srgbOf(colors[v] / std::max(angles[v], 1e-6)));

  if (hasNormals) {
    std::vector<glm::dvec3> surface(vertices, glm::dvec3(0.0));
    for (const glm::uvec3& t : mesh.triangles) {
      for (int k = 0; k < 3; ++k)
        surface[t[k]] += areaNormal(mesh, t);
    }
    for (std::size_t v = 0; v < vertices; ++v) {
      // Where the file says nothing, or normals cancel out, the surface's own is there.
      const bool isOwn = isDirection(normals[v]);
      const bool isSurface = !isOwn && isDirection(surface[v]);
      carried.attributes.normals.push_back(encodeNormal(
          isOwn       ? normals[v]
          : isSurface ? surface[v]
                      : glm::dvec3(0.0, 0.0, 1.0)));
    }
  }

  // Seams: between materials, and where colours jump along a whole edge.
  const auto links = HalfEdgeMesh::build(static_cast<std::uint32_t>(vertices), mesh.triangles);
  if (!links) return carried;
  std::vector<std::uint8_t> seams(links->twins.size(), 0);
  bool any = false;
  for (HalfEdgeId h = 0; h < seams.size(); ++h) {
    const HalfEdgeId twin = links->twins[h];
    if (twin == kNone || twin < h) continue;
    const std::uint32_t k = h % 3;
    const std::uint32_t m = twin % 3;
    const auto& here = corners[h / 3];
    const auto& there = corners[twin / 3];
    const auto jumps = [&](const Corner& a, const Corner& b) {
      return isContrast(srgbOf(colorOf(a)), srgbOf(colorOf(b)));
    };
    const bool changes =
        !input_.materials.empty() && input_.materials[polygons_.polygons[here[0].polygon]] !=
                                         input_.materials[polygons_.polygons[there[0].polygon]];
    const bool isSeam = changes || (hasColors && jumps(here[k], there[(m + 1) % 3]) &&
                                    jumps(here[(k + 1) % 3], there[m]));
    if (!isSeam) continue;
    seams[h] = seams[twin] = kFeatureSeam;
    any = true;
  }
  if (any) carried.seams = std::move(seams);
  return carried;
}

}  // namespace limn::repair
