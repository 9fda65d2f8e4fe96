// SPDX-License-Identifier: Apache-2.0
// Based on: P. V. Sander, X. Gu, S. J. Gortler, H. Hoppe, J. Snyder, "Silhouette Clipping",
// SIGGRAPH 2000, section 5 (search with anchored cones).
// Deviations: level by level instead of depth first, so that the next leaves can be fetched ahead;
// eight cones at a time; in a leaf all planes first, packed to a mask, then all edges (or faces) by
// table look-ups in that mask; planes in 16 bits, decided exactly where that does not suffice.
#include "shared/silhouette/cones.h"

#include "shared/core/vector_code.h"
#include "shared/silhouette/cones_search.h"
#include "shared/view/anchored_pyramid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

namespace limn {
namespace silhouette {
namespace {

// The eye as seen from child i of a node.
glm::vec3 toEye(const Query& query, const Node& node, std::size_t i) {
  return glm::vec3(query.eye) -
         glm::vec3(node.centerX[i], node.centerY[i], node.centerZ[i]) * query.eye.w;
}

std::uint32_t openOf(const Query& query, const Node& node) {
  const glm::vec4& eye = query.eye;
  std::uint32_t open = 0;
  for (std::uint32_t i = 0; i < 8; ++i) {
    const glm::vec3 q = toEye(query, node, i);
    const auto along = [&](const std::array<std::array<std::int16_t, 8>, 3>& v) {
      return q.x * static_cast<float>(v[0][i]) + q.y * static_cast<float>(v[1][i]) +
             q.z * static_cast<float>(v[2][i]);
    };
    const float across = std::abs(along(node.side1)) + std::abs(along(node.side2)) + query.slack;
    const float middle = along(node.axis);
    const bool isFront = middle + node.front[i] * eye.w > across;
    const bool isBack = middle + node.back[i] * eye.w < -across;
    open |= static_cast<std::uint32_t>(!(isFront || isBack)) << i;
  }
  return open;
}

std::int32_t pair(float low, float high) {
  const auto l = static_cast<std::uint32_t>(std::lrint(low)) & 0xFFFFU;
  const auto h = static_cast<std::uint32_t>(std::lrint(high)) << 16;
  return static_cast<std::int32_t>(l | h);
}

OpenLeaf openLeaf(const Query& query, const Node& node, std::uint32_t n, std::uint32_t i) {
  const glm::vec3 q = toEye(query, node, i);
  const float inverse = 1.0F / std::sqrt(std::max(glm::dot(q, q), 1e-30F));
  const float nearness = Node::radiusFrom(node.radius[i]) * query.eye.w * inverse;
  const float rounding = query.slack * kRoundingShare * inverse;
  const glm::vec3 u = q * (inverse * kPlaneScale);
  OpenLeaf open;
  open.leaf = 8 * n + i;
  open.eyeXy = pair(u.x, u.y);
  open.eyeZw = pair(u.z, std::min(nearness, kNearest) * kPlaneScale);
  const bool isSure = nearness <= kNearest && rounding < kMostRounding;
  open.doubt = isSure ? static_cast<std::int32_t>(kPlaneError + rounding) : kNothingSure;
  return open;
}

// Eight bytes of 0 or 1 as bits.
std::uint32_t bitsOf(std::uint64_t bytes) {
  return static_cast<std::uint32_t>(bytes * 0x0102040810204080ULL >> 56);
}

// Loops that compilers vectorise with whatever the machine has.
template <class Leaf>
LeafHits testLeaf(const Query& query, const OpenLeaf& open, const Leaf& leaf) {
  const std::int32_t ex = static_cast<std::int16_t>(open.eyeXy & 0xFFFF);
  const std::int32_t ey = open.eyeXy >> 16;
  const std::int32_t ez = static_cast<std::int16_t>(open.eyeZw & 0xFFFF);
  const std::int32_t ew = open.eyeZw >> 16;
  std::array<std::int32_t, kLeafSites> values;
  for (std::size_t s = 0; s < kLeafSites; ++s) {
    values[s] = (leaf.xy[2 * s] * ex + leaf.xy[2 * s + 1] * ey) +
                (leaf.zd[2 * s] * ez + leaf.zd[2 * s + 1] * ew);
  }
  std::array<std::uint8_t, kLeafSites> isFront;
  std::array<std::uint8_t, kLeafSites> isDoubtful;
  for (std::size_t s = 0; s < kLeafSites; ++s) {
    isFront[s] = values[s] > open.doubt ? 1 : 0;
    isDoubtful[s] = values[s] <= open.doubt && values[s] >= -open.doubt ? 1 : 0;
  }
  // By site instead of by slot: in fours.
  std::array<std::uint8_t, kLeafSites> sides;
  std::uint32_t front = 0;
  std::uint32_t doubtful = 0;
  for (std::size_t i = 0; i < kLeafSites; i += 8) {
    std::array<std::uint8_t, 8> frontBytes;
    std::array<std::uint8_t, 8> doubtfulBytes;
    for (std::size_t k = 0; k < 8; k += 4) {
      std::memcpy(&frontBytes[k], &isFront[Leaf::slotOf(i + k)], 4);
      std::memcpy(&doubtfulBytes[k], &isDoubtful[Leaf::slotOf(i + k)], 4);
    }
    std::memcpy(&sides[i], frontBytes.data(), 8);
    front |= bitsOf(std::bit_cast<std::uint64_t>(frontBytes)) << i;
    doubtful |= bitsOf(std::bit_cast<std::uint64_t>(doubtfulBytes)) << i;
  }
  if (doubtful != 0) [[unlikely]] {
    front = settleDoubts(query, open, leaf, front, doubtful);
    for (std::size_t i = 0; i < kLeafSites; ++i)
      sides[i] = static_cast<std::uint8_t>(front >> i & 1U);
  }
  LeafHits found{};
  if (front == 0 || front == 0xFFFFFFFFU) return found;
  for (std::size_t i = 0; i < leaf.itemCount; i += 8) {
    // The last eight may be past the items, never past the row.
    std::array<std::uint8_t, 8> first{};
    std::array<std::uint8_t, 8> differs{};
    const std::size_t count = std::min<std::size_t>(8, Leaf::kMaxItems - i);
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint8_t a = sides[leaf.sites[0][i + k] & 31U];
      std::uint8_t other = a ^ sides[leaf.sites[1][i + k] & 31U];
      if constexpr (Leaf::kSitesPerItem == 3) other |= a ^ sides[leaf.sites[2][i + k] & 31U];
      first[k] = a;
      differs[k] = other;
    }
    found.differing |= std::uint64_t{bitsOf(std::bit_cast<std::uint64_t>(differs))} << i;
    found.firstIsFront |= std::uint64_t{bitsOf(std::bit_cast<std::uint64_t>(first))} << i;
  }
  found.differing &= (std::uint64_t{1} << leaf.itemCount) - 1;
  return found;
}

std::uint32_t siteOf(const Query& query, std::uint32_t leafIndex, const EdgeLeaf&, std::size_t i) {
  return query.tree->siteFaces[kLeafSites * std::size_t{leafIndex} + i];
}

std::uint32_t siteOf(const Query& query, std::uint32_t, const FaceLeaf& leaf, std::size_t i) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto begin = leaf.sites[k].begin();
    const auto at = std::find(begin, begin + leaf.itemCount, static_cast<std::uint8_t>(i));
    if (at == begin + leaf.itemCount) continue;
    const FaceId f = query.tree->faces[leaf.itemBegin + static_cast<std::size_t>(at - begin)];
    return query.field->mesh().origins[3 * f + k];
  }
  return 0;  // no site is without an item
}

