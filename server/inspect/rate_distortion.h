// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/inspect/byte_account.h"
#include "server/session/model.h"

#include "shared/core/result.h"

#include <cstdint>
#include <vector>

namespace limn {

/// How good a picture so many bytes buy.
struct RatePoint {
  std::uint64_t bytes = 0;  // on the wire, frame headers included
  std::uint32_t faces = 0;
  /// Root mean square distance of the full mesh's vertices to this mesh, model units; < 0: not
  /// measured.
  double surfaceRms = -1.0;
  /// Visible smooth silhouettes of this mesh against the full mesh's: the 95th percentile of the
  /// distance, both ways, the worse; mean over the views; pixels.
  double contourPx = 0.0;
};

/// Bytes against error, of one model.
struct RateDistortion {
  std::vector<RatePoint> levels;  // the stream, level by level
  std::vector<RatePoint> byPose;  // the stream as a pose asks for it, by error bound; mean of views
  std::vector<RatePoint> lods;    // the same level meshes, each as a Draco mesh of its own
  std::uint64_t dracoBytes = 0;   // the full mesh as one Draco mesh
};

struct RateDistortionOptions {
  int views = 6;           // cold views around the model, at 3 radii
  int pictureSize = 1024;  // pixels, square
};

/// Errors: kCorrupt, kInternal. Cost: views · levels · O(faces), some seconds for 200k faces.
[[nodiscard]] Result<RateDistortion> measureRateDistortion(
    const Model& model,
    const ByteAccount& account,
    const RateDistortionOptions& options = {});

}  // namespace limn
