// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/silhouette/field.h"
#include "shared/silhouette/seed_table.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace limn {

/// How silhouettes are looked for. kBrute and kCones find all of them, and the same ones;
/// kPrecomputed finds what its seeds lead to. The other methods of [Mohr13] take the same place.
enum class DetectorMethod : std::uint8_t { kBrute, kCones, kPrecomputed };

/// The name commands and reports use ("brute", "cones", "precomputed"), and back.
[[nodiscard]] std::string_view detectorName(DetectorMethod method);
[[nodiscard]] std::optional<DetectorMethod> detectorFromName(std::string_view name);

/// What one detection did.
struct DetectionStats {
  std::uint32_t facesVisited = 0;  // faces whose plane, or one of whose corners' planes, was tested
  std::uint32_t sitesTested = 0;   // plane evaluations (faces or vertices, see SilhouetteField)
  std::uint32_t clustersTested = 0;  // cone tests (kCones)
  std::uint32_t seedsTried = 0;      // kPrecomputed
  std::uint32_t segments = 0;        // silhouette edges, or faces crossed by the smooth silhouette
};

/// Silhouettes as a set without order; which order is the detector's.
struct SilhouetteResult {
  SilhouetteKind kind = SilhouetteKind::kEdges;
  /// kEdges: each silhouette edge once, as the half-edge of its front face, so that the front lies
  /// to its left. Border edges are never silhouettes.
  std::vector<HalfEdgeId> edges;
  /// kSmooth: each face with front and back corners, once: one segment a face.
  std::vector<FaceId> faces;
  DetectionStats stats;
};

/// Finds the silhouettes of one field from any view. Built for one mesh state: when the mesh
/// changes, build a new field and a new detector. Threads: one caller at a time (it keeps its
/// working memory); different detectors may share a field.
class SilhouetteDetector {
 public:
  SilhouetteDetector() = default;
  SilhouetteDetector(const SilhouetteDetector&) = delete;
  SilhouetteDetector& operator=(const SilhouetteDetector&) = delete;
  virtual ~SilhouetteDetector() = default;

  /// The result stays valid until the next call.
  [[nodiscard]] virtual const SilhouetteResult& detect(const SilhouetteView& view) = 0;
  [[nodiscard]] virtual DetectorMethod method() const = 0;
  /// Memory held for the mesh, working memory included, the field excluded.
  [[nodiscard]] virtual std::size_t memoryBytes() const = 0;
};

/// The slot at which a mesh holds a vertex id, kNone when it does not (ActiveMesh::slotOf).
using SlotLookup = std::function<Slot(VertexId)>;

struct DetectorOptions {
  /// kPrecomputed: seeds, and where the mesh holds their vertices (empty: slot = id). `seeds` must
  /// outlive the detector; `slotOf` is only called while it is being made.
  const SeedTable* seeds = nullptr;
  SlotLookup slotOf = {};
  int seedViewpoints = 3;    // kPrecomputed: how many of the nearest viewpoints give seeds
  int seedSearchSteps = 24;  // kPrecomputed: vertices to walk from a seed before giving it up

  /// Whether to use the machine's vector instructions. The results are the same either way.
  bool vectorized = true;

  /// kCones: factor on the tangent of every normal cone. 1 finds everything; below, silhouettes
  /// are lost. For negative controls in tests only.
  double coneTangentScale = 1.0;
};

/// Makes a detector. `field` must outlive it. kPrecomputed without seeds finds nothing.
/// Cost: kBrute O(faces); kCones O(faces · log faces), some tens of ms for 70k faces.
[[nodiscard]] std::unique_ptr<SilhouetteDetector> makeDetector(
    DetectorMethod method,
    const SilhouetteField& field,
    const DetectorOptions& options = {});

/// Share of `truth` that `found` has, 1 when there is nothing to find. Both of one kind and field.
[[nodiscard]] double recall(const SilhouetteResult& found, const SilhouetteResult& truth);

}  // namespace limn
