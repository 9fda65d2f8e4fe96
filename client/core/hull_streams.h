// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"

#include "protocol/messages.h"

#include "shared/codec/hull_codec.h"
#include "shared/core/result.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace limn {

/// "'NAME' has no hull, because …", of a model that has none.
[[nodiscard]] std::string whyNoHull(const ModelDescription& model);

/// Turns the Hull and HullSplits messages of one open model into its hulls. Threads: one at a time.
class HullStreams {
 public:
  /// Total over any bytes. Errors: kProtocol (order, or a model without hulls), kCorrupt (also: not
  /// what its hash says), kNonManifold, kLimitExceeded.
  [[nodiscard]] Result<void> take(const protocol::Hull& message, const ModelDescription& model);
  [[nodiscard]] Result<void> take(
      const protocol::HullSplits& message,
      const ModelDescription& model);

  /// Messages held of a side: GetHull.held.
  [[nodiscard]] std::uint32_t held(protocol::HullSide side) const;

  /// Whether a side is there with `faces` faces, or as many as the model has up to there.
  [[nodiscard]] bool
  isThere(protocol::HullSide side, std::uint32_t faces, const ModelDescription& model) const;

  /// All that has come of a side; null before its base.
  [[nodiscard]] std::shared_ptr<const ProgressiveHull> hull(protocol::HullSide side) const;

 private:
  [[nodiscard]] const std::optional<HullDecoder>& of(protocol::HullSide side) const {
    return decoders_[static_cast<std::size_t>(side)];
  }

  std::array<std::optional<HullDecoder>, 2> decoders_;  // by HullSide
};

}  // namespace limn
