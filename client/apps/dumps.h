// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"
#include "client/stroke/chain/polyline.h"

#include "shared/core/camera.h"

#include <cstdint>
#include <span>
#include <string>

namespace limn {

/// The client's mesh as PLY (shared/mesh/ply_writer.h), vertices in slot order.
[[nodiscard]] std::string meshPly(const MeshSnapshot& snapshot);

/// A hull in the same form; qx, qy, qz on the hull's own grid.
[[nodiscard]] std::string hullPly(const TriangleMesh& hull);

struct LineDump {
  const MeshSnapshot& snapshot;
  const PolylineSet& lines;
  std::span<const std::uint8_t> visible;  // one a point, see segmentVisibility()
  const Camera& camera;
  Viewport viewport;
};

/// The lines as JSON, model units; see commands.md for its shape. Segments along mesh edges name
/// them by their vertices' indices in meshPly().
[[nodiscard]] std::string linesJson(const LineDump& dump);

}  // namespace limn
