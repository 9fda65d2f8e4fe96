// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/model.h"

#include "protocol/messages.h"

#include "shared/core/result.h"

#include <array>
#include <cstdint>

namespace limn {

/// What a client has asked for of a model's hulls, and how much of it is sent. Both sides, the
/// outer one first. Its whole state is two numbers a side, which a GetHull says anew.
class HullStream {
 public:
  /// Errors: kNotFound (the model has no hull), kProtocol (more held than there is).
  [[nodiscard]] Result<void> request(const protocol::GetHull& request, const Model& model);

  [[nodiscard]] bool isPending() const {
    return sides_[0].next < sides_[0].end || sides_[1].next < sides_[1].end;
  }

  /// The message to send next; needs isPending(). Goes on with advance().
  [[nodiscard]] protocol::Bytes next(const Model& model) const;
  void advance();

 private:
  struct Side {
    std::size_t next = 0;  // of Model::hull()
    std::size_t end = 0;
  };

  [[nodiscard]] std::size_t pendingSide() const { return sides_[0].next < sides_[0].end ? 0 : 1; }

  std::array<Side, 2> sides_;
};

}  // namespace limn