// With the eye as it is, not rounded, fewer sites are in doubt. Removes the others from `doubtful`;
// returns the front ones of those.
template <class Leaf>
std::uint32_t
lookTwice(const Query& query, const OpenLeaf& open, const Leaf& leaf, std::uint32_t& doubtful) {
  const Node& node = query.tree->levels[0][open.leaf / 8];
  const std::size_t child = open.leaf % 8;
  const glm::dvec3 q(toEye(query, node, child));
  const double factor = double{kPlaneScale} / std::sqrt(std::max(glm::dot(q, q), 1e-30));
  const glm::dvec4 eye(q * factor, Node::radiusFrom(node.radius[child]) * query.eye.w * factor);
  const double doubt = open.doubt - double{kPlaneError - kPlaneOwnError};
  std::uint32_t front = 0;
  for (std::uint32_t left = doubtful; left != 0; left &= left - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(left));
    const std::size_t s = 2 * Leaf::slotOf(i);
    const double value =
        leaf.xy[s] * eye.x + leaf.xy[s + 1] * eye.y + leaf.zd[s] * eye.z + leaf.zd[s + 1] * eye.w;
    if (std::abs(value) <= doubt) continue;
    doubtful &= ~(1U << i);
    front |= static_cast<std::uint32_t>(value > 0.0) << i;
  }
  return front;
}

}  // namespace

