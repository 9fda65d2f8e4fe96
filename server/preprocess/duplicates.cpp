// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/edge_groups.h"
#include "server/preprocess/repair_steps.h"

#include <algorithm>
#include <array>

namespace limn::repair {

namespace {

/// Double-sided pieces of less than this width (area over length, grid steps) are what quantisation
/// leaves of spikes, slivers and specks, not sheets that somebody drew: 0.1 % of the model at 14
/// bits.
constexpr double kSpeckWidth = 16.0;

struct Key {
  std::uint32_t middle;
  std::uint32_t largest;
  FaceId face;
  bool odd;  // orientation: parity of the permutation that sorts the corners

  [[nodiscard]] bool sameCorners(const Key& other) const {
    return middle == other.middle && largest == other.largest;
  }
};

/// kTwoSided: as many copies of one orientation as of the other; kRepeated: an even number
/// otherwise. Either may be a copy too many, or twice a face that should not be there at all.
enum class Fate : std::uint8_t { kKeep, kDrop, kTwoSided, kRepeated };

bool isDoubtful(Fate fate) {
  return fate == Fate::kTwoSided || fate == Fate::kRepeated;
}

/// One face of each set of three corners stays, in the orientation that more have; where their
/// number is even it is marked as doubtful.
std::vector<Fate> markCopies(std::uint32_t vertexCount, std::span<const glm::uvec3> triangles) {
  std::vector<Fate> fates(triangles.size(), Fate::kKeep);
  std::vector<std::uint32_t> bucket(std::size_t{vertexCount} + 1, 0);
  const auto smallest = [](const glm::uvec3& t) { return std::min({t.x, t.y, t.z}); };
  for (const glm::uvec3& t : triangles)
    ++bucket[smallest(t) + 1];
  for (std::uint32_t v = 0; v < vertexCount; ++v)
    bucket[v + 1] += bucket[v];
  std::vector<FaceId> faces(triangles.size());
  {
    std::vector<std::uint32_t> next(bucket.begin(), bucket.end() - 1);
    for (FaceId f = 0; f < triangles.size(); ++f)
      faces[next[smallest(triangles[f])]++] = f;
  }
  std::vector<Key> keys;
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    keys.clear();
    for (std::uint32_t i = bucket[v]; i < bucket[v + 1]; ++i) {
      const glm::uvec3& t = triangles[faces[i]];
      const int k = t.x == v ? 0 : t.y == v ? 1 : 2;
      const std::uint32_t second = t[(k + 1) % 3];
      const std::uint32_t third = t[(k + 2) % 3];
      keys.push_back({std::min(second, third), std::max(second, third), faces[i], second > third});
    }
    std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
      return std::array{a.middle, a.largest, a.face} < std::array{b.middle, b.largest, b.face};
    });
    for (std::size_t first = 0; first < keys.size();) {
      std::size_t last = first + 1;
      while (last < keys.size() && keys[last].sameCorners(keys[first]))
        ++last;
      if (last - first > 1) {
        const auto odd = std::count_if(
            keys.begin() + static_cast<std::ptrdiff_t>(first),
            keys.begin() + static_cast<std::ptrdiff_t>(last),
            [](const Key& k) { return k.odd; });
        const auto even = static_cast<std::ptrdiff_t>(last - first) - odd;
        bool kept = false;
        const Fate fate = odd == even               ? Fate::kTwoSided
                          : (last - first) % 2 == 0 ? Fate::kRepeated
                                                    : Fate::kKeep;
        for (std::size_t i = first; i < last; ++i) {
          const bool chosen = !kept && (odd == even || keys[i].odd == (odd > even));
          fates[keys[i].face] = chosen ? fate : Fate::kDrop;
          kept = kept || chosen;
        }
      }
      first = last;
    }
  }
  return fates;
}

void erase(std::vector<glm::uvec3>& triangles, std::vector<Fate>& fates) {
  std::size_t kept = 0;
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (fates[f] == Fate::kDrop) continue;
    triangles[kept] = triangles[f];
    fates[kept++] = fates[f];
  }
  triangles.resize(kept);
  fates.resize(kept);
}

