// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/detector.h"

#include <array>
#include <vector>

namespace limn {
namespace silhouette {

/// Planes of a leaf, and the most edges or faces a leaf may list.
inline constexpr std::size_t kLeafSites = 32;
inline constexpr std::size_t kLeafItems = 48;

/// Edges (kEdges, two sites each) or faces (kSmooth, three corners each) that lie together, with
/// the planes they need, each once. Fixed size, so that a test has no loop bounds to wait for.
struct alignas(64) Leaf {
  /// Plane of local site i at [slotOf(i)]; unused slots repeat one of the leaf's planes.
  std::array<float, kLeafSites> x, y, z, w;
  /// Local sites of item i: corner k's at [k][i]. Unused items have one site thrice, and so are
  /// never found. An edge has its half-edge's face in [0], its twin's in [1].
  std::array<std::array<std::uint8_t, kLeafItems>, 3> sites;
  std::uint32_t itemBegin;  // its first item; see ConeTree::ids
  std::uint8_t siteCount;
  std::uint8_t itemCount;

  /// Where the plane of local site i is: the order in which packing eight-lane comparisons to bytes
  /// leaves them.
  [[nodiscard]] static std::size_t slotOf(std::size_t i) {
    const std::size_t half = i / 16;
    return i % 16 / 4 * 8 + half * 4 + i % 4;
  }
};

/// Anchored cones of eight children (leaves, or nodes of the level below), one array a field.
struct alignas(32) Node {
  std::array<float, 8> centerX, centerY, centerZ;
  std::array<float, 8> axisX, axisY, axisZ;
  std::array<float, 8> front, back, cotSquared;
  std::uint32_t children;  // bit i: child i exists
};

/// The leaves in the order of their nodes, and the levels of nodes above them: child i of node n
/// is entry 8n + i of the level below; levels[0] is above the leaves.
struct ConeTree {
  std::vector<Leaf> leaves;
  /// What item i of all leaves is called: kSmooth, face ids[i]; kEdges, half-edge ids[2i] or, where
  /// its twin's face is the front one, the twin, ids[2i + 1].
  std::vector<std::uint32_t> ids;
  std::vector<std::vector<Node>> levels;
  float extent = 0.0F;  // bound of |d|/|n| over the planes and of cone centres

  [[nodiscard]] std::size_t memoryBytes() const;
};

/// Clusters the edges or faces of a field and bounds the clusters. Cost: O(items log items).
[[nodiscard]] ConeTree buildConeTree(const SilhouetteField& field, double tangentScale);

}  // namespace silhouette

/// Finds every silhouette, as brute force does, but skips clusters that anchored cones prove to be
/// all front or all back [Sander00]. Exact: see README.md.
class ConesDetector final : public SilhouetteDetector {
 public:
  ConesDetector(const SilhouetteField& field, const DetectorOptions& options);

  [[nodiscard]] const SilhouetteResult& detect(const SilhouetteView& view) override;

  [[nodiscard]] DetectorMethod method() const override { return DetectorMethod::kCones; }

  [[nodiscard]] std::size_t memoryBytes() const override;

 private:
  const SilhouetteField* field_;
  bool useAvx2_;
  silhouette::ConeTree tree_;
  std::vector<std::uint32_t> frontier_;  // entries of one level that may hold silhouettes
  std::vector<std::uint32_t> below_;
  SilhouetteResult result_;
};

}  // namespace limn
