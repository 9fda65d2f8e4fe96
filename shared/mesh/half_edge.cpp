// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/half_edge.h"

#include <algorithm>
#include <string>

namespace limn {

static_assert(
    sizeof(glm::uvec3) == 3 * sizeof(std::uint32_t),
    "triangles() views origins as uvec3");

HalfEdgeId HalfEdgeMesh::find(std::uint32_t a, std::uint32_t b) const {
  const HalfEdgeId first = outgoing[a];
  for (HalfEdgeId h = first; h != kNone;) {
    if (target(h) == b) return h;
    h = rotateCcw(h);
    if (h == first) break;
  }
  return kNone;
}

void HalfEdgeMesh::ring(std::uint32_t v, std::vector<std::uint32_t>& out) const {
  out.clear();
  const HalfEdgeId first = outgoing[v];
  for (HalfEdgeId h = first; h != kNone;) {
    out.push_back(target(h));
    const HalfEdgeId following = rotateCcw(h);
    if (following == kNone) out.push_back(origins[prev(h)]);
    h = following;
    if (h == first) break;
  }
}

std::span<const glm::uvec3> HalfEdgeMesh::triangles() const {
  return {reinterpret_cast<const glm::uvec3*>(origins.data()), faceCount()};
}

namespace {

Error nonManifold(std::string what) {
  return {ErrorCode::kNonManifold, std::move(what)};
}

std::string edgeName(std::uint32_t a, std::uint32_t b) {
  return std::to_string(a) + "-" + std::to_string(b);
}

}  // namespace

Result<HalfEdgeMesh> HalfEdgeMesh::build(
    std::uint32_t vertexCount,
    std::span<const glm::uvec3> triangles) {
  HalfEdgeMesh mesh;
  const auto halfEdges = static_cast<std::uint32_t>(3 * triangles.size());
  mesh.origins.resize(halfEdges);
  mesh.twins.assign(halfEdges, kNone);
  mesh.outgoing.assign(vertexCount, kNone);

  // Half-edges in buckets by their smaller end (a counting sort), each bucket sorted by the larger:
  // the sides of an edge become neighbours, however many faces meet at a vertex.
  std::vector<std::uint32_t> bucket(std::size_t{vertexCount} + 1, 0);
  for (FaceId f = 0; f < triangles.size(); ++f) {
    const glm::uvec3& t = triangles[f];
    if (t.x == t.y || t.y == t.z || t.z == t.x) {
      return tl::unexpected(nonManifold("face " + std::to_string(f) + " repeats a corner"));
    }
    for (int k = 0; k < 3; ++k) {
      if (t[k] >= vertexCount) {
        return tl::unexpected(nonManifold(
            "face " + std::to_string(f) + " has corner " + std::to_string(t[k]) + " of " +
            std::to_string(vertexCount)));
      }
      mesh.origins[3 * f + static_cast<std::uint32_t>(k)] = t[k];
    }
  }
  const auto smaller = [&](HalfEdgeId h) { return std::min(mesh.origins[h], mesh.target(h)); };
  const auto larger = [&](HalfEdgeId h) { return std::max(mesh.origins[h], mesh.target(h)); };
  for (HalfEdgeId h = 0; h < halfEdges; ++h)
    ++bucket[smaller(h) + 1];
  for (std::uint32_t v = 0; v < vertexCount; ++v)
    bucket[v + 1] += bucket[v];
  std::vector<HalfEdgeId> sides(halfEdges);
  {
    std::vector<std::uint32_t> place(bucket.begin(), bucket.end() - 1);
    for (HalfEdgeId h = 0; h < halfEdges; ++h)
      sides[place[smaller(h)]++] = h;
  }
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    std::sort(
        sides.begin() + bucket[v],
        sides.begin() + bucket[v + 1],
        [&](HalfEdgeId a, HalfEdgeId b) {
          // Of one edge, the half-edges out of v come first.
          if (larger(a) != larger(b)) return larger(a) < larger(b);
          return mesh.origins[a] != mesh.origins[b] ? mesh.origins[a] < mesh.origins[b] : a < b;
        });
    for (std::uint32_t i = bucket[v] + 1; i < bucket[v + 1]; ++i) {
      const HalfEdgeId h = sides[i - 1];
      const HalfEdgeId other = sides[i];
      if (larger(h) != larger(other)) continue;
      if (mesh.origins[h] == mesh.origins[other]) {
        return tl::unexpected(nonManifold(
            "edge " + edgeName(mesh.origins[h], mesh.target(h)) +
            " occurs twice in one direction"));
      }
      mesh.twins[h] = other;
      mesh.twins[other] = h;
    }
  }
  // A border vertex has exactly one outgoing half-edge without a twin; more mean more fans.
  std::vector<std::uint32_t> degree(vertexCount, 0);
  for (HalfEdgeId h = 0; h < halfEdges; ++h) {
    const std::uint32_t v = mesh.origins[h];
    ++degree[v];
    if (mesh.outgoing[v] == kNone || mesh.twins[h] == kNone) mesh.outgoing[v] = h;
  }
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    std::uint32_t fan = 0;
    const HalfEdgeId first = mesh.outgoing[v];
    for (HalfEdgeId h = first; h != kNone;) {
      ++fan;
      h = mesh.rotateCcw(h);
      if (h == first) break;
    }
    if (fan != degree[v]) {
      return tl::unexpected(
          nonManifold("vertex " + std::to_string(v) + " has more than one fan of faces"));
    }
  }
  return mesh;
}

Result<void> validate(const HalfEdgeMesh& mesh) {
  if (mesh.origins.size() % 3 != 0 || mesh.twins.size() != mesh.origins.size()) {
    return fail(ErrorCode::kNonManifold, "array sizes disagree");
  }
  auto rebuilt = HalfEdgeMesh::build(mesh.vertexCount(), mesh.triangles());
  if (!rebuilt) return tl::unexpected(rebuilt.error());
  if (rebuilt->twins != mesh.twins)
    return fail(ErrorCode::kNonManifold, "twins do not match the faces");
  for (std::uint32_t v = 0; v < mesh.vertexCount(); ++v) {
    const HalfEdgeId h = mesh.outgoing[v];
    if (h == kNone ? rebuilt->outgoing[v] != kNone
                   : h >= mesh.origins.size() || mesh.origins[h] != v ||
                         (rebuilt->isBorderVertex(v) && mesh.twins[h] != kNone)) {
      return fail(
          ErrorCode::kNonManifold,
          "outgoing half-edge of vertex " + std::to_string(v) + " is wrong");
    }
  }
  return {};
}

}  // namespace limn
