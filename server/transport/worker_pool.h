// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/task_runner.h"

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace limn {

/// A TaskRunner of threads. Finished work waits until the loop thread calls runDone(); `wake` is
/// called from a worker to make it do so.
class WorkerPool final : public TaskRunner {
 public:
  WorkerPool(std::size_t threads, std::function<void()> wake);
  ~WorkerPool() override;
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  void submit(std::function<void()> work, std::function<void()> done) override;

  [[nodiscard]] std::size_t pending() const override { return pending_; }

  /// Waits for the work in progress and drops the rest. Nothing is woken or done afterwards.
  void stop();

  /// Runs the `done` of what has finished. Loop thread. Returns how many.
  std::size_t runDone();

 private:
  struct Task {
    std::function<void()> work;
    std::function<void()> done;
  };

  void serve();

  std::function<void()> wake_;
  std::size_t pending_ = 0;  // loop thread
  std::mutex mutex_;
  std::condition_variable condition_;
  std::deque<Task> queue_;                       // guarded by mutex_
  std::vector<std::function<void()>> finished_;  // guarded by mutex_
  bool stopping_ = false;                        // guarded by mutex_
  std::vector<std::thread> threads_;             // last: they use all of the above
};

}  // namespace limn
