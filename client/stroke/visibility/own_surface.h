// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// The faces that do not hide a smooth silhouette on one of them. It is the outline of a surface
/// smoother than its mesh, whose facets stand before it here and there, a fraction of a pixel wide:
/// taken for what covers it they would cut it into dashes. Where its own surface does cover it,
/// that bends towards the eye, which is for others to tell. Threads: one caller at a time.
class OwnSurface {
 public:
  explicit OwnSurface(const HalfEdgeMesh& mesh) : mesh_(mesh) {}

  /// The face and those around it, up to kRings corners away. Valid until the next call.
  /// Cost: O(faces), nothing for the same face again.
  [[nodiscard]] std::span<const FaceId> around(FaceId face);

  /// Whether around(face) has `other`. Cost: O(valence²), less for the same face again.
  [[nodiscard]] bool has(FaceId face, FaceId other);

  static constexpr int kRings = 3;

  /// Facets that stand out farther, in pixels, do hide it.
  static constexpr double kReachPx = 0.5;

 private:
  template <class Accept>
  bool anyAround(FaceId face, Accept accept) const;

  [[nodiscard]] static std::uint64_t bitOf(std::uint32_t vertex) {
    return std::uint64_t{1} << (vertex % 64);
  }

  const HalfEdgeMesh& mesh_;
  FaceId face_ = kNone;
  std::vector<FaceId> faces_;
  FaceId centre_ = kNone;
  std::vector<std::uint32_t> near_;  // vertices around centre_
  std::uint64_t nearBits_ = 0;       // bitOf() them all
};

}  // namespace limn
