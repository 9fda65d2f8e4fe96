// SPDX-License-Identifier: Apache-2.0
// Based on: A. Guéziec, G. Taubin, F. Lazarus, W. Horn, "Cutting and Stitching: Converting Sets of
// Polygons to Manifold Surfaces", IEEE TVCG 7(2), 2001: cut at what is not manifold, then stitch
// what may be. Our stitching pairs the faces around an edge so that solids that touch there part,
// each closed; the test compares with CGAL's orient_polygon_soup, which leaves such edges cut.
#include "server/preprocess/repair/edge_groups.h"
#include "server/preprocess/repair/repair_steps.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limn::repair {

namespace {

HalfEdgeId next(HalfEdgeId h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}

HalfEdgeId previous(HalfEdgeId h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}

/// Which triangles to turn so that neighbours across two-sided edges agree wherever they can: each
/// patch by breadth-first search from its first face, then as the majority of its faces was.
std::vector<std::uint8_t> orientPatches(
    std::span<const glm::uvec3> triangles,
    const EdgeGroups& groups) {
  std::vector<HalfEdgeId> partner(3 * triangles.size(), kNone);
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    const auto group = groups[g];
    if (group.size() != 2) continue;
    partner[group[0]] = group[1];
    partner[group[1]] = group[0];
  }
  constexpr std::uint8_t kUnseen = 2;
  std::vector<std::uint8_t> flipped(triangles.size(), kUnseen);
  std::vector<FaceId> queue;
  for (FaceId seed = 0; seed < triangles.size(); ++seed) {
    if (flipped[seed] != kUnseen) continue;
    queue.assign(1, seed);
    flipped[seed] = 0;
    std::size_t turned = 0;
    for (std::size_t done = 0; done < queue.size(); ++done) {
      const FaceId face = queue[done];
      turned += flipped[face];
      for (HalfEdgeId h = 3 * face; h < 3 * face + 3; ++h) {
        const HalfEdgeId other = partner[h];
        if (other == kNone || flipped[other / 3] != kUnseen) continue;
        const bool sameDirection = originOf(triangles, h) == originOf(triangles, other);
        flipped[other / 3] =
            static_cast<std::uint8_t>(sameDirection ? 1 - flipped[face] : flipped[face]);
        queue.push_back(other / 3);
      }
    }
    if (2 * turned > queue.size()) {
      for (const FaceId face : queue)
        flipped[face] = static_cast<std::uint8_t>(1 - flipped[face]);
    }
  }
  return flipped;
}

/// Pairs the half-edges of an edge with three or more faces. Around the directed edge a → b, a face
/// that runs along it has its inside clockwise, one that runs against it counter-clockwise; so in
/// counter-clockwise order "against" opens a wedge of solid and "along" closes it: brackets. For
/// wedges of void it is the other way round.
enum class Wedge { kSolid, kVoid };

void pairAroundEdge(
    Wedge wedge,
    std::span<const glm::ivec3> positions,
    std::span<const glm::uvec3> triangles,
    std::span<const HalfEdgeId> group,
    std::vector<HalfEdgeId>& twins) {
  struct Spoke {
    double angle;
    HalfEdgeId halfEdge;
    bool opens;
  };

  const std::uint32_t a = std::min(originOf(triangles, group[0]), targetOf(triangles, group[0]));
  const std::uint32_t b = std::max(originOf(triangles, group[0]), targetOf(triangles, group[0]));
  const glm::dvec3 origin(positions[a]);
  const glm::dvec3 axis = glm::dvec3(positions[b]) - origin;
  const auto apex = [&](HalfEdgeId h) {
    return glm::dvec3(positions[originOf(triangles, previous(h))]) - origin;
  };
  // A spoke on the axis has no angle; a reference without one gives all the angle 0, which is still
  // an order, by number.
  glm::dvec3 reference(0.0);
  for (const HalfEdgeId h : group) {
    reference = glm::cross(axis, apex(h));
    if (reference != glm::dvec3(0.0)) break;
  }
  std::vector<Spoke> spokes;
  spokes.reserve(group.size());
  for (const HalfEdgeId h : group) {
    const glm::dvec3 side = glm::cross(axis, apex(h));
    const double sine = glm::dot(axis, glm::cross(reference, side)) / glm::length(axis);
    spokes.push_back(
        {std::atan2(sine, glm::dot(reference, side)),
         h,
         (originOf(triangles, h) != a) == (wedge == Wedge::kSolid)});
  }
  std::sort(spokes.begin(), spokes.end(), [](const Spoke& x, const Spoke& y) {
    return x.angle != y.angle ? x.angle < y.angle : x.halfEdge < y.halfEdge;
  });
  // Twice round the circle closes wedges that straddle its beginning.
  std::vector<HalfEdgeId> open;
  for (int round = 0; round < 2; ++round) {
    for (const Spoke& spoke : spokes) {
      if (twins[spoke.halfEdge] != kNone) continue;
      if (spoke.opens) {
        if (round == 0) open.push_back(spoke.halfEdge);
      } else if (!open.empty()) {
        twins[spoke.halfEdge] = open.back();
        twins[open.back()] = spoke.halfEdge;
        open.pop_back();
      }
    }
  }
}

/// Gives each fan of linked faces around a vertex a vertex of its own. Returns, for each half-edge,
/// the vertex it leaves from, and for each vertex beyond the first `vertexCount` which one it
/// copies.
struct Fans {
  std::vector<std::uint32_t> origins;
  std::vector<std::uint32_t> copyOf;
};

