// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"

#include "protocol/messages.h"

#include "shared/core/result.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace limn {

/// Turns the Map messages of one open model into its maps, their hashes checked. Threads: one at a
/// time.
class MapStreams {
 public:
  /// Total over any bytes. Errors: kProtocol (order, or a map that the model does not have),
  /// kCorrupt (not what its hash says; it is then asked for anew).
  [[nodiscard]] Result<void> take(const protocol::Map& message, const ModelDescription& model);

  /// A map that was kept from another time. False when it is not the model's.
  [[nodiscard]] bool
  restore(protocol::MapKind kind, std::vector<std::uint8_t> png, const ModelDescription& model);

  /// Pieces held: GetMap.held.
  [[nodiscard]] std::uint32_t held(protocol::MapKind kind) const { return of(kind).pieces; }

  /// Null until it is whole.
  [[nodiscard]] const std::shared_ptr<const HullMap>& map(protocol::MapKind kind) const {
    return of(kind).whole;
  }

 private:
  struct Stream {
    std::vector<std::uint8_t> bytes;  // until they are whole
    std::uint32_t pieces = 0;
    std::shared_ptr<const HullMap> whole;
  };

  [[nodiscard]] const Stream& of(protocol::MapKind kind) const {
    return streams_[static_cast<std::size_t>(kind)];
  }

  std::array<Stream, kMapKinds> streams_;
};

}  // namespace limn
