// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/catalogue.h"
#include "server/session/task_runner.h"
#include "server/store/asset_store.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

struct ModelLibraryOptions {
  /// Of models that nobody has open; those in use stay whatever they take.
  std::size_t cacheBytes = std::size_t{1} << 30;
};

/// The catalogue, and the models in memory behind it: loaded on a worker when first opened, kept
/// while used, then as long as there is room. Loop thread only.
class ModelLibrary final : public ModelSource {
 public:
  /// Called when an asset turned out to be missing or damaged while it was read.
  using OnDamaged =
      std::function<void(const std::string& name, const Sha256Digest& asset, const Error& error)>;

  /// store and tasks must outlive it.
  ModelLibrary(
      const AssetStore& store,
      TaskRunner& tasks,
      const ModelLibraryOptions& options,
      OnDamaged onDamaged);

  [[nodiscard]] const std::vector<CatalogueItem>& catalogue() const override { return items_; }

  [[nodiscard]] Lookup find(std::string_view name) override;

  /// A model that waits for, or is in, preparation. One that has an asset already keeps it, and is
  /// streamed from it meanwhile.
  void setQueued(const std::string& name);
  void setPreparing(const std::string& name, double progress);
  void setFailed(const std::string& name, const std::string& reason);
  /// Reads and verifies the asset on a worker; the item is kReady once that is done.
  void setAsset(const std::string& name, const Sha256Digest& asset);
  void remove(const std::string& name);
  [[nodiscard]] bool contains(std::string_view name) const;

  /// Whether any item is being read for the first time.
  [[nodiscard]] bool reading() const { return reading_ > 0; }

  [[nodiscard]] std::size_t loadedModels() const;
  [[nodiscard]] std::size_t loadedBytes() const;

 private:
  struct Loaded {
    std::shared_ptr<const Model> kept;  // null once evicted
    std::weak_ptr<const Model> used;
    bool loading = false;
    std::uint64_t lastUse = 0;
  };

  [[nodiscard]] CatalogueItem* item(std::string_view name);
  CatalogueItem& itemOrNew(const std::string& name);
  void load(const std::string& name, const Sha256Digest& asset);
  void damaged(const std::string& name, const Sha256Digest& asset, const Error& error);
  void evict();

  const AssetStore& store_;
  TaskRunner& tasks_;
  ModelLibraryOptions options_;
  OnDamaged onDamaged_;
  std::vector<CatalogueItem> items_;  // sorted by name
  std::map<Sha256Digest, Loaded> loaded_;
  std::uint64_t uses_ = 0;
  std::size_t reading_ = 0;
};

}  // namespace limn
