// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/edge_groups.h"
#include "server/preprocess/repair_steps.h"

#include <algorithm>
#include <array>

namespace limn::repair {

namespace {

/// Double-sided pieces below this size (grid steps) are what quantisation leaves of thin spikes and
/// specks, not sheets that somebody drew: 0.1 % of the model at 14 bits.
constexpr int kSpeck = 16;

struct Key {
  std::uint32_t middle;
  std::uint32_t largest;
  FaceId face;
  bool odd;  // orientation: parity of the permutation that sorts the corners

  [[nodiscard]] bool sameCorners(const Key& other) const {
    return middle == other.middle && largest == other.largest;
  }
};

enum class Fate : std::uint8_t { kKeep, kDrop, kTwoSided };

/// One face of each set of three corners stays; where the sides cancel (as many of one orientation
/// as of the other) it is marked as two-sided.
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
        for (std::size_t i = first; i < last; ++i) {
          const bool chosen = !kept && (odd == even || keys[i].odd == (odd > even));
          fates[keys[i].face] =
              chosen ? (odd == even ? Fate::kTwoSided : Fate::kKeep) : Fate::kDrop;
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

/// Decides for each connected cluster of two-sided faces whether one side stays or none.
void settleTwoSided(
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
  std::vector<FaceId> cluster;
  for (FaceId seed = 0; seed < triangles.size(); ++seed) {
    if (fates[seed] != Fate::kTwoSided || seen[seed] != 0) continue;
    cluster.assign(1, seed);
    seen[seed] = 1;
    std::int64_t bordersIfKept = 0;
    std::int64_t bordersIfDropped = 0;
    glm::ivec3 low = positions[triangles[seed].x];
    glm::ivec3 high = low;
    for (std::size_t done = 0; done < cluster.size(); ++done) {
      const FaceId face = cluster[done];
      for (int k = 0; k < 3; ++k) {
        low = glm::min(low, positions[triangles[face][k]]);
        high = glm::max(high, positions[triangles[face][k]]);
        const std::uint32_t group = groupOf[3 * face + static_cast<std::uint32_t>(k)];
        if (visitedBy[group] == seed) continue;
        visitedBy[group] = seed;
        std::int64_t others = 0;
        for (const HalfEdgeId h : groups[group]) {
          const FaceId neighbor = h / 3;
          if (fates[neighbor] != Fate::kTwoSided) {
            ++others;
          } else if (seen[neighbor] == 0) {
            seen[neighbor] = 1;
            cluster.push_back(neighbor);
          }
        }
        bordersIfKept += static_cast<std::int64_t>(groups[group].size()) % 2;
        bordersIfDropped += others % 2;
      }
    }
    const glm::ivec3 extent = high - low;
    const bool speck = std::max({extent.x, extent.y, extent.z}) < kSpeck;
    const bool keep = bordersIfKept < bordersIfDropped || !speck;
    for (const FaceId face : cluster)
      fates[face] = keep ? Fate::kKeep : Fate::kDrop;
  }
}

}  // namespace

std::uint64_t dropDuplicates(
    std::span<const glm::ivec3> positions,
    std::vector<glm::uvec3>& triangles) {
  const std::size_t before = triangles.size();
  std::vector<Fate> fates = markCopies(static_cast<std::uint32_t>(positions.size()), triangles);
  erase(triangles, fates);
  if (std::find(fates.begin(), fates.end(), Fate::kTwoSided) != fates.end()) {
    settleTwoSided(positions, triangles, fates);
    erase(triangles, fates);
  }
  return before - triangles.size();
}

}  // namespace limn::repair
