// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/chain_crossings.h"
#include "client/stroke/chain/polyline.h"

#include "shared/core/vector_code.h"
#include "shared/mesh/cracks.h"
#include "shared/mesh/half_edge.h"
#include "shared/silhouette/detector.h"
#include "shared/silhouette/field.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Chains detected silhouettes into polylines. Keeps its working memory from frame to frame, so one
/// chainer should live as long as its view. Threads: one caller at a time.
class SilhouetteChainer {
 public:
  /// most: of the machine's vector instructions to use; the lines are the same.
  explicit SilhouetteChainer(VectorCode most = VectorCode::kAvx512);

  /// Every segment of `found` becomes a segment of exactly one line. Lines run with the front side
  /// to their left (seen from outside), never cross one another, and close wherever the mesh has no
  /// border (given all silhouettes). kEdges: where more than two edges meet, a line goes on along
  /// the same front-facing sector. kSmooth: points lie on crossed edges, and each is shared exactly
  /// by the two segments that meet there.
  /// `found` must come from `field` and `view`. The result stays valid until the next call.
  /// Cost: O(segments · valence).
  [[nodiscard]] const PolylineSet&
  chain(const SilhouetteField& field, const SilhouetteView& view, const SilhouetteResult& found);

 private:
  void linkEdges(const SilhouetteField& field, std::span<const HalfEdgeId> edges);
  void linkFaces(const SilhouetteField& field, const glm::vec4& eye, std::span<const FaceId> faces);
  [[nodiscard]] std::uint32_t
  successorOf(const HalfEdgeMesh& mesh, std::span<const HalfEdgeId> edges, HalfEdgeId h) const;
  void linkRest();
  void begin(std::size_t count);
  void makeRoom();
  void clearTable(std::size_t names);
  void enter(std::uint64_t name, std::uint32_t segment);
  template <class Put, class PutEnd>
  void readLines(Put put, PutEnd putEnd);

  PolylineSet lines_;
  bool hadEdges_ = false;      // lines_.halfEdges has names of edges
  std::size_t openLines_ = 0;  // segments that nothing leads to
  VectorCode vectorCode_;
  std::vector<chaining::Passage> passages_;  // edges: a segment's first and last vertex
  chaining::Crossings crossings_;            // smooth
  chaining::NearJoins joins_;                // edges: next and isContinued only, of any segments
  /// Smooth: segments that go on from none near.
  std::vector<std::uint32_t> begins_;
  /// Segments by a hash of their names, linear probing; kNone: empty.
  std::vector<std::uint32_t> table_;
  int tableShift_ = 0;
};

struct FeatureChainOptions {
  /// One entry a half-edge, or empty: none. Those that are creases are chained as such.
  std::span<const Crack> cracks = {};
  /// A line breaks where it would turn by more than this (degrees).
  double cornerAngleDegrees = 60.0;
};

/// Chains the edges that are lines from every view: creases and seams (bits of `features`, one byte
/// a half-edge, EdgeFeature; empty: none) and borders (kind kBorder, the face to their left); of
/// cracks (shared/mesh/cracks.h) the sharp ones, which are creases. At a vertex each line goes on
/// along the straightest partner of its kind; lines break at corners and where an odd one is left
/// over. Each edge is used once. Depends on the mesh alone: do it once a mesh state. Cost:
/// O(half-edges).
[[nodiscard]] PolylineSet chainFeatures(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    std::span<const std::uint8_t> features,
    const FeatureChainOptions& options = {});

}  // namespace limn
