// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/core/vector_code.h"
#include "shared/silhouette/field.h"
#include "shared/silhouette/seed_table.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace limn {

class ConeForest;

/// How silhouettes are looked for. kBrute, kCones and kExact find all of them, and the same
/// ones; the others, those of [Mohr13], find what their seeds lead to.
enum class DetectorMethod : std::uint8_t {
  kBrute,
  kCones,
  kExact,
  kRandom,
  kCoherenceA,
  kCoherenceB,
  kImage,
  kPrecomputed,
};

/// Every method.
[[nodiscard]] std::span<const DetectorMethod> allDetectors();

/// The name commands and reports use ("brute", "coherence-a"), and back.
[[nodiscard]] std::string_view detectorName(DetectorMethod method);
[[nodiscard]] std::optional<DetectorMethod> detectorFromName(std::string_view name);

/// What one detection did.
struct DetectionStats {
  std::uint32_t facesVisited = 0;  // faces whose plane, or one of whose corners' planes, was tested
  std::uint32_t sitesTested = 0;   // plane evaluations (faces or vertices, see SilhouetteField)
  std::uint32_t clustersTested = 0;  // cone tests (kCones, kExact)
  std::uint32_t seedsTried = 0;      // by seeded methods
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

  /// view: in grid units. The result stays valid until the next call. Cost: as its stats.
  [[nodiscard]] virtual const SilhouetteResult& detect(const SilhouetteView& view) = 0;
  [[nodiscard]] virtual DetectorMethod method() const = 0;
  /// Memory held for the mesh, working memory included, the field excluded.
  [[nodiscard]] virtual std::size_t memoryBytes() const = 0;
};

/// The slot at which a mesh holds a vertex id, kNone when it does not (ActiveMesh::slotOf).
using SlotLookup = std::function<Slot(VertexId)>;

/// The faces under the edges of a picture seen from there; valid until the next call.
using SeedFaces = std::function<std::span<const FaceId>(const SilhouetteView&)>;

struct RandomSeedOptions {
  double fraction = 0.1;        // of the faces, drawn in every frame
  bool sortByDihedral = false;  // draw faces with sharp edges more often
  int searchSteps = 0;  // faces to walk from a seed, towards edge-on, before giving it up; 0: none
  std::uint64_t seed = 1;  // of the generator
};

struct CoherenceOptions {
  int rings = 1;              // A: how far around a face that lost its silhouette to look
  bool followMotion = false;  // A: look only where the camera's motion has taken the silhouette
  int reseedEvery = 30;       // frames; 0: only once
  double reseedBelow = 0.0;   // and when segments drop below this share of the last reseeding's
  DetectorMethod reseedWith = DetectorMethod::kBrute;  // or kRandom
  int longestHistory = 8;  // B: frames that a face stays a seed after its silhouette left, at most
};

struct DetectorOptions {
  /// kPrecomputed, kExact: seeds, and where the mesh holds their vertices (empty: slot = id).
  /// `seeds` must outlive the detector; `slotOf` is only called while it is being made.
  const SeedTable* seeds = nullptr;
  SlotLookup slotOf = {};
  int seedViewpoints = 5;    // kPrecomputed: how many of the nearest viewpoints give seeds
  int seedSearchSteps = 24;  // kPrecomputed: vertices to walk from a seed before giving it up
  /// kPrecomputed: go on, too, from where silhouettes were in the last frame: where one has left,
  /// look so many faces on in the direction of the camera's motion; 0: do not.
  int seedMotionRings = 1;

  RandomSeedOptions random;    // kRandom, and kCoherence… when reseeding with it
  CoherenceOptions coherence;  // kCoherenceA, kCoherenceB

  SeedFaces imageFaces = {};  // kImage
  int imageRings = 1;         // kImage: how far around a face under an image edge to look

  /// The most of the machine's vector instructions to use. The results are the same.
  VectorCode vectorCode = VectorCode::kAvx512;

  /// kCones, kExact: clusters of the field's mesh that are there already; null: they are made.
  std::shared_ptr<const ConeForest> cones = nullptr;

  /// kCones, kExact: factor on the tangent of every normal cone. 1 finds everything; below,
  /// silhouettes are lost. For negative controls in tests only.
  double coneTangentScale = 1.0;
};

/// Makes a detector for the field's mesh as it is. `field` must outlive it. kPrecomputed and kImage
/// without seeds find nothing. Threads: reentrant.
/// Cost: kBrute O(faces); kCones, kExact O(faces · log faces), some tens of ms for 70k faces.
[[nodiscard]] std::unique_ptr<SilhouetteDetector> makeDetector(
    DetectorMethod method,
    const SilhouetteField& field,
    const DetectorOptions& options = {});

/// Share of `truth` that `found` has; 1 if there is nothing to find. Of one field. O(n log n).
[[nodiscard]] double recall(const SilhouetteResult& found, const SilhouetteResult& truth);

}  // namespace limn
