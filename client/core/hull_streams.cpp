// SPDX-License-Identifier: Apache-2.0
#include "client/core/hull_streams.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace limn {
namespace {

const HullDescription::Side& describe(const ModelDescription& model, protocol::HullSide side) {
  return side == protocol::HullSide::kOuter ? model.hull->outer : model.hull->inner;
}

}  // namespace

std::string whyNoHull(const ModelDescription& model) {
  return "'" + model.name + "' has no hull" +
         (model.hull ? ", because " + model.hull->reason : ": prepare it again with this release");
}

Result<void> HullStreams::take(const protocol::Hull& message, const ModelDescription& model) {
  if (!model.hasHull()) return fail(ErrorCode::kProtocol, "a hull came for a model that has none");
  const auto side = static_cast<std::size_t>(message.side);
  if (decoders_[side]) return fail(ErrorCode::kProtocol, "a second hull of the same side came");
  const auto& hash = model.hull->hashes[side];
  if (hash && protocol::sectionHash(message.draco) != *hash)
    return fail(ErrorCode::kCorrupt, "a hull is not what its hash says");
  Grid grid = model.grid;
  grid.step = std::ldexp(grid.step, -model.hull->extraBits);
  grid.bits += model.hull->extraBits;
  const std::uint32_t faces = describe(model, message.side).baseFaces;
  auto decoder = HullDecoder::begin(message.draco, grid, faces);
  if (!decoder) return tl::unexpected(decoder.error().within("hull"));
  if (decoder->hull().facesAfter(0) != faces)
    return fail(ErrorCode::kCorrupt, "a hull has other faces than the model's description says");
  decoders_[side] = std::move(*decoder);
  return {};
}

Result<void> HullStreams::take(const protocol::HullSplits& message, const ModelDescription& model) {
  auto& decoder = decoders_[static_cast<std::size_t>(message.side)];
  if (!decoder) return fail(ErrorCode::kProtocol, "splits of a hull came before it");
  if (message.piece != decoder->pieces())
    return fail(ErrorCode::kProtocol, "a piece of a hull's splits is out of order");
  const ProgressiveHull& hull = decoder->hull();
  const std::size_t most =
      (describe(model, message.side).finestFaces - hull.facesAfter(0)) / 2;  // ≥ what there is
  auto added = decoder->addPiece(message.splits, most - hull.splits.size());
  if (!added) return tl::unexpected(added.error().within("hull"));
  return {};
}

std::uint32_t HullStreams::held(protocol::HullSide side) const {
  return of(side) ? 1 + of(side)->pieces() : 0;
}

bool HullStreams::isThere(
    protocol::HullSide side,
    std::uint32_t faces,
    const ModelDescription& model) const {
  if (!of(side)) return false;
  const ProgressiveHull& hull = of(side)->hull();
  const std::uint32_t wanted = std::min(faces, describe(model, side).finestFaces);
  return hull.facesAfter(hull.splits.size()) + 2 > wanted;
}

std::shared_ptr<const ProgressiveHull> HullStreams::hull(protocol::HullSide side) const {
  return of(side) ? std::make_shared<const ProgressiveHull>(of(side)->hull()) : nullptr;
}

}  // namespace limn
