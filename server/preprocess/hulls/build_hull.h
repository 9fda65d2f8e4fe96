// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/progressive/progressive_hull.h"

#include <cstdint>

namespace limn {

enum class HullSide : std::uint8_t { kOuter, kInner };

struct HullOptions {
  std::uint32_t baseFaces = 200;         // collapse down to as many
  std::uint32_t finestFaces = 1U << 15;  // finer levels are left out of the result
  int extraBits = 2;                     // hull grid: the mesh's step / 2^extraBits
};

struct BuiltHull {
  ProgressiveHull hull;
  /// Faces of the coarsest level at which no collapse has yet been allowed to let faces cross or
  /// turn over, which happens only to get down to baseFaces: the base's own as a rule.
  std::uint32_t cleanFaces = 0;
};

/// Builds a progressive hull of a closed mesh [Sander00]: edge collapses, the least volume first,
/// each with its vertex where HullPlacement says. Every level encloses every finer one and the mesh
/// (outer), or is enclosed by them (inner), exactly. Deterministic; the result does not depend on
/// units. Errors: kNonManifold (not closed), kLimitExceeded (the grid is too fine). Cost: some
/// 20 µs a face.
[[nodiscard]] Result<BuiltHull>
buildHull(const TriangleMesh& mesh, HullSide side, const HullOptions& options);

}  // namespace limn
