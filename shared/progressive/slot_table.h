// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"

#include <cstddef>
#include <vector>

namespace limn {

/// Where a client keeps each vertex: permanent id → slot, kNone for what it does not hold. Pages
/// appear with the first vertex on them, so that memory follows what has arrived, not what a server
/// has announced. Copyable.
class SlotTable {
 public:
  [[nodiscard]] Slot operator[](VertexId v) const {
    const std::size_t page = v / kPage;
    return page < pages_.size() && !pages_[page].empty() ? pages_[page][v % kPage] : kNone;
  }

  void set(VertexId v, Slot slot) {
    const std::size_t page = v / kPage;
    if (page >= pages_.size()) pages_.resize(page + 1);
    if (pages_[page].empty()) pages_[page].assign(kPage, kNone);
    pages_[page][v % kPage] = slot;
  }

  [[nodiscard]] std::size_t bytes() const {
    std::size_t sum = pages_.capacity() * sizeof(pages_[0]);
    for (const auto& page : pages_)
      sum += page.capacity() * sizeof(Slot);
    return sum;
  }

 private:
  static constexpr std::size_t kPage = 1024;
  std::vector<std::vector<Slot>> pages_;
};

}  // namespace limn