Fans separateFans(
    std::uint32_t vertexCount,
    std::span<const glm::uvec3> triangles,
    std::span<const HalfEdgeId> twins) {
  Fans fans;
  const auto halfEdges = static_cast<HalfEdgeId>(twins.size());
  fans.origins.assign(halfEdges, kNone);
  std::vector<std::uint8_t> used(vertexCount, 0);
  for (HalfEdgeId seed = 0; seed < halfEdges; ++seed) {
    if (fans.origins[seed] != kNone) continue;
    std::uint32_t vertex = originOf(triangles, seed);
    if (used[vertex] != 0) {
      fans.copyOf.push_back(vertex);
      vertex = vertexCount + static_cast<std::uint32_t>(fans.copyOf.size()) - 1;
    } else {
      used[vertex] = 1;
    }
    HalfEdgeId h = seed;
    do {  // counter-clockwise
      fans.origins[h] = vertex;
      h = twins[previous(h)];
    } while (h != kNone && h != seed);
    if (h == seed) continue;
    for (h = seed; twins[h] != kNone;) {  // and clockwise from the first
      h = next(twins[h]);
      fans.origins[h] = vertex;
    }
  }
  return fans;
}

/// After separation: the edges that still have two faces on one side, because both their ends are
/// joined round about.
std::vector<std::uint32_t> crowdedEdges(const EdgeGroups& groups, const Fans& fans) {
  std::vector<std::uint32_t> crowded;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> directed;
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    const auto group = groups[g];
    if (group.size() < 3) continue;
    directed.clear();
    for (const HalfEdgeId h : group)
      directed.emplace_back(fans.origins[h], fans.origins[next(h)]);
    std::sort(directed.begin(), directed.end());
    if (std::adjacent_find(directed.begin(), directed.end()) != directed.end())
      crowded.push_back(g);
  }
  return crowded;
}

/// Links border half-edges that ended up as the two sides of one edge: a fan cut open and closed on
/// itself. HalfEdgeMesh::build would link them too.
void closeSeams(const EdgeGroups& groups, const Fans& fans, std::vector<HalfEdgeId>& twins) {
  struct Border {
    std::uint32_t low;
    std::uint32_t high;
    HalfEdgeId halfEdge;
  };

  std::vector<Border> borders;
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    const auto group = groups[g];
    if (group.size() < 2) continue;
    borders.clear();
    for (const HalfEdgeId h : group) {
      if (twins[h] != kNone) continue;
      const auto [low, high] = std::minmax(fans.origins[h], fans.origins[next(h)]);
      borders.push_back({low, high, h});
    }
    std::sort(borders.begin(), borders.end(), [](const Border& a, const Border& b) {
      return std::array{a.low, a.high, a.halfEdge} < std::array{b.low, b.high, b.halfEdge};
    });
    // No edge is crowded any more: at most two share both ends, in opposite directions.
    for (std::size_t i = 1; i < borders.size(); ++i) {
      if (borders[i - 1].low != borders[i].low || borders[i - 1].high != borders[i].high) continue;
      twins[borders[i - 1].halfEdge] = borders[i].halfEdge;
      twins[borders[i].halfEdge] = borders[i - 1].halfEdge;
    }
  }
}

}  // namespace

Manifold makeManifold(std::vector<glm::ivec3> positions, std::vector<glm::uvec3> triangles) {
  Manifold mesh;
  const auto vertexCount = static_cast<std::uint32_t>(positions.size());
  EdgeGroups groups(vertexCount, triangles);
  mesh.flipped = orientPatches(triangles, groups);
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (mesh.flipped[f] != 0) std::swap(triangles[f].y, triangles[f].z);
  }
  groups.renumberFlipped(mesh.flipped);

  mesh.twins.assign(3 * triangles.size(), kNone);
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    const auto group = groups[g];
    if (group.size() > 2) {
      pairAroundEdge(Wedge::kSolid, positions, triangles, group, mesh.twins);
    } else if (
        group.size() == 2 && originOf(triangles, group[0]) != originOf(triangles, group[1])) {
      mesh.twins[group[0]] = group[1];
      mesh.twins[group[1]] = group[0];
    }  // else a border, or where a one-sided surface was cut open
  }
  Fans fans = separateFans(vertexCount, triangles, mesh.twins);
  // A solid that touches itself along one edge stays joined at both its ends. Joining its faces
  // across the void instead parts the ends and keeps the surface closed.
  if (const auto crowded = crowdedEdges(groups, fans); !crowded.empty()) {
    for (const std::uint32_t g : crowded) {
      for (const HalfEdgeId h : groups[g])
        mesh.twins[h] = kNone;
      pairAroundEdge(Wedge::kVoid, positions, triangles, groups[g], mesh.twins);
    }
    fans = separateFans(vertexCount, triangles, mesh.twins);
  }
  // What is crowded even so is cut open. That always ends it: of faces on one side of the edge each
  // now begins a fan of its own, and cutting never joins fans elsewhere.
  if (const auto crowded = crowdedEdges(groups, fans); !crowded.empty()) {
    for (const std::uint32_t g : crowded) {
      for (const HalfEdgeId h : groups[g])
        mesh.twins[h] = kNone;
    }
    fans = separateFans(vertexCount, triangles, mesh.twins);
  }
  closeSeams(groups, fans, mesh.twins);

  mesh.splitVertices = fans.copyOf.size();
  mesh.positions = std::move(positions);
  mesh.positions.reserve(mesh.positions.size() + fans.copyOf.size());
  for (const std::uint32_t original : fans.copyOf)
    mesh.positions.push_back(mesh.positions[original]);
  mesh.copyOf = std::move(fans.copyOf);
  mesh.triangles = std::move(triangles);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    mesh.triangles[f] = {fans.origins[3 * f], fans.origins[3 * f + 1], fans.origins[3 * f + 2]};
  }
  return mesh;
}

}  // namespace limn::repair
