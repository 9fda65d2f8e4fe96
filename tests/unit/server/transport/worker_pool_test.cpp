// SPDX-License-Identifier: Apache-2.0
#include "server/transport/worker_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace limn {
namespace {

TEST(WorkerPool, RunsWorkElsewhereAndWhatFollowsHere) {
  std::mutex mutex;
  std::condition_variable condition;
  int woken = 0;
  WorkerPool pool(2, [&] {
    const std::lock_guard lock(mutex);
    ++woken;
    condition.notify_all();
  });
  constexpr int kTasks = 50;
  std::atomic<int> worked = 0;
  int done = 0;  // this thread only
  const auto self = std::this_thread::get_id();
  for (int i = 0; i < kTasks; ++i) {
    pool.submit(
        TaskUrgency::kView,
        [&] {
          EXPECT_NE(std::this_thread::get_id(), self);
          ++worked;
        },
        [&] {
          EXPECT_EQ(std::this_thread::get_id(), self);
          ++done;
        });
  }
  EXPECT_EQ(pool.pending(), static_cast<std::size_t>(kTasks));
  {
    std::unique_lock lock(mutex);
    condition.wait(lock, [&] { return woken == kTasks; });
  }
  EXPECT_EQ(pool.runDone(), static_cast<std::size_t>(kTasks));
  EXPECT_EQ(worked, kTasks);
  EXPECT_EQ(done, kTasks);
  EXPECT_EQ(pool.pending(), 0U);
}

TEST(WorkerPool, StoppingWaitsForWorkInProgressAndDropsTheRest) {
  std::atomic<int> worked = 0;
  std::atomic<bool> begun = false;
  std::atomic<bool> stopping = false;
  WorkerPool pool(1, [] {});
  pool.submit(
      TaskUrgency::kView,
      [&] {
        begun = true;
        while (!stopping)
          std::this_thread::yield();
        ++worked;
      },
      [] {});
  while (!begun)
    std::this_thread::yield();
  std::thread stopper([&] { stopping = true; });
  pool.stop();
  stopper.join();
  EXPECT_EQ(worked, 1) << "finished before stop() returned";
  pool.submit(
      TaskUrgency::kView,
      [&] { ++worked; },
      [] {});
  EXPECT_EQ(worked, 1) << "nobody is there to do it";
}

/// A pool whose only worker is kept busy, so that what is submitted meanwhile waits.
class BusyPool {
 public:
  explicit BusyPool(std::size_t threads) : pool_(threads, [] {}) {
    pool_.submit(
        TaskUrgency::kMotion,
        [this] { hold(); },
        [] {});
    while (!begun_)
      std::this_thread::yield();
  }

  ~BusyPool() {
    released_ = true;
    pool_.stop();
  }

  WorkerPool& pool() { return pool_; }

  /// What a task does: notes its number.
  std::function<void()> note(int number) {
    return [this, number] {
      const std::lock_guard lock(mutex_);
      order_.push_back(number);
    };
  }

  /// Lets the worker go; what was noted, once there is so much of it.
  std::vector<int> release(std::size_t count) {
    released_ = true;
    while (true) {
      const std::lock_guard lock(mutex_);
      if (order_.size() == count) return order_;
    }
  }

 private:
  void hold() {
    begun_ = true;
    while (!released_)
      std::this_thread::yield();
  }

  std::atomic<bool> begun_ = false;
  std::atomic<bool> released_ = false;
  std::mutex mutex_;
  std::vector<int> order_;
  WorkerPool pool_;  // last: its threads use the rest
};

TEST(WorkerPool, EveryThreadTakesPartWhateverComesFirst) {
  constexpr int kThreads = 4;
  for (const TaskUrgency urgency : {TaskUrgency::kMotion, TaskUrgency::kSearch}) {
    // The one that never searches has a task of its own.
    const int tasks = urgency == TaskUrgency::kSearch ? kThreads - 1 : kThreads;
    std::atomic<int> running = 0;
    std::atomic<int> done = 0;
    WorkerPool pool(kThreads, [] {});
    for (int i = 0; i < tasks; ++i) {
      pool.submit(
          urgency,
          [&] {
            // None ends before all have begun.
            for (++running; running < tasks;)
              std::this_thread::yield();
            ++done;
          },
          [] {});
    }
    while (done < tasks)
      std::this_thread::yield();
  }
}

TEST(WorkerPool, WhatIsMostUrgentGoesFirst) {
  BusyPool busy(1);
  busy.pool().submit(TaskUrgency::kSearch, busy.note(5), [] {});
  busy.pool().submit(TaskUrgency::kView, busy.note(3), [] {});
  busy.pool().submit(TaskUrgency::kMotion, busy.note(1), [] {});
  busy.pool().submit(TaskUrgency::kView, busy.note(4), [] {});
  busy.pool().submit(TaskUrgency::kMotion, busy.note(2), [] {});
  EXPECT_EQ(busy.release(5), (std::vector<int>{1, 2, 3, 4, 5}));
}

TEST(WorkerPool, WhatIsLeastUrgentDoesNotWaitForEver) {
  BusyPool busy(1);
  busy.pool().submit(TaskUrgency::kSearch, busy.note(0), [] {});
  constexpr std::size_t kOthers = 50;
  for (std::size_t i = 0; i < kOthers; ++i)
    busy.pool().submit(TaskUrgency::kMotion, busy.note(1), [] {});
  const std::vector<int> order = busy.release(kOthers + 1);
  EXPECT_LT(std::ranges::find(order, 0) - order.begin(), 10);
}

TEST(WorkerPool, WhatIsNeitherMostNorLeastUrgentDoesNotWaitForEver) {
  BusyPool busy(1);
  busy.pool().submit(TaskUrgency::kView, busy.note(0), [] {});
  constexpr std::size_t kOthers = 50;
  for (std::size_t i = 0; i < kOthers; ++i) {
    busy.pool().submit(TaskUrgency::kMotion, busy.note(1), [] {});
    busy.pool().submit(TaskUrgency::kSearch, busy.note(2), [] {});
  }
  const std::vector<int> order = busy.release(2 * kOthers + 1);
  EXPECT_LT(std::ranges::find(order, 0) - order.begin(), 10);
}

TEST(WorkerPool, SearchesLeaveOneThreadToTheOthers) {
  std::atomic<int> searching = 0;
  std::atomic<bool> stop = false;
  WorkerPool pool(2, [] {});
  for (int i = 0; i < 3; ++i) {
    pool.submit(
        TaskUrgency::kSearch,
        [&] {
          EXPECT_EQ(++searching, 1);
          while (!stop)
            std::this_thread::yield();
          --searching;
        },
        [] {});
  }
  while (searching == 0)
    std::this_thread::yield();
  std::atomic<int> worked = 0;
  for (int i = 0; i < 20; ++i)
    pool.submit(
        TaskUrgency::kView,
        [&] { ++worked; },
        [] {});
  while (worked < 20)
    std::this_thread::yield();
  EXPECT_EQ(searching, 1);
  stop = true;
  pool.stop();
}

}  // namespace
}  // namespace limn
