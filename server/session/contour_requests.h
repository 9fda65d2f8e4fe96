// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/view_cells.h"

#include "protocol/messages.h"

#include "shared/core/result.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

namespace limn {

/// The exact contours that a channel's client asks for: the newest request counts, one is worked on
/// at a time. Loop thread only.
class ContourRequests {
 public:
  /// Errors: kProtocol (an id that does not grow).
  [[nodiscard]] Result<void> take(const protocol::GetContour& request);

  /// Begins work on the newest request once the last answer is on its way. True when an answer is
  /// there.
  bool update(const std::shared_ptr<const Model>& model, ViewCells& cells);

  [[nodiscard]] bool areOpen() const { return job_ || wanted_ || failed_; }

  /// The answer, if it is there.
  [[nodiscard]] bool isAnswered() const { return job_ && job_->done; }

  /// An answer cannot be sent: it is too large for a message, or the mesh cannot be had.
  [[nodiscard]] bool hasFailed() const { return failed_; }

  /// Of the answer that is there.
  [[nodiscard]] std::size_t answerBytes() const { return job_->message.size(); }

  [[nodiscard]] ViewCells::ContourTicket takeAnswer() { return std::exchange(job_, nullptr); }

 private:
  std::optional<protocol::GetContour> wanted_;  // the newest that is not being worked on
  std::uint32_t lastId_ = 0;
  ViewCells::ContourTicket job_;  // being worked on, or to be sent
  bool failed_ = false;
};

}  // namespace limn
