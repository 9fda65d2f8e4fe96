// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/render_options.h"
#include "client/core/cone_keeper.h"
#include "client/core/snapshot.h"
#include "client/stroke/chain/chain.h"
#include "client/stroke/chain/crease_contours.h"
#include "client/stroke/chain/open_surfaces.h"
#include "client/stroke/chain/polyline.h"
#include "client/stroke/chain/surface_lines.h"

#include "shared/core/camera.h"
#include "shared/silhouette/detector.h"
#include "shared/silhouette/field.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace limn {

/// Faces under the edges of a picture of the mesh from there; valid until the next call.
using ImageSeedFinder = std::function<std::span<const FaceId>(const MeshSnapshot&, const Camera&)>;

struct LineFinderOptions {
  DetectorMethod detector = DetectorMethod::kExact;
  SilhouetteKind silhouette = SilhouetteKind::kSmooth;
  FeatureChoice features;
  /// Model coordinates. Set: silhouettes are those that a light there sees, whatever the camera.
  std::optional<glm::dvec3> light = std::nullopt;
  DetectorOptions parameters = {};  // of the detector; seeds are the snapshot's
  ImageSeedFinder imageSeeds = {};  // of the image detector
  /// Of the cones and exact detectors, for a mesh that is being refined; null: cones are made.
  ConeKeeper* cones = nullptr;
};

/// All lines of one snapshot from one view after another. Threads: one at a time.
class LineFinder {
 public:
  LineFinder(std::shared_ptr<const MeshSnapshot> snapshot, const LineFinderOptions& options);

  struct Lines {
    PolylineSet lines;  // silhouettes first, then features
    DetectionStats stats;
    std::uint32_t loops = 0;  // closed silhouette lines
    double detectMs = 0.0;
    /// Silhouettes, and suggestive contours with finding them; other features are found and chained
    /// once a mesh.
    double chainMs = 0.0;
  };

  [[nodiscard]] Lines find(const Camera& camera);

  /// Share of brute force's silhouettes that the detector finds from here, 1 when there are none.
  [[nodiscard]] double recallFrom(const Camera& camera);

  [[nodiscard]] const MeshSnapshot& snapshot() const { return *snapshot_; }

 private:
  void
  appendFeatures(const PolylineSet& silhouettes, const SilhouetteView& view, PolylineSet& lines);
  [[nodiscard]] SilhouetteView viewOf(const Camera& camera);

  std::shared_ptr<const MeshSnapshot> snapshot_;
  std::optional<glm::dvec3> light_;
  Camera camera_;  // of the present search
  SilhouetteField field_;
  std::unique_ptr<SilhouetteDetector> detector_;
  SilhouetteChainer chainer_;
  std::optional<CreaseContours> creaseContours_;  // where creases are drawn
  PolylineSet features_;
  std::optional<OpenSurfaces> openSurfaces_;  // set once made
  std::vector<FaceId> acrossCracks_;          // Cracks::across
  std::optional<SurfaceLines> surfaceLines_;  // if any are asked for
  std::vector<std::uint8_t> isContour_;       // by half-edge; all 0 between calls
};

}  // namespace limn
