// SPDX-License-Identifier: Apache-2.0
#include "server/transport/worker_pool.h"

#include <sys/resource.h>

#include <algorithm>
#include <utility>

namespace limn {
namespace {

constexpr int kNice = 4;
constexpr int kSearchNice = 15;  // of threads that search: they take what nobody else wants
constexpr auto kSearch = static_cast<std::size_t>(TaskUrgency::kSearch);

}  // namespace

WorkerPool::WorkerPool(std::size_t threads, std::function<void()> wake)
    : wake_(std::move(wake)),
      hasUrgentThread_(threads > 1) {
  for (std::size_t i = 0; i < threads; ++i) {
    const Role role = threads == 1 ? Role::kBoth : i == 0 ? Role::kUrgent : Role::kSearching;
    threads_.emplace_back([this, role] { serve(role); });
  }
}

WorkerPool::~WorkerPool() {
  stop();
}

void WorkerPool::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    for (auto& queue : queues_)
      queue.clear();
  }
  urgentWork_.notify_all();
  work_.notify_all();
  for (std::thread& thread : threads_)
    thread.join();
  threads_.clear();
}

void WorkerPool::submit(
    TaskUrgency urgency,
    std::function<void()> work,
    std::function<void()> done) {
  ++pending_;
  bool isForUrgentThread = false;
  {
    const std::lock_guard lock(mutex_);
    queues_[static_cast<std::size_t>(urgency)].push_back(
        {std::move(work), std::move(done), submitted_++});
    isForUrgentThread = hasUrgentThread_ && urgency != TaskUrgency::kSearch && !urgentIsBusy_;
  }
  (isForUrgentThread ? urgentWork_ : work_).notify_one();
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

bool WorkerPool::hasUrgent() const {
  return std::any_of(queues_.begin(), queues_.begin() + kSearch, [](const auto& queue) {
    return !queue.empty();
  });
}

bool WorkerPool::hasNext(Role role) const {
  const bool hasSearch = !queues_[kSearch].empty();
  switch (role) {
    case Role::kUrgent:
      return hasUrgent();
    case Role::kSearching:
      return hasSearch || (urgentIsBusy_ && hasUrgent());
    case Role::kBoth:
      break;
  }
  return hasSearch || hasUrgent();
}

std::size_t WorkerPool::chosen(Role role) {
  if (role == Role::kSearching && !queues_[kSearch].empty()) return kSearch;
  const std::size_t end = role == Role::kUrgent ? kSearch : kTaskUrgencies;
  const bool goesByAge = ++taken_ % kTurn == 0;
  std::size_t best = end;
  for (std::size_t urgency = 0; urgency < end; ++urgency) {
    const std::deque<Task>& queue = queues_[urgency];
    if (queue.empty()) continue;
    if (best == end || (goesByAge && queue.front().number < queues_[best].front().number))
      best = urgency;
  }
  return best;
}

WorkerPool::Task WorkerPool::next(Role role) {
  std::deque<Task>& queue = queues_[chosen(role)];
  Task task = std::move(queue.front());
  queue.pop_front();
  if (role == Role::kUrgent) {
    urgentIsBusy_ = true;
  }
  // Each that begins wakes the next, as long as there is something for it.
  if (hasUrgentThread_ && hasNext(Role::kSearching)) work_.notify_one();
  return task;
}

void WorkerPool::serve(Role role) {
  // The loop comes first where both want a core: on Linux this is of the thread alone. Without the
  // right to, it stays as it is.
  static_cast<void>(setpriority(PRIO_PROCESS, 0, role == Role::kSearching ? kSearchNice : kNice));
  while (true) {
    Task task;
    {
      std::unique_lock lock(mutex_);
      std::condition_variable& condition = role == Role::kUrgent ? urgentWork_ : work_;
      condition.wait(lock, [this, role] { return stopping_ || hasNext(role); });
      if (stopping_) return;
      task = next(role);
    }
    task.work();
    task.work = nullptr;  // what it captured goes here, not on the loop thread
    {
      const std::lock_guard lock(mutex_);
      if (role == Role::kUrgent) urgentIsBusy_ = false;
      finished_.push_back(std::move(task.done));
    }
    wake_();
  }
}

}  // namespace limn
