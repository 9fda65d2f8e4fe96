// SPDX-License-Identifier: Apache-2.0
#include "server/session/resumed_set.h"

#include "server/session/target_set.h"

#include "protocol/limits.h"

#include <algorithm>

namespace limn {

Result<void> ResumedSet::take(const protocol::HaveSet& piece, HaveSet& have) {
  if (!awaited_ || ended_) {
    return fail(ErrorCode::kProtocol, "a HaveSet comes once, after an Open that resumes");
  }
  if (asset_ && *asset_ != piece.asset) {
    return fail(ErrorCode::kProtocol, "the pieces of a HaveSet name different assets");
  }
  if (piece.first < next_) return fail(ErrorCode::kProtocol, "HaveSet pieces out of order");
  asset_ = piece.asset;
  start_.base = start_.base || piece.base;
  start_.seedBytes = std::max<std::size_t>(start_.seedBytes, piece.seeds);
  const std::uint64_t end = std::uint64_t{piece.first} + 8 * piece.bits.size();
  next_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(end, limits::kMaxVertices));
  have.addBits(piece.first, piece.bits);
  ended_ = piece.last;
  return {};
}

Result<ModelStart::Held> ResumedSet::finish(const Model& model, HaveSet& have) {
  awaited_ = false;
  if (*asset_ != model.id()) return fail(ErrorCode::kCorrupt, "the model has changed");
  const SplitForest& forest = model.forest();
  if (start_.base) {
    have.addRange(0, forest.baseVertexCount());
  } else if (have.count() != 0) {
    return fail(ErrorCode::kProtocol, "the HaveSet has splits but not the base mesh");
  }
  if (start_.base && !isClosed(forest, have.words())) {
    return fail(ErrorCode::kProtocol, "the HaveSet lacks prerequisites of what it has");
  }
  if (start_.seedBytes > model.seeds().size()) {
    return fail(ErrorCode::kProtocol, "the HaveSet has more seeds than there are");
  }
  return start_;
}

}  // namespace limn
