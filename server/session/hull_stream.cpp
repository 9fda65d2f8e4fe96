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
  Part& part = parts_[static_cast<std::size_t>(request.side)];
  part.next = request.held;
  part.end = std::min<std::size_t>(messages.size(), 1 + hullPiecesFor(splits));
  return {};
}

Result<void> HullStream::request(const protocol::GetMap& request, const Model& model) {
  const auto& messages = model.map(request.kind);
  if (messages.empty()) return fail(ErrorCode::kNotFound, "the model has no such map");
  if (request.held > messages.size()) {
    return fail(ErrorCode::kProtocol, "a GetMap holds more than the map has");
  }
  parts_[kFirstMap + static_cast<std::size_t>(request.kind)] = {request.held, messages.size()};
  return {};
}

std::size_t HullStream::pending() const {
  const auto isPart = [](const Part& part) { return part.next < part.end; };
  return static_cast<std::size_t>(std::ranges::find_if(parts_, isPart) - parts_.begin());
}

protocol::Bytes HullStream::next(const Model& model) const {
  const std::size_t part = pending();
  const auto& messages = part >= kFirstMap
                             ? model.map(static_cast<protocol::MapKind>(part - kFirstMap))
                             : model.hull(static_cast<protocol::HullSide>(part));
  return messages[parts_[part].next];
}

void HullStream::advance() {
  ++parts_[pending()].next;
}

}  // namespace limn
