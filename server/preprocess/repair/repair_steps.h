// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/import/import.h"

#include "shared/core/ids.h"
#include "shared/core/result.h"
#include "shared/mesh/triangle_mesh.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

// The steps of repairMesh, in its order. All work on grid positions and are deterministic.
namespace limn::repair {

/// The input on the grid: referenced vertices only, equal positions merged.
struct QuantizedPolygons {
  Grid grid;
  std::vector<glm::ivec3> positions;
  std::vector<std::uint32_t> polygonBegin{0};
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> sources;   // one a corner: the input's vertex
  std::vector<std::uint32_t> polygons;  // one a polygon: the input's
  std::uint64_t droppedFaces = 0;       // with invalid or non-finite corners
  std::uint64_t droppedVertices = 0;    // that no remaining face refers to
  std::uint64_t mergedVertices = 0;
};

/// Drops what cannot be used, then quantises: origin the minimum of the referenced vertices, step
/// the longest side / (2^bits − 1), nearest. Errors: kCorrupt, nothing left or no extent.
[[nodiscard]] Result<QuantizedPolygons> quantize(const ImportedMesh& input, int bits);

struct Triangulation {
  std::vector<glm::uvec3> triangles;
  std::vector<std::uint32_t> polygons;  // one a triangle: which it was cut from
  std::uint64_t triangulated = 0;       // polygons with more than three corners
  std::uint64_t droppedFaces = 0;       // polygons with fewer than three different corners
};

/// Cuts polygons into triangles without new vertices, concave ones inside their outline. Triangles
/// with two equal corners are left out.
[[nodiscard]] Triangulation triangulate(const QuantizedPolygons& polygons);

/// Triangulates one polygon of four or more corners, all different. Tries, in this order: the
/// better diagonal of a quadrilateral, CGAL's constrained Delaunay triangulation of the projection
/// along the dominant axis of the normal, ear clipping (up to 512 corners), a fan.
void triangulatePolygon(
    std::span<const glm::ivec3> positions,
    std::span<const std::uint32_t> corners,
    std::vector<glm::uvec3>& out);

/// Removes copies of faces, keeping the order of the rest. Returns how many faces went. What
/// happens to faces whose two sides are both present: README.md, "Repair".
[[nodiscard]] std::uint64_t dropDuplicates(
    std::span<const glm::ivec3> positions,
    std::vector<glm::uvec3>& triangles);

/// An oriented manifold, with the links between its half-edges. Vertices keep their numbers; the
/// copies that were split off follow.
struct Manifold {
  std::vector<glm::ivec3> positions;
  std::vector<std::uint32_t> copyOf;  // the vertex that each copy is of
  std::vector<glm::uvec3> triangles;
  std::vector<HalfEdgeId> twins;      // kNone on a border
  std::vector<std::uint8_t> flipped;  // one a triangle: turned against the input
  std::uint64_t splitVertices = 0;
};

/// Orients each piece consistently, by the majority of its faces, and parts faces that meet in ways
/// a manifold does not have, by giving them vertices of their own at the same place.
[[nodiscard]] Manifold makeManifold(
    std::vector<glm::ivec3> positions,
    std::vector<glm::uvec3> triangles);

/// Turns closed components outward, cavities inward. README.md, "Repair".
void orientOutward(Manifold& mesh);

/// What the input's vertices, corners and faces carry besides positions, and how to find it again:
/// README.md, "Attributes".
class AttributeSource {
 public:
  /// Keeps references: all three outlive this. triangulation: as triangulate() left it.
  AttributeSource(
      const ImportedMesh& input,
      const QuantizedPolygons& polygons,
      const Triangulation& triangulation);

  struct Carried {
    AttributeArrays attributes;       // by vertex
    std::vector<std::uint8_t> seams;  // kFeatureSeam or 0 a half-edge; empty: none is
    std::uint64_t blended = 0;        // vertices whose corners differ
  };

  /// For the manifold that came of the triangles, copies of faces left out.
  [[nodiscard]] Carried carry(const Manifold& mesh) const;

 private:
  /// A corner's polygon and number there, both by `polygons_`.
  struct Corner {
    std::uint32_t polygon = 0;
    std::uint32_t source = 0;  // the input's vertex
  };

  [[nodiscard]] std::array<Corner, 3> cornersOf(const glm::uvec3& merged) const;
  [[nodiscard]] glm::dvec3 colorOf(const Corner& corner) const;  // linear

  const ImportedMesh& input_;
  const QuantizedPolygons& polygons_;
  std::vector<std::array<std::uint32_t, 4>> faces_;  // sorted corners, polygon; sorted
};

}  // namespace limn::repair