/// Doubtful faces that share edges, and what the surface around them says.
struct Cluster {
  std::vector<FaceId> faces;
  std::uint64_t bordersIfKept = 0;     // edges with an odd number of faces, these counted once each
  std::uint64_t bordersIfDropped = 0;  // … and without them
  std::uint64_t freeEdges = 0;         // borders if kept where no other face is
  bool twoSided = true;                // every face of it cancels
  bool attached = false;               // other faces share an edge with it
  double area = 0.0;
  glm::ivec3 low{0};
  glm::ivec3 high{0};

  /// One copy stays, unless the surface is whole without any and has no place for one: a membrane
  /// inside it, or a sliver on it.
  [[nodiscard]] bool keepsOne() const {
    if (bordersIfKept <= bordersIfDropped) return true;
    const bool membrane = freeEdges == 0 && bordersIfDropped == 0;
    const glm::ivec3 extent = high - low;
    const bool speck = area < kSpeckWidth * std::max({extent.x, extent.y, extent.z});
    return !membrane && !((twoSided || attached) && speck);
  }
};

/// Decides for each cluster whether one copy of its faces stays or none.
void settleDoubtful(
    std::span<const glm::ivec3> positions,
    std::span<const glm::uvec3> triangles,
    std::vector<Fate>& fates) {
  const EdgeGroups groups(static_cast<std::uint32_t>(positions.size()), triangles);
  std::vector<std::uint32_t> groupOf(3 * triangles.size());
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    for (const HalfEdgeId h : groups[g])
      groupOf[h] = g;
  }
  std::vector<std::uint8_t> seen(triangles.size(), 0);
  std::vector<std::uint32_t> visitedBy(groups.size(), kNone);
  for (FaceId seed = 0; seed < triangles.size(); ++seed) {
    if (!isDoubtful(fates[seed]) || seen[seed] != 0) continue;
    Cluster cluster;
    cluster.faces.push_back(seed);
    seen[seed] = 1;
    cluster.low = cluster.high = positions[triangles[seed].x];
    for (std::size_t done = 0; done < cluster.faces.size(); ++done) {
      const FaceId face = cluster.faces[done];
      const glm::uvec3& t = triangles[face];
      cluster.twoSided = cluster.twoSided && fates[face] == Fate::kTwoSided;
      cluster.area += 0.5 * glm::length(glm::cross(
                                glm::dvec3(positions[t.y] - positions[t.x]),
                                glm::dvec3(positions[t.z] - positions[t.x])));
      for (int k = 0; k < 3; ++k) {
        cluster.low = glm::min(cluster.low, positions[t[k]]);
        cluster.high = glm::max(cluster.high, positions[t[k]]);
        const std::uint32_t group = groupOf[3 * face + static_cast<std::uint32_t>(k)];
        if (visitedBy[group] == seed) continue;
        visitedBy[group] = seed;
        std::uint64_t others = 0;
        for (const HalfEdgeId h : groups[group]) {
          const FaceId neighbor = h / 3;
          if (!isDoubtful(fates[neighbor])) {
            ++others;
          } else if (seen[neighbor] == 0) {
            seen[neighbor] = 1;
            cluster.faces.push_back(neighbor);
          }
        }
        cluster.attached = cluster.attached || others > 0;
        const bool odd = groups[group].size() % 2 == 1;
        cluster.bordersIfKept += odd ? 1 : 0;
        cluster.freeEdges += odd && others == 0 ? 1 : 0;
        cluster.bordersIfDropped += others % 2;
      }
    }
    // Clusters share no edge: a fate settled here is not looked at again.
    const Fate fate = cluster.keepsOne() ? Fate::kKeep : Fate::kDrop;
    for (const FaceId face : cluster.faces)
      fates[face] = fate;
  }
}

}  // namespace

std::uint64_t dropDuplicates(
    std::span<const glm::ivec3> positions,
    std::vector<glm::uvec3>& triangles) {
  const std::size_t before = triangles.size();
  std::vector<Fate> fates = markCopies(static_cast<std::uint32_t>(positions.size()), triangles);
  erase(triangles, fates);
  if (std::any_of(fates.begin(), fates.end(), isDoubtful)) {
    settleDoubtful(positions, triangles, fates);
    erase(triangles, fates);
  }
  return before - triangles.size();
}

}  // namespace limn::repair
