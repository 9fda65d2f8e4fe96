// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/repair/repair.h"

#include "server/preprocess/repair/repair_steps.h"

#include "shared/core/assert.h"
#include "shared/core/disjoint_sets.h"
#include "shared/mesh/half_edge.h"

#include <algorithm>
#include <numeric>

namespace limn {

namespace {

/// The input's own topology, for the report.
struct InputShape {
  std::uint32_t components = 0;
  bool closed = false;
};

/// The vertex that stands for each vertex: itself, but in formats that store a vertex once for each
/// face or smooth group, the first at its position.
std::vector<std::uint32_t> representatives(const ImportedMesh& input) {
  std::vector<std::uint32_t> same(input.positions.size());
  std::iota(same.begin(), same.end(), 0U);
  if (input.format != "stl" && input.format != "glb" && input.format != "gltf") return same;
  std::vector<std::uint32_t> order = same;
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const glm::dvec3& p = input.positions[a];
    const glm::dvec3& q = input.positions[b];
    if (p.x < q.x || q.x < p.x) return p.x < q.x;
    if (p.y < q.y || q.y < p.y) return p.y < q.y;
    if (p.z < q.z || q.z < p.z) return p.z < q.z;
    return a < b;
  };
  // NaN has no place in an order; such vertices stay alone, at the end.
  const auto finite = std::partition(order.begin(), order.end(), [&](std::uint32_t v) {
    return !glm::any(glm::isnan(input.positions[v]));
  });
  std::sort(order.begin(), finite, less);
  for (auto it = order.begin(); it != finite; ++it) {
    if (it != order.begin() && input.positions[*(it - 1)] == input.positions[*it])
      same[*it] = same[*(it - 1)];
  }
  return same;
}

/// Pieces connected over shared edges, and whether no edge has only one face.
InputShape measureInput(const ImportedMesh& input) {
  const auto polygons = static_cast<std::uint32_t>(input.polygonBegin.size() - 1);
  const std::vector<std::uint32_t> same = representatives(input);

  struct Side {
    std::uint64_t edge;
    std::uint32_t polygon;
  };

  std::vector<Side> sides;
  sides.reserve(input.corners.size());
  for (std::uint32_t p = 0; p < polygons; ++p) {
    const std::uint32_t begin = input.polygonBegin[p];
    const std::uint32_t end = input.polygonBegin[p + 1];
    const bool valid = std::all_of(
        input.corners.begin() + begin,
        input.corners.begin() + end,
        [&](std::uint32_t corner) { return corner < same.size(); });
    for (std::uint32_t c = begin; valid && c < end; ++c) {
      const std::uint32_t a = same[input.corners[c]];
      const std::uint32_t b = same[input.corners[c + 1 < end ? c + 1 : begin]];
      if (a != b)
        sides.push_back({static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b), p});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.polygon < b.polygon;
  });
  DisjointSets components(polygons);
  InputShape shape;
  shape.closed = !sides.empty();
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t last = first + 1;
    while (last < sides.size() && sides[last].edge == sides[first].edge) {
      components.join(sides[last].polygon, sides[first].polygon);
      ++last;
    }
    shape.closed = shape.closed && last - first > 1;
    first = last;
  }
  for (std::uint32_t p = 0; p < polygons; ++p)
    shape.components += components.rootOf(p) == p ? 1 : 0;
  return shape;
}

