// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"
#include "client/stroke/chain/polyline.h"

#include "shared/core/result.h"

#include <cstdint>
#include <memory>

namespace limn {

/// What lines of the server are drawn on where the mesh is not held: a level of the inner hull. It
/// lies inside of the mesh, so that it hides nothing that the mesh shows.
class ContourStage {
 public:
  /// The snapshot with the inner hull for its mesh, on the hull's grid. Made anew only for another
  /// hull. Errors: kUnavailable (no inner hull has come).
  [[nodiscard]] Result<std::shared_ptr<const MeshSnapshot>> snapshotOf(
      const MeshSnapshot& snapshot,
      std::uint32_t faces);

 private:
  std::shared_ptr<const ProgressiveHull> hull_;
  std::uint32_t faces_ = 0;
  std::shared_ptr<const MeshSnapshot> made_;
};

/// Faces of that level: as many as hide nearly all that the mesh hides (client/render/README.md).
inline constexpr std::uint32_t kStageFaces = 2000;

/// The server's contours in units of the grid that is 2^extraBits times finer than the model's:
/// silhouettes without edges or faces (kNone), each an outline of the full mesh.
[[nodiscard]] PolylineSet linesOf(const ContourLines& contour, int extraBits);

}  // namespace limn
