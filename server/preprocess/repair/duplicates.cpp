// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/repair/edge_groups.h"
#include "server/preprocess/repair/repair_steps.h"

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

/// Two or more faces with the same corners: one stays, in the orientation that more have; where
/// their number is even it is doubtful.
void settleCopies(std::span<const Key> copies, std::vector<Fate>& fates) {
  const auto odd = static_cast<std::size_t>(
      std::count_if(copies.begin(), copies.end(), [](const Key& k) { return k.odd; }));
  const std::size_t even = copies.size() - odd;
  const Fate fate = odd == even              ? Fate::kTwoSided
                    : copies.size() % 2 == 0 ? Fate::kRepeated
                                             : Fate::kKeep;
  bool kept = false;
  for (const Key& copy : copies) {
    const bool chosen = !kept && (odd == even || copy.odd == (odd > even));
    fates[copy.face] = chosen ? fate : Fate::kDrop;
    kept = kept || chosen;
  }
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
      if (last - first > 1) settleCopies(std::span(keys).subspan(first, last - first), fates);
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

/// Gathers clusters and decides for each whether one copy of its faces stays or none.
class DoubtfulFaces {
 public:
  DoubtfulFaces(
      std::span<const glm::ivec3> positions,
      std::span<const glm::uvec3> triangles,
      std::vector<Fate>& fates)
      : positions_(positions),
        triangles_(triangles),
        fates_(fates),
        groups_(static_cast<std::uint32_t>(positions.size()), triangles),
        groupOf_(3 * triangles.size()),
        seen_(triangles.size(), 0),
        visitedBy_(groups_.size(), kNone) {
    for (std::uint32_t g = 0; g < groups_.size(); ++g) {
      for (const HalfEdgeId h : groups_[g])
        groupOf_[h] = g;
    }
  }

  void settle() {
    for (FaceId seed = 0; seed < triangles_.size(); ++seed) {
      if (!isDoubtful(fates_[seed]) || seen_[seed] != 0) continue;
      const Cluster cluster = gather(seed);
      // Clusters share no edge: a fate settled here is not looked at again.
      const Fate fate = cluster.keepsOne() ? Fate::kKeep : Fate::kDrop;
      for (const FaceId face : cluster.faces)
        fates_[face] = fate;
    }
  }

 private:
  Cluster gather(FaceId seed) {
    Cluster cluster;
    cluster.faces.push_back(seed);
    seen_[seed] = 1;
    cluster.low = cluster.high = positions_[triangles_[seed].x];
    for (std::size_t done = 0; done < cluster.faces.size(); ++done) {
      const FaceId face = cluster.faces[done];
      const glm::uvec3& t = triangles_[face];
      cluster.twoSided = cluster.twoSided && fates_[face] == Fate::kTwoSided;
      const glm::dvec3 a(positions_[t.x]);
      const glm::dvec3 b(positions_[t.y]);
      const glm::dvec3 c(positions_[t.z]);
      cluster.area += 0.5 * glm::length(glm::cross(b - a, c - a));
      for (std::uint32_t k = 0; k < 3; ++k) {
        cluster.low = glm::min(cluster.low, positions_[t[static_cast<int>(k)]]);
        cluster.high = glm::max(cluster.high, positions_[t[static_cast<int>(k)]]);
        const std::uint32_t group = groupOf_[3 * face + k];
        if (visitedBy_[group] != seed) visit(groups_[group], cluster);
        visitedBy_[group] = seed;
      }
    }
    return cluster;
  }

  /// One edge of the cluster: counts its faces, takes in the doubtful ones.
  void visit(std::span<const HalfEdgeId> group, Cluster& cluster) {
    std::uint64_t others = 0;
    for (const HalfEdgeId h : group) {
      const FaceId neighbor = h / 3;
      if (!isDoubtful(fates_[neighbor])) {
        ++others;
      } else if (seen_[neighbor] == 0) {
        seen_[neighbor] = 1;
        cluster.faces.push_back(neighbor);
      }
    }
    const bool odd = group.size() % 2 == 1;
    cluster.attached = cluster.attached || others > 0;
    cluster.bordersIfKept += odd ? 1 : 0;
    cluster.freeEdges += odd && others == 0 ? 1 : 0;
    cluster.bordersIfDropped += others % 2;
  }

  std::span<const glm::ivec3> positions_;
  std::span<const glm::uvec3> triangles_;
  std::vector<Fate>& fates_;
  EdgeGroups groups_;
  std::vector<std::uint32_t> groupOf_;    // one a half-edge
  std::vector<std::uint8_t> seen_;        // one a face
  std::vector<std::uint32_t> visitedBy_;  // one a group: the seed of the last cluster that came by
};

}  // namespace

std::uint64_t dropDuplicates(
    std::span<const glm::ivec3> positions,
    std::vector<glm::uvec3>& triangles) {
  const std::size_t before = triangles.size();
  std::vector<Fate> fates = markCopies(static_cast<std::uint32_t>(positions.size()), triangles);
  erase(triangles, fates);
  if (std::any_of(fates.begin(), fates.end(), isDoubtful)) {
    DoubtfulFaces(positions, triangles, fates).settle();
    erase(triangles, fates);
  }
  return before - triangles.size();
}

}  // namespace limn::repair