/// Drops vertices without a face, keeping the order of the rest. Returns how many went.
std::uint64_t dropIsolated(TriangleMesh& mesh) {
  std::vector<std::uint32_t> renumbered(mesh.positions.size(), 0);
  for (const glm::uvec3& t : mesh.triangles)
    renumbered[t.x] = renumbered[t.y] = renumbered[t.z] = 1;
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < renumbered.size(); ++v) {
    if (renumbered[v] == 0) continue;
    mesh.positions[kept] = mesh.positions[v];
    if (!mesh.attributes.colors.empty()) mesh.attributes.colors[kept] = mesh.attributes.colors[v];
    if (!mesh.attributes.normals.empty())
      mesh.attributes.normals[kept] = mesh.attributes.normals[v];
    renumbered[v] = kept++;
  }
  const std::uint64_t dropped = mesh.positions.size() - kept;
  mesh.positions.resize(kept);
  if (!mesh.attributes.colors.empty()) mesh.attributes.colors.resize(kept);
  if (!mesh.attributes.normals.empty()) mesh.attributes.normals.resize(kept);
  for (glm::uvec3& t : mesh.triangles)
    t = {renumbered[t.x], renumbered[t.y], renumbered[t.z]};
  return dropped;
}

}  // namespace

Result<RepairedMesh> repairMesh(const ImportedMesh& input, const RepairOptions& options) {
  if (options.quantizationBits < 11 || options.quantizationBits > 18) {
    return fail(
        ErrorCode::kInvalidArgument,
        "quantisation of " + std::to_string(options.quantizationBits) + " bits: choose 11 to 18");
  }
  RepairedMesh result;
  result.inputVertices = input.positions.size();
  result.inputFaces = input.corners.size() - 2 * (input.polygonBegin.size() - 1);
  const InputShape shape = measureInput(input);
  result.inputComponents = shape.components;
  result.inputClosed = shape.closed;

  auto quantized = repair::quantize(input, options.quantizationBits);
  if (!quantized) return tl::unexpected(quantized.error());
  repair::Triangulation triangulation = repair::triangulate(*quantized);
  std::vector<glm::uvec3>& triangles = triangulation.triangles;
  const repair::AttributeSource attributes(input, *quantized, triangulation);
  std::uint64_t droppedFaces =
      input.droppedFaces + quantized->droppedFaces + triangulation.droppedFaces;
  const auto degenerate = [](const glm::uvec3& t) {
    return t.x == t.y || t.y == t.z || t.z == t.x;
  };
  droppedFaces += std::erase_if(triangles, degenerate);
  droppedFaces += repair::dropDuplicates(quantized->positions, triangles);
  if (triangles.empty()) {
    return fail(
        ErrorCode::kCorrupt,
        "every face is degenerate at " + std::to_string(options.quantizationBits) +
            " bits: nothing to draw; check the model's scale or use more bits");
  }

  repair::Manifold manifold =
      repair::makeManifold(std::move(quantized->positions), std::move(triangles));
  repair::orientOutward(manifold);
  const auto flipped =
      std::accumulate(manifold.flipped.begin(), manifold.flipped.end(), std::uint64_t{0});

  repair::AttributeSource::Carried carried = attributes.carry(manifold);
  result.mesh.attributes = std::move(carried.attributes);
  result.seams = std::move(carried.seams);
  result.mesh.grid = quantized->grid;
  result.mesh.positions = std::move(manifold.positions);
  result.mesh.triangles = std::move(manifold.triangles);
  const std::uint64_t droppedVertices = quantized->droppedVertices + dropIsolated(result.mesh);

  const auto linked = HalfEdgeMesh::build(
      static_cast<std::uint32_t>(result.mesh.positions.size()),
      result.mesh.triangles);
  LIMN_ASSERT(linked.has_value());
  if (!linked)
    return tl::unexpected(
        linked.error().within("repair left the mesh broken (please report this file)"));
  result.closed =
      std::find(linked->twins.begin(), linked->twins.end(), kNone) == linked->twins.end();

  const auto count = [&](const char* kind, std::uint64_t number) {
    if (number > 0) result.repairs[kind] = number;
  };
  count("dropped_faces", droppedFaces);
  count("dropped_vertices", droppedVertices);
  count("merged_vertices", quantized->mergedVertices);
  count("triangulated", triangulation.triangulated);
  count("flipped", flipped);
  count("split_vertices", manifold.splitVertices);
  count("blended_attributes", carried.blended);
  return result;
}

}  // namespace limn
