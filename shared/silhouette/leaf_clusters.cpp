// SPDX-License-Identifier: Apache-2.0
// Based on: greedy cluster growth, as meshlet builders do it (meshoptimizer's meshopt_buildMeshlets
// is the best known): a cluster takes the neighbour that completes most items, the nearest first.
// Deviations: what is counted are planes, not vertices; the order of clusters comes from median
// splits in position and normal together.
#include "shared/silhouette/leaf_clusters.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace limn::silhouette {

ItemSource::ItemSource(const SilhouetteField& field, std::vector<std::uint32_t> items)
    : field_(&field),
      ids_(std::move(items)) {
  const HalfEdgeMesh& mesh = field.mesh();
  sites_.reserve(ids_.size());
  for (const std::uint32_t id : ids_) {
    if (field.kind() == SilhouetteKind::kEdges) {
      const FaceId f = HalfEdgeMesh::face(id);
      sites_.push_back({f, HalfEdgeMesh::face(mesh.twins[id]), f});
    } else {
      sites_.push_back({mesh.origins[3 * id], mesh.origins[3 * id + 1], mesh.origins[3 * id + 2]});
    }
  }
  // From the field's names of sites to numbers.
  std::vector<std::uint32_t> numbers(field.siteCount(), kNone);
  for (const auto& sites : sites_) {
    for (const std::uint32_t site : sites)
      numbers[site] = 0;
  }
  for (std::uint32_t site = 0; site < numbers.size(); ++site) {
    if (numbers[site] == kNone) continue;
    numbers[site] = siteCount();
    siteIds_.push_back(site);
  }
  itemBegin_.assign(siteCount() + 1, 0);
  for (auto& sites : sites_) {
    for (std::uint32_t& site : sites)
      site = numbers[site];
    for (std::uint32_t k = 0; k < sitesPerItem(); ++k)
      ++itemBegin_[sites[k] + 1];
  }
  for (std::uint32_t s = 0; s < siteCount(); ++s)
    itemBegin_[s + 1] += itemBegin_[s];
  items_.resize(itemBegin_.back());
  std::vector<std::uint32_t> next(itemBegin_.begin(), itemBegin_.end() - 1);
  for (std::uint32_t item = 0; item < itemCount(); ++item) {
    for (std::uint32_t k = 0; k < sitesPerItem(); ++k)
      items_[next[sites_[item][k]]++] = item;
  }
}

std::vector<std::uint32_t> ItemSource::allOf(const SilhouetteField& field) {
  const HalfEdgeMesh& mesh = field.mesh();
  std::vector<std::uint32_t> items;
  if (field.kind() == SilhouetteKind::kSmooth) {
    items.resize(mesh.faceCount());
    std::iota(items.begin(), items.end(), 0U);
    return items;
  }
  items.reserve(mesh.origins.size() / 2);
  for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
    if (mesh.twins[h] != kNone && h < mesh.twins[h]) items.push_back(h);
  }
  return items;
}

glm::vec3 ItemSource::point(std::uint32_t site) const {
  const auto at = [&](std::uint32_t v) {
    return glm::vec3(field_->positions()[v] - field_->center());
  };
  if (field_->kind() == SilhouetteKind::kSmooth) return at(siteIds_[site]);
  const glm::uvec3& t = field_->mesh().triangles()[siteIds_[site]];
  return (at(t.x) + at(t.y) + at(t.z)) / 3.0F;
}

glm::vec3 ItemSource::normal(std::uint32_t site) const {
  const glm::vec3 n(plane(site));
  const float length = glm::length(n);
  return length > 0.0F ? n / length : n;
}

float ItemSource::meanFaceArea() const {
  const auto positions = field_->positions();
  const auto triangles = field_->mesh().triangles();
  const std::vector<std::uint32_t>& faces =
      field_->kind() == SilhouetteKind::kEdges ? siteIds_ : ids_;
  double twice = 0.0;
  for (const FaceId f : faces) {
    const glm::uvec3& t = triangles[f];
    const glm::dvec3 u(positions[t.y] - positions[t.x]);
    const glm::dvec3 v(positions[t.z] - positions[t.x]);
    twice += glm::length(glm::cross(u, v));
  }
  const double mean = 0.5 * twice / std::max<double>(static_cast<double>(faces.size()), 1.0);
  return static_cast<float>(std::max(mean, 1e-3));
}

float ItemSource::extent() const {
  float square = 0.0F;
  for (const glm::ivec3& position : field_->positions()) {
    const glm::vec3 p(position - field_->center());
    square = std::max(square, glm::dot(p, p));
  }
  return std::sqrt(square);
}

