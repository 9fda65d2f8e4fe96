// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/adaptive_bins.h"
#include "shared/core/result.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/progressive/progressive_hull.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Splits of a hull travel in pieces, each a stream of its own; their sizes follow from the hull's
/// base alone, so that both sides know which piece has which split: 64 at first, then an eighth of
/// all before. This is the number of splits before piece `piece`.
[[nodiscard]] std::size_t hullPieceBegin(std::uint32_t piece);

/// Pieces that hold the first `splits` splits.
[[nodiscard]] std::uint32_t hullPiecesFor(std::size_t splits);

/// A hull as it is sent: what Hull carries, then what each HullSplits does.
struct EncodedHull {
  std::vector<std::uint8_t> base;                 // Draco
  std::vector<std::vector<std::uint8_t>> pieces;  // splits
};

/// The same hull gives the same bytes. Errors: those of encodeDraco() and HullRefiner. Threads:
/// reentrant. Cost: about 2 µs a split.
[[nodiscard]] Result<EncodedHull> encodeHull(const ProgressiveHull& hull);

/// Decodes a hull as it comes. Total over any bytes; after an error the hull is still valid, with
/// the splits that came before the damage.
class HullDecoder {
 public:
  /// grid: of the hull. Errors: kCorrupt, kLimitExceeded, kNonManifold.
  [[nodiscard]] static Result<HullDecoder>
  begin(std::span<const std::uint8_t> base, const Grid& grid, std::uint32_t maxFaces);

  /// The next piece; pieces come in order. most: splits that the hull still has.
  /// Errors: kCorrupt, kNonManifold.
  [[nodiscard]] Result<void> addPiece(std::span<const std::uint8_t> bytes, std::size_t most);

  [[nodiscard]] std::uint32_t pieces() const { return pieces_; }

  /// All that has been decoded.
  [[nodiscard]] const ProgressiveHull& hull() const { return hull_; }

 private:
  HullDecoder(ProgressiveHull hull, HullRefiner refiner);

  ProgressiveHull hull_;
  HullRefiner refiner_;
  AdaptiveContexts contexts_;
  std::uint32_t pieces_ = 0;
};

}  // namespace limn
