// SPDX-License-Identifier: Apache-2.0
#include "server/session/hull_stream.h"

#include "shared/codec/hull_codec.h"

#include <algorithm>

namespace limn {

Result<void> HullStream::request(const protocol::GetHull& request, const Model& model) {
  const auto& messages = model.hull(request.side);
  const auto& info = model.info().hull;
  if (messages.empty() || !info) {
    return fail(
        ErrorCode::kNotFound,
        "no hull" +
            (info && !info->reason.empty() ? ", because " + std::string(info->reason) : ""));
  }
  if (request.held > messages.size()) {
    return fail(ErrorCode::kProtocol, "a GetHull holds more than the hull has");
  }
  const std::uint32_t base =
      request.side == protocol::HullSide::kOuter ? info->outerBase : info->innerBase;
  const std::size_t splits = request.faces > base ? (request.faces - base) / 2 : 0;
  Side& side = sides_[static_cast<std::size_t>(request.side)];
  side.next = request.held;
  side.end = std::min<std::size_t>(messages.size(), 1 + hullPiecesFor(splits));
  return {};
}

protocol::Bytes HullStream::next(const Model& model) const {
  const std::size_t side = pendingSide();
  return model.hull(static_cast<protocol::HullSide>(side))[sides_[side].next];
}

void HullStream::advance() {
  ++sides_[pendingSide()].next;
}

}  // namespace limn