namespace {

// Area of a typical leaf in faces: distances are measured in its radius, about.
constexpr float kLeafFaces = 10.0F;
// Weight of a turned normal (squared) against distance (squared, in leaf radii) when a cluster
// chooses its next site. Tried from 0.3 to 30: cones pass fewest leaves at the upper end.
constexpr float kTurnWeight = 30.0F;
// How far, in the same measure, and how far ahead in the queue a cluster without neighbours looks
// for more.
constexpr float kReach = 16.0F;
constexpr std::size_t kLookAhead = 128;
// How far apart, in units of the mesh's extent, two opposite normals count as being when clusters
// are put in order.
constexpr float kOrderNormalWeight = 0.5F;
// A cluster with fewer items than a full one over this is a remainder.
constexpr std::uint32_t kSmallShare = 3;

// Grows clusters one by one.
class Grower {
 public:
  Grower(const ItemSource& source, std::uint32_t maxSites, std::uint32_t maxItems)
      : source_(&source),
        maxSites_(maxSites),
        maxItems_(maxItems),
        isAssigned_(source.itemCount(), 0),
        itemStamps_(source.itemCount(), 0),
        missing_(source.itemCount(), 0),
        siteStamps_(source.siteCount(), 0),
        candidateStamps_(source.siteCount(), 0),
        candidatePlaces_(source.siteCount(), 0),
        points_(source.siteCount()),
        normals_(source.siteCount()) {
    for (std::uint32_t s = 0; s < source.siteCount(); ++s) {
      points_[s] = source.point(s);
      normals_[s] = source.normal(s);
    }
    inverseArea_ = 1.0F / (kLeafFaces * source.meanFaceArea());
  }

  Clusters grow() {
    for (std::uint32_t item = 0; item < source_->itemCount(); ++item) {
      // Next to earlier clusters first, so that no slivers are left between.
      while (!isAssigned_[item])
        growFrom(nextSeed(item));
    }
    return std::move(result_);
  }

 private:
  struct Candidate {
    std::uint32_t site;
    std::uint32_t completes;  // items
  };

  std::uint32_t nextSeed(std::uint32_t otherwise) {
    while (queueHead_ < queue_.size()) {
      for (const std::uint32_t item : source_->itemsOf(queue_[queueHead_])) {
        if (!isAssigned_[item]) return item;
      }
      ++queueHead_;
    }
    return otherwise;
  }

  void growFrom(std::uint32_t seed) {
    ++stamp_;
    candidates_.clear();
    sites_ = 0;
    pointSum_ = glm::vec3(0.0F);
    normalSum_ = glm::vec3(0.0F);
    Clusters::Cluster cluster;
    cluster.begin = static_cast<std::uint32_t>(result_.items.size());
    begin_ = cluster.begin;
    addSeed(seed);
    while (sites_ < maxSites_ && itemsHeld() < maxItems_) {
      if (!candidates_.empty()) {
        addSite(takeBest());
        continue;
      }
      const std::uint32_t near = nearbySeed();
      if (near == kNone) break;
      addSeed(near);
    }
    for (const Candidate& c : candidates_)
      queue_.push_back(c.site);
    cluster.end = static_cast<std::uint32_t>(result_.items.size());
    cluster.center = pointSum_ / static_cast<float>(sites_);
    cluster.normal = normalSum_ / static_cast<float>(sites_);
    result_.clusters.push_back(cluster);
  }

  // An unassigned item beside earlier clusters that is near this one, too, for when it has no
  // neighbours left; kNone if there is none.
  std::uint32_t nearbySeed() {
    if (sites_ + source_->sitesPerItem() > maxSites_) return kNone;
    std::uint32_t best = kNone;
    float bestCost = kReach;
    const std::size_t end = std::min(queue_.size(), queueHead_ + kLookAhead);
    for (std::size_t i = queueHead_; i < end; ++i) {
      const std::uint32_t site = queue_[i];
      const float cost = costOf(site);
      if (cost >= bestCost) continue;
      for (const std::uint32_t item : source_->itemsOf(site)) {
        if (isAssigned_[item]) continue;
        best = item;
        bestCost = cost;
        break;
      }
    }
    return best;
  }

  void addSeed(std::uint32_t item) {
    const std::array<std::uint32_t, 3> sites = source_->sitesOf(item);
    for (std::uint32_t k = 0; k < source_->sitesPerItem(); ++k) {
      if (siteStamps_[sites[k]] == stamp_) continue;
      // Nothing to choose here, though each site offers the next.
      if (candidateStamps_[sites[k]] == stamp_) take(candidatePlaces_[sites[k]]);
      addSite(sites[k]);
    }
  }

  // How badly a site fits the cluster: squared distance and turn, both about 1 at a leaf's rim.
  [[nodiscard]] float costOf(std::uint32_t site) const {
    const float share = 1.0F / static_cast<float>(sites_);
    const glm::vec3 away = points_[site] - pointSum_ * share;
    const glm::vec3 turn = normals_[site] - normalSum_ * share;
    return glm::dot(away, away) * inverseArea_ + kTurnWeight * glm::dot(turn, turn);
  }

