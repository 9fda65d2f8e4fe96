// SPDX-License-Identifier: Apache-2.0
#include "server/session/catalogue.h"

namespace limn {

std::vector<std::uint8_t> catalogueMessageOf(
    const std::vector<CatalogueItem>& items,
    const Grant* grant) {
  protocol::Catalogue catalogue;
  catalogue.models.reserve(items.size());
  for (const CatalogueItem& item : items) {
    if (grant != nullptr && !grant->allows(item.name)) continue;
    protocol::CatalogueEntry entry;
    entry.name = item.name;
    entry.state = item.state;
    entry.progress = static_cast<float>(item.progress);
    entry.reason = item.reason;
    entry.asset = item.asset;
    entry.vertices = item.vertices;
    entry.faces = item.faces;
    entry.bytes = item.bytes;
    entry.center = item.center;
    entry.radius = item.radius;
    entry.hasHull = item.hasHull;
    catalogue.models.push_back(entry);
  }
  return protocol::encodeMessage(catalogue);
}

}  // namespace limn
