// SPDX-License-Identifier: Apache-2.0
#include "client/apps/viewed_model.h"

#include "client/apps/session_options.h"

#include <utility>

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kRetryAfter = std::chrono::seconds(3);
constexpr std::uint64_t kNeverGiveUpMs = std::uint64_t{1} << 48;
// A picture of a large mesh takes longer than that anyway.
constexpr std::uint64_t kPublishEveryMs = 100;

template <class Value>
bool isReady(const std::future<Value>& future) {
  return future.valid() && future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace

ViewedModel::ViewedModel(const ViewCommandOptions& options, std::function<void()> whenReady)
    : options_(options),
      whenReady_(std::move(whenReady)) {}

ViewedModel::~ViewedModel() {
  retire();
}

void ViewedModel::open(const std::string& model) {
  retire();
  name_ = model;
  description_.reset();
  complaint_.clear();
  SourceOptions source = options_.source;
  source.model = model;
  opening_ = std::async(std::launch::async, [source, wake = whenReady_] {
    auto opened = openSource(source);
    wake();
    return opened;
  });
}

void ViewedModel::retire() {
  // A source that is still being opened is waited for there too.
  if (!session_ && !opening_.valid()) return;
  retired_.push_back(std::async(
      std::launch::async,
      [session = std::move(session_), opening = std::move(opening_)]() mutable {
        session.reset();
        if (opening.valid()) opening.wait();
      }));
}

void ViewedModel::poll() {
  std::erase_if(retired_, [](const std::future<void>& ending) { return isReady(ending); });
  if (isReady(opening_)) {
    auto source = opening_.get();
    if (!source) {
      complaint_ = source.error().message;
      retryAt_ = Clock::time_point::max();  // a file does not mend itself
      return;
    }
    ClientSession::Options session = sessionOptionsOf(*source, options_.memoryMib);
    session.session.stop.kind = StopCondition::Kind::kNever;
    session.session.giveUpAfterMs = kNeverGiveUpMs;
    session.publishEveryMs = kPublishEveryMs;
    session_ = std::make_unique<ClientSession>(source->connect, session);
  }
  if (!complaint_.empty()) {
    if (Clock::now() > retryAt_) open(name_);
    return;
  }
  if (!session_) return;
  const auto model = session_->waitForModel(0);
  if (model) {
    if (!description_) description_ = *model;
  } else if (!session_->isRunning()) {
    complaint_ = model.error().message;
    retryAt_ = Clock::now() + kRetryAfter;
  }
}

const ModelDescription* ViewedModel::description() const {
  return description_ ? &*description_ : nullptr;
}

std::shared_ptr<const MeshSnapshot> ViewedModel::snapshot() const {
  return session_ ? session_->latest() : nullptr;
}

ClientSession::Progress ViewedModel::progress() const {
  if (session_) return session_->progress();
  ClientSession::Progress progress;
  if (opening_.valid()) {
    progress.notice = options_.source.meshFile.empty()
                          ? "opening"
                          : "preparing " + options_.source.meshFile.string();
  }
  return progress;
}

void ViewedModel::setView(const ClientView& view) {
  if (session_) session_->setView(view);
}

}  // namespace limn
