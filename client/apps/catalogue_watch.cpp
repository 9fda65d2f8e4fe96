// SPDX-License-Identifier: Apache-2.0
#include "client/apps/catalogue_watch.h"

#include "client/net/http_get.h"

#include <chrono>
#include <utility>

namespace limn {
namespace {

constexpr auto kEvery = std::chrono::seconds(2);
constexpr std::size_t kMaxBytes = 16U << 20U;

}  // namespace

CatalogueWatch::CatalogueWatch(LwsConnectionOptions server, std::function<void()> whenNew)
    : server_(std::move(server)),
      whenNew_(std::move(whenNew)),
      thread_([this] { work(); }) {}

CatalogueWatch::~CatalogueWatch() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stop_.notify_one();
  thread_.join();
}

std::optional<std::vector<CatalogueEntry>> CatalogueWatch::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(found_, std::nullopt);
}

std::string CatalogueWatch::complaint() const {
  const std::lock_guard lock(mutex_);
  return complaint_;
}

void CatalogueWatch::work() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    lock.unlock();
    const auto answer = httpGet(server_, "/models", kMaxBytes);
    auto entries = answer ? parseCatalogue(*answer) : tl::unexpected(answer.error());
    lock.lock();
    complaint_ = entries ? "" : entries.error().message;
    if (entries) found_ = std::move(*entries);
    lock.unlock();
    whenNew_();
    lock.lock();
    stop_.wait_for(lock, kEvery, [this] { return stopping_; });
  }
}

}  // namespace limn
