// SPDX-License-Identifier: Apache-2.0
#include "client/view/detail.h"

#include <algorithm>
#include <array>

namespace limn {
namespace {

constexpr std::array<Detail, 5> kLadder =
    {Detail{1.0, 2}, Detail{1.0, 1}, Detail{0.75, 1}, Detail{0.5, 1}, Detail{0.375, 1}};

// One step up costs at most four times as much: wait until there is room for it.
constexpr double kRoomForOneUp = 0.25;

}  // namespace

Detail DetailGovernor::choose(bool isMoving) const {
  return isMoving ? kLadder[static_cast<std::size_t>(step_)] : kLadder.front();
}

void DetailGovernor::learn(const Detail& detail, double milliseconds) {
  const auto* found = std::ranges::find(kLadder, detail);
  if (found == kLadder.end()) return;
  const int step = static_cast<int>(found - kLadder.begin());
  const int last = static_cast<int>(kLadder.size()) - 1;
  if (milliseconds > budgetMs_) {
    step_ = std::max(step_, std::min(step + 1, last));
  } else if (step == step_ && milliseconds < kRoomForOneUp * budgetMs_) {
    step_ = std::max(step_ - 1, 0);
  }
}

}  // namespace limn
