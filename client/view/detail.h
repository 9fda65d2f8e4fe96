// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace limn {

/// How finely a picture is drawn.
struct Detail {
  double scale = 1.0;   // pixels drawn for one shown, each way
  int supersample = 2;  // lines are drawn this many times larger and reduced

  friend bool operator==(const Detail&, const Detail&) = default;
};

/// Chooses the detail that keeps a moving picture fluent, and the best one once it rests. Learns
/// from the time that pictures take. Threads: one at a time.
class DetailGovernor {
 public:
  /// budgetMs: for one picture of a view that moves.
  explicit DetailGovernor(double budgetMs) : budgetMs_(budgetMs) {}

  /// For the next picture.
  [[nodiscard]] Detail choose(bool isMoving) const;

  /// A picture was drawn that fine, and took that long in all.
  void learn(const Detail& detail, double milliseconds);

 private:
  double budgetMs_;
  int step_ = 0;  // in the ladder, 0 the finest
};

}  // namespace limn
