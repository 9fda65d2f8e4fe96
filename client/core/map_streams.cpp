// SPDX-License-Identifier: Apache-2.0
#include "client/core/map_streams.h"

#include <utility>

namespace limn {
namespace {

bool isWhole(const std::vector<std::uint8_t>& png, const MapFile& file) {
  return png.size() == file.bytes && (!file.hash || protocol::sectionHash(png) == *file.hash);
}

}  // namespace

Result<void> MapStreams::take(const protocol::Map& message, const ModelDescription& model) {
  Stream& stream = streams_[static_cast<std::size_t>(message.kind)];
  const MapFile& file = model.mapFile(message.kind);
  if (!model.maps || file.bytes == 0 || stream.whole)
    return fail(ErrorCode::kProtocol, "a map came that the model does not have");
  if (message.piece != stream.pieces || stream.bytes.size() + message.png.size() > file.bytes)
    return fail(ErrorCode::kProtocol, "a piece of a map that does not go on where it ended");
  stream.bytes.insert(stream.bytes.end(), message.png.begin(), message.png.end());
  ++stream.pieces;
  if (stream.bytes.size() < file.bytes) return {};
  auto png = std::exchange(stream.bytes, {});
  if (!isWhole(png, file)) {
    stream.pieces = 0;
    return fail(ErrorCode::kCorrupt, "a map is not what its hash says");
  }
  stream.whole = std::make_shared<const HullMap>(HullMap{*model.maps, std::move(png)});
  return {};
}

bool MapStreams::restore(
    protocol::MapKind kind,
    std::vector<std::uint8_t> png,
    const ModelDescription& model) {
  Stream& stream = streams_[static_cast<std::size_t>(kind)];
  const MapFile& file = model.mapFile(kind);
  if (!model.maps || !file.hash || !isWhole(png, file)) return false;
  stream.bytes = {};
  stream.whole = std::make_shared<const HullMap>(HullMap{*model.maps, std::move(png)});
  return true;
}

}  // namespace limn
