// SPDX-License-Identifier: Apache-2.0
#include "server/session/model_library.h"

#include "protocol/framing.h"
#include "protocol/limits.h"

#include <algorithm>
#include <utility>

namespace limn {
namespace {

/// What the catalogue says of an asset: read from its sections, without loading the model.
Result<CatalogueItem> describe(const Asset& asset) {
  const auto section = asset.section(sections::kInfo);
  if (!section) return tl::unexpected(section.error());
  protocol::FrameReader reader(*section);
  const auto frame = reader.next();
  if (!frame || !*frame) return fail(ErrorCode::kCorrupt, "the asset's info section is damaged");
  const auto message = protocol::decodeMessage(**frame, protocol::Sender::kServer);
  if (!message) return tl::unexpected(message.error());
  const auto* info = message->as<protocol::ModelInfo>();
  if (info == nullptr) return fail(ErrorCode::kCorrupt, "the asset's info section is another one");
  CatalogueItem item;
  item.state = protocol::ModelState::kReady;
  item.progress = 1.0;
  item.asset = asset.id();
  item.vertices = info->vertices;
  item.faces = info->faces;
  item.center = info->center;
  item.radius = info->radius;
  item.hasHull = info->hull && info->hull->reason.empty();
  for (const char* name :
       {sections::kInfo,
        sections::kBase,
        sections::kBlocks,
        sections::kPackets,
        sections::kSeeds}) {
    if (const auto part = asset.section(name)) item.bytes += part->size();
  }
  return item;
}

}  // namespace

ModelLibrary::ModelLibrary(
    const AssetStore& store,
    TaskRunner& tasks,
    const ModelLibraryOptions& options,
    OnDamaged onDamaged)
    : store_(store),
      tasks_(tasks),
      options_(options),
      onDamaged_(std::move(onDamaged)) {}

CatalogueItem* ModelLibrary::item(std::string_view name) {
  const auto found = std::ranges::lower_bound(items_, name, {}, &CatalogueItem::name);
  return found != items_.end() && found->name == name ? &*found : nullptr;
}

bool ModelLibrary::contains(std::string_view name) const {
  return std::ranges::binary_search(items_, name, {}, &CatalogueItem::name);
}

CatalogueItem& ModelLibrary::itemOrNew(const std::string& name) {
  if (CatalogueItem* known = item(name)) return *known;
  const auto place = std::ranges::lower_bound(items_, name, {}, &CatalogueItem::name);
  CatalogueItem fresh;
  fresh.name = name;
  return *items_.insert(place, std::move(fresh));
}

void ModelLibrary::setQueued(const std::string& name) {
  CatalogueItem& it = itemOrNew(name);
  it.state = protocol::ModelState::kQueued;
  it.progress = 0.0;
  it.reason.clear();
}

void ModelLibrary::setPreparing(const std::string& name, double progress) {
  CatalogueItem& it = itemOrNew(name);
  it.state = protocol::ModelState::kPreparing;
  it.progress = std::clamp(progress, 0.0, 1.0);
  it.reason.clear();
}

void ModelLibrary::setFailed(const std::string& name, const std::string& reason) {
  CatalogueItem& it = itemOrNew(name);
  it.state = protocol::ModelState::kFailed;
  it.reason = reason.substr(0, limits::kMaxTextBytes);
  it.asset.reset();
}

void ModelLibrary::remove(const std::string& name) {
  std::erase_if(items_, [&](const CatalogueItem& it) { return it.name == name; });
  evict();
}

void ModelLibrary::damaged(const std::string& name, const Sha256Digest& asset, const Error& error) {
  loaded_.erase(asset);
  setFailed(name, error.message);
  if (onDamaged_) onDamaged_(name, asset, error);
}

void ModelLibrary::setAsset(const std::string& name, const Sha256Digest& asset) {
  itemOrNew(name);
  ++reading_;
  const auto result = std::make_shared<Result<CatalogueItem>>(CatalogueItem{});
  tasks_.submit(
      TaskUrgency::kView,
      [this, asset, result] {
        const auto opened = store_.open(asset);
        if (opened) {
          *result = describe(**opened);
        } else {
          *result = tl::unexpected(opened.error());
        }
      },
      [this, name, asset, result] {
        --reading_;
        CatalogueItem* known = item(name);
        if (known == nullptr) return;  // removed meanwhile
        if (!*result) return damaged(name, asset, result->error());
        (*result)->name = name;
        *known = **result;
      });
}

ModelSource::Lookup ModelLibrary::find(std::string_view name) {
  const CatalogueItem* known = item(name);
  Lookup lookup;
  if (known == nullptr) return lookup;
  lookup.reason = known->reason;
  if (!known->asset) {
    lookup.availability = known->state == protocol::ModelState::kFailed ? Availability::kFailed
                                                                        : Availability::kNotReady;
    return lookup;
  }
  Loaded& loaded = loaded_[*known->asset];
  loaded.lastUse = ++uses_;
  lookup.vertices = known->vertices;
  if (auto model = loaded.used.lock()) {
    loaded.kept = model;
    lookup.availability = Availability::kReady;
    lookup.model = std::move(model);
    return lookup;
  }
  if (!loaded.loading) {
    loaded.loading = true;
    load(known->name, *known->asset);
  }
  lookup.availability = Availability::kLoading;
  return lookup;
}

void ModelLibrary::load(const std::string& name, const Sha256Digest& asset) {
  using LoadResult = Result<std::shared_ptr<const Model>>;
  const auto result = std::make_shared<LoadResult>(std::shared_ptr<const Model>());
  tasks_.submit(
      TaskUrgency::kView,
      [this, asset, result] {
        auto opened = store_.open(asset);
        if (opened) {
          *result = Model::load(std::move(*opened));
        } else {
          *result = tl::unexpected(opened.error());
        }
      },
      [this, name, asset, result] {
        Loaded& loaded = loaded_[asset];
        loaded.loading = false;
        if (!*result) return damaged(name, asset, result->error());
        loaded.kept = **result;
        loaded.used = **result;
        evict();
      });
}

std::size_t ModelLibrary::loadedModels() const {
  return static_cast<std::size_t>(std::ranges::count_if(loaded_, [](const auto& entry) {
    return !entry.second.used.expired();
  }));
}

std::size_t ModelLibrary::loadedBytes() const {
  std::size_t sum = 0;
  for (const auto& [asset, loaded] : loaded_) {
    if (const auto model = loaded.used.lock()) sum += model->bytes();
  }
  return sum;
}

void ModelLibrary::evict() {
  while (loadedBytes() > options_.cacheBytes) {
    Loaded* oldest = nullptr;
    for (auto& [asset, loaded] : loaded_) {
      // use_count 1: only the library holds it.
      if (loaded.kept.use_count() == 1 && (oldest == nullptr || loaded.lastUse < oldest->lastUse)) {
        oldest = &loaded;
      }
    }
    if (oldest == nullptr) break;
    oldest->kept.reset();
  }
  std::erase_if(loaded_, [this](const auto& entry) {
    const bool named = std::ranges::any_of(items_, [&](const CatalogueItem& it) {
      return it.asset == entry.first;
    });
    return !entry.second.loading && (entry.second.used.expired() || !named);
  });
}

}  // namespace limn
