// SPDX-License-Identifier: Apache-2.0
#include "server/transport/worker_pool.h"

#include <sys/resource.h>

#include <utility>

namespace limn {
namespace {

constexpr int kNice = 4;

}  // namespace

WorkerPool::WorkerPool(std::size_t threads, std::function<void()> wake) : wake_(std::move(wake)) {
  for (std::size_t i = 0; i < threads; ++i)
    threads_.emplace_back([this] { serve(); });
}

WorkerPool::~WorkerPool() {
  stop();
}

void WorkerPool::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    queue_.clear();
  }
  condition_.notify_all();
  for (std::thread& thread : threads_)
    thread.join();
  threads_.clear();
}

void WorkerPool::submit(std::function<void()> work, std::function<void()> done) {
  ++pending_;
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back({std::move(work), std::move(done)});
  }
  condition_.notify_one();
}

std::size_t WorkerPool::runDone() {
  std::vector<std::function<void()>> finished;
  {
    const std::lock_guard lock(mutex_);
    finished.swap(finished_);
  }
  for (const auto& done : finished)
    done();
  pending_ -= finished.size();
  return finished.size();
}

void WorkerPool::serve() {
  // The loop comes first where both want a core: on Linux this is of the thread alone. Without the
  // right to, it stays as it is.
  static_cast<void>(setpriority(PRIO_PROCESS, 0, kNice));
  while (true) {
    Task task;
    {
      std::unique_lock lock(mutex_);
      condition_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
      if (stopping_) return;
      task = std::move(queue_.front());
      queue_.pop_front();
    }
    task.work();
    task.work = nullptr;  // what it captured goes here, not on the loop thread
    {
      const std::lock_guard lock(mutex_);
      finished_.push_back(std::move(task.done));
    }
    wake_();
  }
}

}  // namespace limn