  [[nodiscard]] std::uint32_t itemsHeld() const {
    return static_cast<std::uint32_t>(result_.items.size()) - begin_;
  }

  void addSite(std::uint32_t site) {
    siteStamps_[site] = stamp_;
    ++sites_;
    pointSum_ += points_[site];
    normalSum_ += normals_[site];
    for (const std::uint32_t item : source_->itemsOf(site)) {
      if (isAssigned_[item]) continue;
      if (itemStamps_[item] != stamp_) {
        itemStamps_[item] = stamp_;
        missing_[item] = static_cast<std::uint8_t>(source_->sitesPerItem());
      }
      --missing_[item];
      if (missing_[item] == 1) offer(missingSite(item));
      if (missing_[item] == 0 && itemsHeld() < maxItems_) {
        isAssigned_[item] = 1;
        result_.items.push_back(item);
      }
    }
  }

  [[nodiscard]] std::uint32_t missingSite(std::uint32_t item) const {
    const std::array<std::uint32_t, 3> sites = source_->sitesOf(item);
    for (const std::uint32_t s : sites) {
      if (siteStamps_[s] != stamp_) return s;
    }
    return sites[0];
  }

  void offer(std::uint32_t site) {
    if (candidateStamps_[site] == stamp_) {
      ++candidates_[candidatePlaces_[site]].completes;
      return;
    }
    candidateStamps_[site] = stamp_;
    candidatePlaces_[site] = static_cast<std::uint32_t>(candidates_.size());
    candidates_.push_back({site, 1});
  }

  // Removes a candidate.
  std::uint32_t take(std::size_t place) {
    const std::uint32_t site = candidates_[place].site;
    candidates_[place] = candidates_.back();
    candidatePlaces_[candidates_[place].site] = static_cast<std::uint32_t>(place);
    candidates_.pop_back();
    return site;
  }

  std::uint32_t takeBest() {
    std::size_t best = 0;
    float bestCost = 0.0F;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const auto completes = static_cast<float>(candidates_[i].completes);
      const float cost = costOf(candidates_[i].site) / (completes * completes);
      if (i == 0 || cost < bestCost) {
        best = i;
        bestCost = cost;
      }
    }
    return take(best);
  }

  const ItemSource* source_;
  std::uint32_t maxSites_;
  std::uint32_t maxItems_;
  Clusters result_;
  std::vector<std::uint8_t> isAssigned_;
  // Stamps are the number of the cluster that last touched an entry, so nothing is ever cleared.
  std::uint32_t stamp_ = 0;
  std::vector<std::uint32_t> itemStamps_;
  std::vector<std::uint8_t> missing_;  // by item: sites not yet in the cluster
  std::vector<std::uint32_t> siteStamps_;
  std::vector<std::uint32_t> candidateStamps_;
  std::vector<std::uint32_t> candidatePlaces_;  // by site: index in candidates_
  std::vector<Candidate> candidates_;
  std::vector<std::uint32_t> queue_;  // sites beside finished clusters
  std::size_t queueHead_ = 0;
  std::vector<glm::vec3> points_;
  std::vector<glm::vec3> normals_;
  float inverseArea_ = 0.0F;
  // The cluster being grown.
  std::uint32_t begin_ = 0;
  std::uint32_t sites_ = 0;
  glm::vec3 pointSum_{0.0F};
  glm::vec3 normalSum_{0.0F};
};

// Puts clusters in an order whose aligned runs of 8, 64, 512 … are compact in position and normal.
class Orderer {
 public:
  Orderer(std::span<const Clusters::Cluster> clusters, float extent) {
    const float scale = 1.0F / std::max(extent, 1.0F);
    keys_.reserve(clusters.size());
    for (std::uint32_t i = 0; i < clusters.size(); ++i) {
      const glm::vec3 p = clusters[i].center * scale;
      const glm::vec3 n = clusters[i].normal * kOrderNormalWeight;
      keys_.push_back({{p.x, p.y, p.z, n.x, n.y, n.z}, i});
    }
  }

  std::vector<std::uint32_t> order() {
    split(0, keys_.size());
    std::vector<std::uint32_t> order;
    order.reserve(keys_.size());
    for (const Key& key : keys_)
      order.push_back(key.cluster);
    return order;
  }

 private:
  static constexpr std::size_t kDimensions = 6;

  struct Key {
    std::array<float, kDimensions> at;
    std::uint32_t cluster;
  };

