// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/contour_codec.h"
#include "shared/silhouette/detector.h"
#include "shared/silhouette/field.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Grid bits that points of smooth silhouettes have beyond the model's; those of edges are
/// vertices.
inline constexpr int kSmoothContourBits = 2;

/// Links detected silhouettes into lines with the front side to their left, by walking over the
/// mesh: from an edge along the same front-facing sector to the next, from a crossed face to the
/// face behind the edge where the silhouette leaves it. Every segment becomes a segment of exactly
/// one line; lines close where the mesh has no border. Keeps its working memory, four bytes a
/// half-edge or face. Threads: one caller at a time.
class ContourLinker {
 public:
  /// field must outlive it.
  explicit ContourLinker(const SilhouetteField& field);

  /// found: all silhouettes of `view`, by a complete detector. Cost: O(segments · valence).
  [[nodiscard]] ContourLines link(const SilhouetteView& view, const SilhouetteResult& found);

  [[nodiscard]] std::size_t bytes() const { return 4 * (slots_.capacity() + next_.capacity()); }

 private:
  enum class Way : std::uint8_t { kIn, kOut };

  [[nodiscard]] std::uint32_t successorOf(std::uint32_t segment, const glm::vec4& eye) const;
  [[nodiscard]] HalfEdgeId crossedEdge(FaceId face, const glm::vec4& eye, Way way) const;
  [[nodiscard]] glm::ivec3 crossing(HalfEdgeId edge, const glm::vec4& eye) const;
  void appendLine(std::uint32_t first, const glm::vec4& eye, ContourLines& lines);

  const SilhouetteField& field_;
  std::vector<std::uint32_t> slots_;  // by half-edge (kEdges) or face (kSmooth): its place in
                                      // segments_, or kNone
  std::span<const std::uint32_t> segments_;
  std::vector<std::uint32_t> next_;  // by place: the place that goes on from it, or kNone
  std::vector<std::uint8_t> isDone_;
};

}  // namespace limn