void OpenLeaves::makeRoom(std::size_t more) {
  if (leaf.size() >= count + more) return;
  for (auto* field : {&eyeXy, &eyeZw, &doubt})
    field->resize(2 * (count + more));
  leaf.resize(2 * (count + more));
}

void OpenNodes::makeRoom(std::size_t more) {
  if (nodes.size() < count + more) nodes.resize(2 * (count + more));
}

template <class Leaf>
std::uint32_t settleDoubts(
    const Query& query,
    const OpenLeaf& open,
    const Leaf& leaf,
    std::uint32_t front,
    std::uint32_t doubtful) {
  front &= ~doubtful;
  if (open.doubt != kNothingSure) front |= lookTwice(query, open, leaf, doubtful);
  for (std::uint32_t left = doubtful; left != 0; left &= left - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(left));
    if (i >= leaf.siteCount) break;
    const std::uint32_t site = siteOf(query, open.leaf, leaf, i);
    front |= static_cast<std::uint32_t>(query.field->isFront(site, query.fieldEye)) << i;
  }
  // Unused slots are like site 0.
  const std::uint32_t used =
      leaf.siteCount == kLeafSites ? 0xFFFFFFFFU : (1U << leaf.siteCount) - 1;
  return (front & 1U) != 0 ? front | ~used : front & used;
}

template std::uint32_t settleDoubts<EdgeLeaf>(
    const Query&,
    const OpenLeaf&,
    const EdgeLeaf&,
    std::uint32_t,
    std::uint32_t);
template std::uint32_t settleDoubts<FaceLeaf>(
    const Query&,
    const OpenLeaf&,
    const FaceLeaf&,
    std::uint32_t,
    std::uint32_t);

void openChildrenPortable(
    const Query& query,
    std::size_t level,
    std::span<const std::uint32_t> parents,
    OpenNodes& open) {
  const std::vector<Node>& nodes = query.tree->levels[level];
  const std::size_t children = query.tree->childrenOf(level);
  open.makeRoom(8 * parents.size());
  for (const std::uint32_t n : parents) {
    for (std::uint32_t mask = openOf(query, nodes[n]) & existing(children, n); mask != 0;
         mask &= mask - 1)
      open.nodes[open.count++] = 8 * n + static_cast<std::uint32_t>(std::countr_zero(mask));
  }
}

void openLeavesPortable(
    const Query& query,
    std::span<const std::uint32_t> parents,
    const LeafLists& lists) {
  const std::vector<Node>& nodes = query.tree->levels[0];
  const std::size_t children = query.tree->leafCount();
  lists.others->makeRoom(8 * parents.size());
  if (!lists.lastHits.empty()) lists.firsts->makeRoom(8 * parents.size());
  for (const std::uint32_t n : parents) {
    for (std::uint32_t mask = openOf(query, nodes[n]) & existing(children, n); mask != 0;
         mask &= mask - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(mask));
      const OpenLeaf open = openLeaf(query, nodes[n], n, i);
      const bool isFirst = !lists.lastHits.empty() && lists.lastHits[open.leaf] != 0;
      OpenLeaves& to = isFirst ? *lists.firsts : *lists.others;
      to.leaf[to.count] = open.leaf;
      to.eyeXy[to.count] = open.eyeXy;
      to.eyeZw[to.count] = open.eyeZw;
      to.doubt[to.count++] = open.doubt;
    }
  }
}

