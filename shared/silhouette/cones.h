// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/cone_forest.h"
#include "shared/silhouette/detector.h"
#include "shared/silhouette/seed_slots.h"

#include <cstdint>
#include <memory>
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
  // Of one tree: which leaves held silhouettes in the last frame.
  struct LastFrame {
    std::vector<std::uint32_t> hits;
    std::vector<std::uint8_t> wasHit;  // by leaf; all 0 between frames
  };

  void searchTree(const SilhouetteView& view, std::size_t index);
  void openTree(const silhouette::Query& query);
  void placeSeeds(const DetectorOptions& options);
  void startFromSeeds(const glm::vec3& toEye);

  const SilhouetteField* field_;
  VectorCode vectorCode_;
  Order order_;
  std::shared_ptr<const ConeForest> forest_;
  std::vector<std::uint32_t> frontier_;  // entries of one level that may hold silhouettes
  std::vector<std::uint32_t> below_;
  std::vector<silhouette::OpenLeaf> open_;
  // kLastFrameFirst: open leaves that held silhouettes in the last frame, and others. Never shrink.
  std::vector<silhouette::OpenLeaf> firsts_;
  std::vector<silhouette::OpenLeaf> others_;
  std::vector<LastFrame> lastFrames_;  // kLastFrameFirst: by tree
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