  [[nodiscard]] std::size_t widestDimension(std::size_t begin, std::size_t end) const {
    std::array<float, kDimensions> low = keys_[begin].at;
    std::array<float, kDimensions> high = low;
    for (std::size_t i = begin + 1; i < end; ++i) {
      for (std::size_t d = 0; d < kDimensions; ++d) {
        low[d] = std::min(low[d], keys_[i].at[d]);
        high[d] = std::max(high[d], keys_[i].at[d]);
      }
    }
    std::size_t widest = 0;
    for (std::size_t d = 1; d < kDimensions; ++d) {
      if (high[d] - low[d] > high[widest] - low[widest]) widest = d;
    }
    return widest;
  }

  void split(std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    if (count <= 1) return;
    std::size_t unit = 1;
    while (unit * 8 < count)
      unit *= 8;
    const std::size_t middle = begin + unit * ((count / unit + 1) / 2);
    if (middle >= end) return;
    const std::size_t d = widestDimension(begin, end);
    const auto at = [&](std::size_t i) { return keys_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [d](const Key& a, const Key& b) {
      return a.at[d] != b.at[d] ? a.at[d] < b.at[d] : a.cluster < b.cluster;
    });
    split(begin, middle);
    split(middle, end);
  }

  std::vector<Key> keys_;
};

// Distinct sites of items, at most limit + 1.
class SiteCounter {
 public:
  explicit SiteCounter(const ItemSource& source)
      : source_(&source),
        stamps_(source.siteCount(), 0) {}

  void restart() {
    ++stamp_;
    count_ = 0;
  }

  void add(std::span<const std::uint32_t> items) {
    for (const std::uint32_t item : items) {
      for (const std::uint32_t site : source_->sitesOf(item)) {
        if (stamps_[site] == stamp_) continue;
        stamps_[site] = stamp_;
        ++count_;
      }
    }
  }

  [[nodiscard]] std::uint32_t count() const { return count_; }

 private:
  const ItemSource* source_;
  std::vector<std::uint32_t> stamps_;
  std::uint32_t stamp_ = 0;
  std::uint32_t count_ = 0;
};

Clusters inOrder(const Clusters& given, std::span<const std::uint32_t> order) {
  Clusters result;
  result.items.reserve(given.items.size());
  result.clusters.reserve(given.clusters.size());
  for (const std::uint32_t c : order) {
    Clusters::Cluster cluster = given.clusters[c];
    const auto first = given.items.begin() + cluster.begin;
    const auto last = given.items.begin() + cluster.end;
    cluster.begin = static_cast<std::uint32_t>(result.items.size());
    result.items.insert(result.items.end(), first, last);
    cluster.end = static_cast<std::uint32_t>(result.items.size());
    result.clusters.push_back(cluster);
  }
  return result;
}

// Growth leaves remainders between large clusters. Side by side, those that are near each other can
// be joined.
Clusters smallOnesLast(const Clusters& given, std::uint32_t smallItems) {
  std::vector<std::uint32_t> order(given.clusters.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_partition(order.begin(), order.end(), [&](std::uint32_t c) {
    return given.clusters[c].end - given.clusters[c].begin > smallItems;
  });
  return inOrder(given, order);
}

// Joins neighbours in the order where both fit into one: growth leaves small remainders.
void joinNeighbours(
    const ItemSource& source,
    std::uint32_t maxSites,
    std::uint32_t maxItems,
    Clusters& clusters) {
  SiteCounter counter(source);
  std::vector<Clusters::Cluster> joined;
  const auto itemsOf = [&](const Clusters::Cluster& c) {
    return std::span<const std::uint32_t>(clusters.items).subspan(c.begin, c.end - c.begin);
  };
  for (const Clusters::Cluster& c : clusters.clusters) {
    if (!joined.empty() && c.end - joined.back().begin <= maxItems) {
      Clusters::Cluster& last = joined.back();
      counter.restart();
      counter.add(itemsOf(last));
      counter.add(itemsOf(c));
      if (counter.count() <= maxSites) {
        const auto lastCount = static_cast<float>(last.end - last.begin);
        const float share = lastCount / (lastCount + static_cast<float>(c.end - c.begin));
        last.center = glm::mix(c.center, last.center, share);
        last.normal = glm::mix(c.normal, last.normal, share);
        last.end = c.end;
        continue;
      }
    }
    joined.push_back(c);
  }
  clusters.clusters = std::move(joined);
}

}  // namespace

Clusters clusterItems(const ItemSource& source, std::uint32_t maxSites, std::uint32_t maxItems) {
  const float extent = source.extent();
  const auto ordered = [&](const Clusters& given) {
    return inOrder(given, Orderer(given.clusters, extent).order());
  };
  Clusters clusters = ordered(Grower(source, maxSites, maxItems).grow());
  clusters = smallOnesLast(clusters, maxItems / kSmallShare);
  joinNeighbours(source, maxSites, maxItems, clusters);
  return ordered(clusters);
}

}  // namespace limn::silhouette