void searchLeavesPortable(
    const Query& query,
    const OpenLeaves& leaves,
    SilhouetteResult& result,
    std::span<std::uint8_t> hits) {
  if (result.kind == SilhouetteKind::kEdges) {
    searchWith<EdgeLeaf>(query, leaves, result, hits, testLeaf<EdgeLeaf>, collect<EdgeLeaf>);
  } else {
    searchWith<FaceLeaf>(query, leaves, result, hits, testLeaf<FaceLeaf>, collect<FaceLeaf>);
  }
}

}  // namespace silhouette

ConesDetector::ConesDetector(
    const SilhouetteField& field,
    const DetectorOptions& options,
    Order order)
    : field_(&field),
      vectorCode_(chooseVectorCode(options.vectorCode)),
      order_(order),
      forest_(options.cones) {
  if (forest_ == nullptr || forest_->kind() != field.kind())
    forest_ = std::make_shared<const ConeForest>(field, options.coneTangentScale);
  if (order != Order::kLastFrameFirst) return;
  for (const silhouette::ConeTree& tree : forest_->trees())
    hits_.push_back({{}, std::vector<std::uint8_t>((tree.leafCount() + 7) / 8 * 8, 0)});
  if (options.seeds != nullptr) placeSeeds(options);
}

// Finds the leaf that each seed lies in, by one of its faces.
void ConesDetector::placeSeeds(const DetectorOptions& options) {
  const HalfEdgeMesh& mesh = field_->mesh();
  seeds_ = SeedSlots(*options.seeds, options.slotOf, mesh.vertexCount());
  seedViewpoints_ = options.seedViewpoints;
  std::vector<Place> faces(mesh.faceCount());
  for (std::uint32_t v = 0; v < seeds_.viewpointCount(); ++v) {
    for (const std::uint32_t slot : seeds_.seedsOf(v)) {
      if (mesh.outgoing[slot] != kNone) faces[HalfEdgeMesh::face(mesh.outgoing[slot])].slot = slot;
    }
  }
  for (std::uint32_t t = 0; t < forest_->trees().size(); ++t) {
    const silhouette::ConeTree& tree = forest_->trees()[t];
    const auto place = [&](FaceId f, std::size_t leaf) {
      if (faces[f].slot == kNone) return;
      seedPlaces_.push_back({faces[f].slot, t, static_cast<std::uint32_t>(leaf)});
      faces[f].slot = kNone;  // the first is enough
    };
    for (std::size_t i = 0; i < tree.siteFaces.size(); ++i)
      place(tree.siteFaces[i], i / silhouette::kLeafSites);
    for (std::size_t l = 0; l < tree.faceLeaves.size(); ++l) {
      const silhouette::FaceLeaf& leaf = tree.faceLeaves[l];
      for (std::size_t i = 0; i < leaf.itemCount; ++i)
        place(tree.faces[leaf.itemBegin + i], l);
    }
  }
  std::sort(seedPlaces_.begin(), seedPlaces_.end(), [](const Place& a, const Place& b) {
    return a.slot < b.slot;
  });
}

// Lets the first frame believe that there were silhouettes where the seeds are. Once only.
void ConesDetector::startFromSeeds(const glm::vec3& toEye) {
  for (const std::uint32_t v : seeds_.nearest(toEye, seedViewpoints_)) {
    for (const std::uint32_t slot : seeds_.seedsOf(v)) {
      const auto at = std::lower_bound(
          seedPlaces_.begin(),
          seedPlaces_.end(),
          slot,
          [](const Place& place, std::uint32_t wanted) { return place.slot < wanted; });
      if (at == seedPlaces_.end() || at->slot != slot) continue;
      hits_[at->tree].thisFrame[at->leaf] = silhouette::kHit;
      ++result_.stats.seedsTried;
    }
  }
  seeds_ = {};
  seedPlaces_ = {};
}

const SilhouetteResult& ConesDetector::detect(const SilhouetteView& view) {
  result_.kind = field_->kind();
  result_.edges.clear();
  result_.faces.clear();
  result_.stats = {};
  if (!seedPlaces_.empty()) startFromSeeds(glm::vec3(field_->eyeOf(view)));
  for (std::size_t t = 0; t < forest_->trees().size(); ++t)
    searchTree(view, t);
  result_.stats.segments = static_cast<std::uint32_t>(result_.edges.size() + result_.faces.size());
  return result_;
}

