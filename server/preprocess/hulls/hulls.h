// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/hulls/build_hull.h"

#include <cstdint>
#include <optional>
#include <string>

namespace limn {

/// Both hulls of a model, or why it has none.
struct Hulls {
  std::optional<BuiltHull> outer;  // both or none
  std::optional<BuiltHull> inner;
  std::string reason;             // set when there are none: "the mesh is open: …"
  std::uint32_t filledHoles = 0;  // that had to be closed first
  int extraBits = 0;              // their grid: the mesh's step / 2^extraBits
  double meshVolume = 0.0;        // of the closed mesh, model units cubed
};

/// Closes small holes and builds both hulls. Never fails: a model without hulls says why.
/// threads: 2 or more build the two at once; the result does not depend on it.
[[nodiscard]] Hulls
buildHulls(const TriangleMesh& mesh, const HullOptions& options, unsigned threads);

/// Volume of the hull at `faces` faces, or as near as it gets from below; model units cubed.
[[nodiscard]] double hullVolume(const ProgressiveHull& hull, std::uint32_t faces);

}  // namespace limn
