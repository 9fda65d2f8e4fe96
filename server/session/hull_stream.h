// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/model.h"

#include "protocol/messages.h"

#include "shared/core/result.h"

#include <array>
#include <cstdint>

namespace limn {

/// What a client has asked for of a model's hulls and of the maps over them, and how much of it is
/// sent: the outer hull, the inner one, maps. Its whole state is two numbers each, which a request
/// says anew.
class HullStream {
 public:
  /// Errors: kNotFound (the model has no hull), kProtocol (more held than there is).
  [[nodiscard]] Result<void> request(const protocol::GetHull& request, const Model& model);

  /// Errors: kNotFound (the model has no such map), kProtocol (more held than there is).
  [[nodiscard]] Result<void> request(const protocol::GetMap& request, const Model& model);

  [[nodiscard]] bool isPending() const { return pending() < parts_.size(); }

  /// The message to send next; needs isPending(). Goes on with advance().
  [[nodiscard]] protocol::Bytes next(const Model& model) const;
  void advance();

 private:
  struct Part {
    std::size_t next = 0;  // of its messages
    std::size_t end = 0;
  };

  static constexpr std::size_t kFirstMap = 2;

  /// The first part with something to send; their number: none has.
  [[nodiscard]] std::size_t pending() const;

  std::array<Part, 4> parts_;  // by HullSide, then by MapKind
};

}  // namespace limn
