// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/asset_sections.h"
#include "server/preprocess/forest/build_forest.h"
#include "server/preprocess/hull_sections.h"
#include "server/preprocess/map_sections.h"
#include "server/session/catalogue.h"
#include "server/session/model.h"
#include "server/session/task_runner.h"
#include "server/store/asset_store.h"

#include "protocol/framing.h"
#include "protocol/messages.h"

#include "shared/mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace limn {

/// An asset in memory.
class MemoryAsset final : public Asset {
 public:
  MemoryAsset(
      const Sha256Digest& id,
      std::map<std::string, std::vector<std::uint8_t>, std::less<>> parts)
      : id_(id),
        parts_(std::move(parts)) {}

  [[nodiscard]] const Sha256Digest& id() const override { return id_; }

  [[nodiscard]] const std::string& report() const override { return report_; }

  [[nodiscard]] Result<std::span<const std::uint8_t>> section(
      std::string_view name) const override {
    const auto part = parts_.find(name);
    if (part == parts_.end()) return fail(ErrorCode::kNotFound, "no such section");
    return std::span<const std::uint8_t>(part->second);
  }

  [[nodiscard]] std::vector<std::string> sectionNames() const override {
    std::vector<std::string> names;
    for (const auto& [name, bytes] : parts_)
      names.push_back(name);
    return names;
  }

 private:
  Sha256Digest id_;
  std::map<std::string, std::vector<std::uint8_t>, std::less<>> parts_;
  std::string report_ = R"({"asset_format":)" + std::to_string(protocol::kAssetFormat) + "}";
};

inline BuiltForest builtForestOf(
    const TriangleMesh& mesh,
    std::uint32_t baseFaces,
    Placement placement = Placement::kSubset) {
  ForestOptions options;
  options.baseFaces = baseFaces;
  options.placement = placement;
  options.threads = 1;
  auto built = buildForest(mesh, options);
  EXPECT_TRUE(built) << built.error().message;
  return std::move(*built);
}

/// A mesh prepared as limn-prepare does, without a disk. `mark` makes the asset's id.
inline std::shared_ptr<const Asset> memoryAssetOf(
    const TriangleMesh& mesh,
    std::uint8_t mark,
    std::uint32_t baseFaces = 60,
    const HullSections* hulls = nullptr,
    const MapSections* maps = nullptr,
    Placement placement = Placement::kSubset) {
  const BuiltForest built = builtForestOf(mesh, baseFaces, placement);
  Sha256Digest id{};
  id.fill(mark);
  AssetIdentity identity{id, true};
  if (hulls != nullptr) identity.hull = hulls->info;
  if (maps != nullptr) identity.maps = maps->info;
  const WireSections wire = encodeWireSections(built, {}, identity);
  std::map<std::string, std::vector<std::uint8_t>, std::less<>> parts{
      {sections::kInfo, wire.info},
      {sections::kBase, wire.base},
      {sections::kBlocks, wire.blocks},
      {sections::kPackets, wire.packets},
      {sections::kSeeds, wire.seeds},
      {sections::kForest, serializeForest(built.forest)}};
  if (hulls != nullptr) {
    parts[sections::kHullOuter] = hulls->outer;
    parts[sections::kHullInner] = hulls->inner;
  }
  if (maps != nullptr) parts[sections::kMapNormals] = maps->normals;
  if (maps != nullptr && !maps->colors.empty()) parts[sections::kMapColors] = maps->colors;
  return std::make_shared<MemoryAsset>(id, std::move(parts));
}

inline std::shared_ptr<const Model> modelOf(
    const TriangleMesh& mesh,
    std::uint8_t mark = 1,
    std::uint32_t baseFaces = 60,
    Placement placement = Placement::kSubset) {
  auto model = Model::load(memoryAssetOf(mesh, mark, baseFaces, nullptr, nullptr, placement));
  EXPECT_TRUE(model) << model.error().message;
  return std::move(*model);
}

/// Runs work when told to, on this thread.
class ManualTasks final : public TaskRunner {
 public:
  void submit(TaskUrgency, std::function<void()> work, std::function<void()> done) override {
    queue_.push_back({std::move(work), std::move(done)});
  }

  [[nodiscard]] std::size_t pending() const override { return queue_.size(); }

  std::size_t runAll() {
    std::size_t count = 0;
    for (; !queue_.empty(); ++count) {
      const auto task = std::move(queue_.front());
      queue_.pop_front();
      task.first();
      task.second();
    }
    return count;
  }

 private:
  std::deque<std::pair<std::function<void()>, std::function<void()>>> queue_;
};

/// A fixed set of models, ready or not.
class FixedModels final : public ModelSource {
 public:
  void add(const std::string& name, std::shared_ptr<const Model> model) {
    CatalogueItem item;
    item.name = name;
    item.state = protocol::ModelState::kReady;
    items_.push_back(item);
    models_[name] = {Availability::kReady, model, model->forest().vertexCount(), ""};
  }

  void set(const std::string& name, const Lookup& lookup) { models_[name] = lookup; }

  [[nodiscard]] const std::vector<CatalogueItem>& catalogue() const override { return items_; }

  [[nodiscard]] Lookup find(std::string_view name) override {
    const auto found = models_.find(std::string(name));
    return found == models_.end() ? Lookup{} : found->second;
  }

 private:
  std::vector<CatalogueItem> items_;
  std::map<std::string, Lookup> models_;
};

/// A pose that looks at a model from outside, from a direction.
inline protocol::Pose
poseAt(const protocol::ModelInfo& info, const glm::dvec3& direction, double distanceRadii = 3.0) {
  protocol::Pose pose;
  const glm::dvec3 unit = glm::normalize(direction);
  pose.eye = info.center + distanceRadii * info.radius * unit;
  pose.forward = -unit;
  pose.up = std::abs(unit.y) > 0.9 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
  pose.width = 512;
  pose.height = 512;
  return pose;
}

}  // namespace limn
