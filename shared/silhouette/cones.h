// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/cone_forest.h"
#include "shared/silhouette/detector.h"
#include "shared/silhouette/seed_slots.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace limn {
namespace silhouette {

struct Query;

/// An open leaf and the eye as it is seen from its centre, in the units its planes are kept in.
struct OpenLeaf {
  std::uint32_t leaf = 0;
  std::int32_t eyeXy = 0;  // unit vector to the eye: x in the low half, y in the high half
  std::int32_t eyeZw = 0;  // z, and radius / distance
  std::int32_t doubt = 0;  // a plane's value must be above this, or below minus this, to be sure
};

/// Open leaves, an array a field. Refilled in every frame and never made smaller, so that nothing
/// is allocated or cleared once they have grown.
struct OpenLeaves {
  std::vector<std::uint32_t> leaf;
  std::vector<std::int32_t> eyeXy, eyeZw, doubt;
  std::size_t count = 0;

  [[nodiscard]] OpenLeaf operator[](std::size_t i) const {
    return {leaf[i], eyeXy[i], eyeZw[i], doubt[i]};
  }

  /// For so many more.
  void makeRoom(std::size_t more);

  [[nodiscard]] std::size_t memoryBytes() const { return 4 * sizeof(std::uint32_t) * leaf.size(); }
};

/// Nodes of a level, refilled likewise.
struct OpenNodes {
  std::vector<std::uint32_t> nodes;
  std::size_t count = 0;

  [[nodiscard]] std::span<const std::uint32_t> held() const {
    return std::span<const std::uint32_t>(nodes).first(count);
  }

  void makeRoom(std::size_t more);
};

}  // namespace silhouette

/// Finds every silhouette, as brute force does, but skips clusters that anchored cones prove to be
/// all front or all back [Sander00]. Exact: see README.md.
///
/// kExact starts where silhouettes were in the last frame, in the first one where prepared seeds of
/// the nearest viewpoints lie, as far as the cones allow, and then audits the other clusters that
/// may hold some: while the camera moves a little, nearly everything is found before the audit.
class ConesDetector final : public SilhouetteDetector {
 public:
  enum class Order : std::uint8_t { kTree, kLastFrameFirst };

  ConesDetector(const SilhouetteField& field, const DetectorOptions& options, Order order);

  [[nodiscard]] const SilhouetteResult& detect(const SilhouetteView& view) override;

  [[nodiscard]] DetectorMethod method() const override {
    return order_ == Order::kTree ? DetectorMethod::kCones : DetectorMethod::kExact;
  }

  [[nodiscard]] std::size_t memoryBytes() const override;

 private:
  // Of one tree, a byte a leaf: kHit where it held silhouettes. To whole nodes.
  struct Hits {
    std::vector<std::uint8_t> lastFrame;
    std::vector<std::uint8_t> thisFrame;
  };

  void searchTree(const SilhouetteView& view, std::size_t index);
  void openTree(const silhouette::Query& query);
  void placeSeeds(const DetectorOptions& options);
  void startFromSeeds(const glm::vec3& toEye);

  const SilhouetteField* field_;
  VectorCode vectorCode_;
  Order order_;
  std::shared_ptr<const ConeForest> forest_;
  silhouette::OpenNodes frontier_;  // entries of one level that may hold silhouettes
  silhouette::OpenNodes below_;
  silhouette::OpenLeaves open_;
  // kLastFrameFirst: open leaves that held no silhouettes in the last frame; open_ has the others.
  silhouette::OpenLeaves audit_;
  std::vector<Hits> hits_;  // kLastFrameFirst: by tree
  // kLastFrameFirst, for the first frame: seeds, and by vertex slot of a seed the tree and leaf.
  SeedSlots seeds_;

  struct Place {
    std::uint32_t slot = kNone;
    std::uint32_t tree = 0;
    std::uint32_t leaf = 0;
  };

  std::vector<Place> seedPlaces_;  // by slot
  int seedViewpoints_ = 0;
  SilhouetteResult result_;
};

}  // namespace limn
