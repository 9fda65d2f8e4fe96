// SPDX-License-Identifier: Apache-2.0
#include "server/session/contour_requests.h"

#include "protocol/limits.h"

namespace limn {

Result<void> ContourRequests::take(const protocol::GetContour& request) {
  if (request.id <= lastId_) {
    return fail(ErrorCode::kProtocol, "the id of a GetContour must be above the last one's");
  }
  lastId_ = request.id;
  wanted_ = request;
  return {};
}

bool ContourRequests::update(const std::shared_ptr<const Model>& model, ViewCells& cells) {
  if (!job_ && wanted_) {
    job_ = cells.contour(model, *wanted_);
    wanted_.reset();
  }
  if (!job_ || !job_->done) return false;
  failed_ = job_->message.empty() || job_->message.size() > limits::kMaxServerMessageBytes;
  return true;
}

}  // namespace limn