void ConesDetector::searchTree(const SilhouetteView& view, std::size_t index) {
  const silhouette::ConeTree& tree = forest_->trees()[index];
  silhouette::Query query{field_, &tree, {}, field_->eyeOf(view), 0.0F};
  query.eye = query.fieldEye;
  // The field may have got another centre since.
  const glm::dvec3 shift(field_->center() - tree.origin);
  if (!view.orthographic)
    query.eye = glm::vec4(glm::vec3(view.eye - glm::dvec3(tree.origin)), 1.0F);
  const float reach =
      std::max(glm::length(glm::vec3(query.eye)), glm::length(glm::vec3(query.fieldEye))) +
      (tree.extent + static_cast<float>(glm::length(shift))) * query.eye.w;
  query.slack = PyramidSlack::kDistance * static_cast<float>(AnchoredPyramid::kScale) * reach;
  auto openLeaves = silhouette::openLeavesPortable;
  auto searchLeaves = silhouette::searchLeavesPortable;
#if LIMN_HAS_AVX2
  if (vectorCode_ != VectorCode::kPortable) openLeaves = silhouette::openLeavesAvx2;
  if (vectorCode_ == VectorCode::kAvx2) searchLeaves = silhouette::searchLeavesAvx2;
  if (vectorCode_ == VectorCode::kAvx512) searchLeaves = silhouette::searchLeavesAvx512;
#endif
  openTree(query);
  const std::span<const std::uint32_t> parents = frontier_.held();
  std::span<const std::uint8_t> last;
  std::span<std::uint8_t> hits;
  if (order_ == Order::kLastFrameFirst) {
    Hits& of = hits_[index];
    std::swap(of.lastFrame, of.thisFrame);
    of.thisFrame.assign(of.lastFrame.size(), 0);
    last = of.lastFrame;
    hits = of.thisFrame;
  }
  // In pieces, so that the list of open leaves stays in a near cache. What the audit has to look at
  // waits till the end.
  constexpr std::size_t kNodes = 128;
  audit_.count = 0;
  for (std::size_t begin = 0; begin < parents.size(); begin += kNodes) {
    const auto piece = parents.subspan(begin, std::min(kNodes, parents.size() - begin));
    open_.count = 0;
    if (last.empty()) {
      openLeaves(query, piece, {{}, nullptr, &open_});
    } else {
      openLeaves(query, piece, {last, &open_, &audit_});
    }
    searchLeaves(query, open_, result_, hits);
  }
  searchLeaves(query, audit_, result_, hits);
}

// Every node over leaves that may hold silhouettes.
void ConesDetector::openTree(const silhouette::Query& query) {
  const std::vector<std::vector<silhouette::Node>>& levels = query.tree->levels;
  auto openChildren = silhouette::openChildrenPortable;
#if LIMN_HAS_AVX2
  if (vectorCode_ != VectorCode::kPortable) openChildren = silhouette::openChildrenAvx2;
#endif
  frontier_.count = 0;
  if (levels.empty()) return;
  frontier_.makeRoom(levels.back().size());
  for (std::uint32_t n = 0; n < levels.back().size(); ++n)
    frontier_.nodes[frontier_.count++] = n;
  for (std::size_t l = levels.size() - 1; l > 0; --l) {
    result_.stats.clustersTested += static_cast<std::uint32_t>(8 * frontier_.count);
    below_.count = 0;
    openChildren(query, l, frontier_.held(), below_);
    std::swap(frontier_, below_);
  }
  result_.stats.clustersTested += static_cast<std::uint32_t>(8 * frontier_.count);
}

std::size_t ConesDetector::memoryBytes() const {
  std::size_t bytes = forest_->memoryBytes();
  for (const Hits& hits : hits_)
    bytes += hits.lastFrame.size() + hits.thisFrame.size();
  return bytes + open_.memoryBytes() + audit_.memoryBytes() +
         (frontier_.nodes.size() + below_.nodes.size() + result_.edges.capacity() +
          result_.faces.capacity()) *
             sizeof(std::uint32_t);
}

}  // namespace limn
