// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/task_runner.h"

#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace limn {

/// A TaskRunner of threads. The most urgent work goes first, in order of its coming; but one task
/// in kTurn is the one that has waited longest, so that none waits for ever. Where there are more
/// threads than one, one never searches. Finished work waits until the loop thread calls
/// runDone(); `wake` is called from a worker to make it do so.
class WorkerPool final : public TaskRunner {
 public:
  WorkerPool(std::size_t threads, std::function<void()> wake);
  ~WorkerPool() override;
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  void submit(TaskUrgency urgency, std::function<void()> work, std::function<void()> done) override;

  [[nodiscard]] std::size_t pending() const override { return pending_; }

  /// Waits for the work in progress and drops the rest. Nothing is woken or done afterwards.
  void stop();

  /// Runs the `done` of what has finished. Loop thread. Returns how many.
  std::size_t runDone();

 private:
  struct Task {
    std::function<void()> work;
    std::function<void()> done;
    std::uint64_t number = 0;  // in order of their coming
  };

  static constexpr std::size_t kTurn = 8;

  enum class Role : std::uint8_t {
    kBoth,       // the only thread
    kUrgent,     // never searches
    kSearching,  // takes what is urgent while the other is busy
  };

  void serve(Role role);
  // With mutex_ held.
  [[nodiscard]] bool hasUrgent() const;
  [[nodiscard]] bool hasNext(Role role) const;
  // hasNext(role):
  [[nodiscard]] std::size_t chosen(Role role);
  [[nodiscard]] Task next(Role role);

  std::function<void()> wake_;
  const bool hasUrgentThread_;
  std::size_t pending_ = 0;  // loop thread
  std::mutex mutex_;
  // For who waits: the thread that never searches, and the others.
  std::condition_variable urgentWork_;
  std::condition_variable work_;
  std::array<std::deque<Task>, kTaskUrgencies> queues_;  // guarded by mutex_
  bool urgentIsBusy_ = false;                            // guarded by mutex_
  std::size_t taken_ = 0;                                // guarded by mutex_
  std::uint64_t submitted_ = 0;                          // guarded by mutex_
  std::vector<std::function<void()>> finished_;          // guarded by mutex_
  bool stopping_ = false;                                // guarded by mutex_
  std::vector<std::thread> threads_;                     // last: they use all of the above
};

}  // namespace limn
