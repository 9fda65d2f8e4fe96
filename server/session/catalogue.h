// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/grant.h"
#include "server/session/model.h"

#include "protocol/messages.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

/// A model as the catalogue shows it.
struct CatalogueItem {
  std::string name;
  protocol::ModelState state = protocol::ModelState::kQueued;
  double progress = 0.0;  // 0 to 1
  std::string reason;     // why it failed
  std::optional<Sha256Digest> asset;
  std::uint32_t vertices = 0;
  std::uint32_t faces = 0;
  std::uint64_t bytes = 0;  // what a complete client receives
  glm::dvec3 center{0.0};
  double radius = 0.0;
  bool hasHull = false;
};

/// One encoded Catalogue message of what a grant allows to be seen; nullptr: of everything.
[[nodiscard]] std::vector<std::uint8_t> catalogueMessageOf(
    const std::vector<CatalogueItem>& items,
    const Grant* grant = nullptr);

/// Where sessions get models from. Loop thread only.
class ModelSource {
 public:
  enum class Availability : std::uint8_t {
    kReady,     // `model` is set
    kLoading,   // ask again soon
    kNotReady,  // still being prepared
    kNotFound,
    kFailed,
  };

  struct Lookup {
    Availability availability = Availability::kNotFound;
    std::shared_ptr<const Model> model;
    std::uint32_t vertices = 0;  // known once kLoading
    std::string reason;
  };

  virtual ~ModelSource() = default;
  [[nodiscard]] virtual const std::vector<CatalogueItem>& catalogue() const = 0;
  /// Starts loading what is ready but not in memory.
  [[nodiscard]] virtual Lookup find(std::string_view name) = 0;
};

}  // namespace limn
