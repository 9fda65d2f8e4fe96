// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/chain.h"
#include "client/stroke/chain/polyline.h"

#include "shared/mesh/cracks.h"
#include "shared/silhouette/detector.h"
#include "shared/silhouette/field.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Smooth silhouettes of a mesh with sharp edges. A normal averaged over a crease belongs to
/// neither side, and its silhouette runs beside the edge that an illustrator would draw. Here every
/// vertex on a crease has a normal for each of the smooth sectors that creases divide its faces
/// into. The silhouette is then where some sector's own surface turns away, and the creases whose
/// sides do so differently; on a closed mesh both together close into loops. So they do across
/// cracks: parts of a crack whose sides face differently are silhouette as well.
/// Refers to the field, which must be kSmooth and outlive it. Threads: one caller at a time.
class CreaseContours {
 public:
  /// features: one byte a half-edge (EdgeFeature), or none; without noise, else scans take long.
  /// cracks: Cracks::parts of the mesh, or none. Cost: O(half-edges).
  CreaseContours(
      const SilhouetteField& field,
      std::span<const std::uint8_t> features,
      std::span<const CrackPart> cracks = {});

  /// Whether there is no crack, and no crease divides any vertex: chaining alone is then right.
  [[nodiscard]] bool isEmpty() const { return faces_.empty() && cracks_.empty(); }

  /// Lines as SilhouetteChainer makes them; segments on creases and cracks have their half-edge,
  /// the front side's: a crack's has no twin. found: of `field` and `view`; its faces beside
  /// creases are replaced. The result stays valid until the next call. Cost: O(found + faces beside
  /// creases).
  [[nodiscard]] const PolylineSet&
  chain(const SilhouetteView& view, const SilhouetteResult& found, SilhouetteChainer& chainer);

 private:
  /// A face with a corner on a dividing crease, and the planes of its corners: < V a vertex of the
  /// field, from there on one of planes_.
  struct SharpFace {
    FaceId face;
    std::array<std::uint32_t, 3> sites;
  };

  /// A dividing crease: its half-edge, and the sites of its origin and target on either side.
  struct Crease {
    HalfEdgeId edge;
    std::array<std::uint32_t, 2> left;
    std::array<std::uint32_t, 2> right;
  };

  /// A part of a crack, and the sites of the origins and targets of its two half-edges.
  struct CrackSites {
    CrackPart part;
    std::array<std::uint32_t, 2> here;
    std::array<std::uint32_t, 2> there;
  };

  /// A piece of silhouette, front to its left.
  struct Piece {
    glm::vec3 begin;
    glm::vec3 end;
    HalfEdgeId edge;  // kNone inside a face
    FaceId face;
    std::uint32_t line;  // of the lines chained away from creases, or kNone
  };

  void divideAtCreases(std::span<const std::uint8_t> features);
  void divide(std::uint32_t vertex, std::span<const std::uint8_t> isCrease);
  [[nodiscard]] float valueOf(std::uint32_t site) const;
  [[nodiscard]] glm::vec3
  crossing(std::uint32_t front, float frontValue, std::uint32_t back, float backValue) const;
  void findPieces();
  void findOn(const Crease& crease);
  void findOn(const CrackSites& crack);
  void linkPieces();
  void linkAcrossCracks();
  void readLines(const PolylineSet& smooth);

  const SilhouetteField& field_;
  std::vector<glm::vec4> planes_;       // of sectors
  std::vector<std::uint32_t> sectors_;  // by half-edge: site of its origin's corner
  std::vector<SharpFace> faces_;
  std::vector<std::uint8_t> isSharp_;  // by face
  std::vector<Crease> creases_;
  std::vector<CrackSites> cracks_;
  // Of the call.
  glm::vec4 eye_{0.0F};
  SilhouetteResult away_;  // what was found away from creases
  std::vector<Piece> pieces_;
  std::vector<std::uint32_t> order_;  // pieces by where they begin
  std::vector<std::uint32_t> next_;
  std::vector<std::uint8_t> isContinued_;
  std::vector<std::uint8_t> isUsed_;
  PolylineSet lines_;
};

}  // namespace limn
