// SPDX-License-Identifier: Apache-2.0
#include "server/transport/worker_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

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
  pool.submit([&] { ++worked; }, [] {});
  EXPECT_EQ(worked, 1) << "nobody is there to do it";
}

}  // namespace
}  // namespace limn
