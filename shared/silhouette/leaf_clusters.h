// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/field.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// Internal to shared/silhouette: how the cones detector groups edges or faces into leaves.
namespace limn::silhouette {

/// Some items of a field and the sites whose planes decide about each, both numbered from 0.
/// kEdges: an item is the smaller half-edge of an edge with two faces, its sites are those faces.
/// kSmooth: an item is a face, its sites are its vertices.
class ItemSource {
 public:
  /// items: ids, ascending. `field` must outlive it. Cost: O(sites of the field + items).
  ItemSource(const SilhouetteField& field, std::vector<std::uint32_t> items);

  /// Every item of a field.
  [[nodiscard]] static std::vector<std::uint32_t> allOf(const SilhouetteField& field);

  [[nodiscard]] std::uint32_t itemCount() const { return static_cast<std::uint32_t>(ids_.size()); }

  [[nodiscard]] std::uint32_t siteCount() const {
    return static_cast<std::uint32_t>(siteIds_.size());
  }

  [[nodiscard]] std::uint32_t idOf(std::uint32_t item) const { return ids_[item]; }

  /// The field's name of a site.
  [[nodiscard]] std::uint32_t siteIdOf(std::uint32_t site) const { return siteIds_[site]; }

  [[nodiscard]] std::uint32_t sitesPerItem() const {
    return field_->kind() == SilhouetteKind::kEdges ? 2 : 3;
  }

  /// An edge's third site repeats its first.
  [[nodiscard]] const std::array<std::uint32_t, 3>& sitesOf(std::uint32_t item) const {
    return sites_[item];
  }

  /// kEdges: which of its face's three the half-edge is, and the same of its twin; kSmooth: zeros.
  [[nodiscard]] std::array<std::uint32_t, 3> placesOf(std::uint32_t item) const {
    if (field_->kind() == SilhouetteKind::kSmooth) return {};
    return {ids_[item] % 3, field_->mesh().twins[ids_[item]] % 3, 0};
  }

  [[nodiscard]] std::span<const std::uint32_t> itemsOf(std::uint32_t site) const {
    return {items_.data() + itemBegin_[site], itemBegin_[site + 1] - itemBegin_[site]};
  }

  [[nodiscard]] const glm::vec4& plane(std::uint32_t site) const {
    return field_->plane(siteIds_[site]);
  }

  [[nodiscard]] glm::vec3 point(std::uint32_t site) const;   // about the field's centre
  [[nodiscard]] glm::vec3 normal(std::uint32_t site) const;  // unit, or zero
  /// Largest distance of a vertex of the field from its centre.
  [[nodiscard]] float extent() const;
  [[nodiscard]] float meanFaceArea() const;  // of sites or items; grid units²; > 0

 private:
  const SilhouetteField* field_;
  std::vector<std::uint32_t> ids_;      // by item
  std::vector<std::uint32_t> siteIds_;  // by site, ascending
  std::vector<std::array<std::uint32_t, 3>> sites_;
  std::vector<std::uint32_t> itemBegin_;  // by site, into items_
  std::vector<std::uint32_t> items_;
};

/// Items in groups that need few planes, each item in one group.
struct Clusters {
  struct Cluster {
    std::uint32_t begin = 0;  // items[begin … end)
    std::uint32_t end = 0;
    glm::vec3 center{0.0F};  // mean of its sites' points
    glm::vec3 normal{0.0F};  // mean of its sites' normals, not unit
  };

  std::vector<std::uint32_t> items;
  std::vector<Cluster> clusters;
};

/// Groups with at most maxSites sites and maxItems items, in an order in which eight, sixty-four …
/// neighbours lie together in position and normal. Deterministic. Cost: O(items log items).
[[nodiscard]] Clusters
clusterItems(const ItemSource& source, std::uint32_t maxSites, std::uint32_t maxItems);

}  // namespace limn::silhouette
