// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/hull_codec.h"

#include "shared/codec/draco_codec.h"
#include "shared/codec/hull_syntax.h"

#include <algorithm>
#include <string>
#include <utility>

namespace limn {
namespace {

constexpr int kDracoSpeed = 3;
constexpr std::size_t kFirstPiece = 64;

/// Which of its two vertices a split calls the new one is free: the one that goes farther.
bool shouldSwap(const HullSplit& split, const glm::ivec3& vertex) {
  const auto distance2 = [&](const glm::ivec3& p) {
    const glm::i64vec3 d = glm::i64vec3(p) - glm::i64vec3(vertex);
    return d.x * d.x + d.y * d.y + d.z * d.z;
  };
  return distance2(split.keptPosition) > distance2(split.addedPosition);
}

}  // namespace

std::size_t hullPieceBegin(std::uint32_t piece) {
  std::size_t begin = 0;
  for (std::uint32_t i = 0; i < piece; ++i)
    begin += std::max(kFirstPiece, begin / 8);
  return begin;
}

std::uint32_t hullPiecesFor(std::size_t splits) {
  std::uint32_t pieces = 0;
  for (std::size_t begin = 0; begin < splits; ++pieces)
    begin += std::max(kFirstPiece, begin / 8);
  return pieces;
}

Result<EncodedHull> encodeHull(const ProgressiveHull& hull) {
  const auto base = encodeDraco(hull.base, kDracoSpeed);
  if (!base) return tl::unexpected(base.error());
  EncodedHull result;
  result.base = base->bytes;
  // The decoder's numbers of our vertices.
  std::vector<std::uint32_t> number(hull.base.positions.size() + hull.splits.size(), kNone);
  for (std::uint32_t i = 0; i < base->order.size(); ++i)
    number[base->order[i]] = i;
  const auto baseFaces = static_cast<std::uint32_t>(hull.base.triangles.size());
  auto decoded =
      decodeDraco(result.base, static_cast<std::uint32_t>(hull.base.positions.size()), baseFaces);
  if (!decoded) return tl::unexpected(decoded.error());
  auto mesh = HullRefiner::fromBase(*decoded);
  if (!mesh) return tl::unexpected(mesh.error());

  AdaptiveContexts contexts(hull_syntax::kContexts);
  std::vector<std::uint32_t> ring;
  for (std::uint32_t piece = 0; hullPieceBegin(piece) < hull.splits.size(); ++piece) {
    const std::size_t end = std::min(hullPieceBegin(piece + 1), hull.splits.size());
    AdaptiveBinWriter bins(contexts);
    for (std::size_t i = hullPieceBegin(piece); i < end; ++i) {
      const HullSplit& original = hull.splits[i];
      const std::uint32_t added = mesh->links().vertexCount();
      const auto originalAdded = static_cast<std::uint32_t>(hull.base.positions.size() + i);
      HullSplit split = original;
      split.vertex = number[original.vertex];
      split.left = number[original.left];
      split.right = number[original.right];
      number[originalAdded] = added;
      if (shouldSwap(split, mesh->positions()[split.vertex])) {
        std::swap(split.left, split.right);
        std::swap(split.keptPosition, split.addedPosition);
        std::swap(number[original.vertex], number[originalAdded]);
      }
      if (!hull_syntax::codeSplit(bins, *mesh, split, ring)) {
        return fail(ErrorCode::kLimitExceeded, "a vertex of the hull has too many neighbours");
      }
      if (auto applied = mesh->apply(split); !applied) return tl::unexpected(applied.error());
    }
    result.pieces.push_back(bins.finish());
  }
  return result;
}

HullDecoder::HullDecoder(ProgressiveHull hull, HullRefiner refiner)
    : hull_(std::move(hull)),
      refiner_(std::move(refiner)),
      contexts_(hull_syntax::kContexts) {}

Result<HullDecoder>
HullDecoder::begin(std::span<const std::uint8_t> base, const Grid& grid, std::uint32_t maxFaces) {
  auto mesh = decodeDraco(base, maxFaces, maxFaces);
  if (!mesh) return tl::unexpected(mesh.error());
  mesh->grid = grid;
  auto refiner = HullRefiner::fromBase(*mesh);
  if (!refiner) return tl::unexpected(refiner.error());
  return HullDecoder({std::move(*mesh), {}}, std::move(*refiner));
}

Result<void> HullDecoder::addPiece(std::span<const std::uint8_t> bytes, std::size_t most) {
  const auto damaged = [](const char* what) {
    return fail(ErrorCode::kCorrupt, std::string("hull splits are damaged: ") + what);
  };
  const std::size_t count = std::min(hullPieceBegin(pieces_ + 1) - hullPieceBegin(pieces_), most);
  if (count == 0) return damaged("more than the hull has");
  AdaptiveBinReader bins(contexts_, bytes);
  if (!bins.isValid()) return damaged("no coded bits");
  std::vector<std::uint32_t> ring;
  for (std::size_t i = 0; i < count; ++i) {
    HullSplit split;
    split.vertex = 0;
    if (!hull_syntax::codeSplit(bins, refiner_, split, ring)) return damaged("no such split");
    if (auto applied = refiner_.apply(split); !applied) return tl::unexpected(applied.error());
    hull_.splits.push_back(split);
  }
  if (!bins.isFinished()) return damaged("bytes left over or missing");
  ++pieces_;
  return {};
}

}  // namespace limn
