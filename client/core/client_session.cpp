// SPDX-License-Identifier: Apache-2.0
#include "client/core/client_session.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace limn {
namespace {

/// A server keeps far less than this in flight; one that sends more ignores the window, and would
/// fill our memory.
constexpr std::size_t kMaxQueuedBytes = 32 * 1024 * 1024;

}  // namespace

/// Hears one connection and queues what it says for the decode thread.
class ClientSession::Inbox : public ConnectionListener {
 public:
  explicit Inbox(ClientSession& session) : session_(session) {}

  void onOpen() override { push({Event::Kind::kOpen, {}, 0, {}}); }

  void onMessage(std::vector<std::uint8_t> message, std::size_t wireBytes) override {
    push({Event::Kind::kMessage, std::move(message), wireBytes, {}});
  }

  void onClosed(const Error& reason) override { push({Event::Kind::kClosed, {}, 0, reason}); }

 private:
  void push(Event event) {
    const std::lock_guard lock(session_.mutex_);
    if (flooded_) return;
    if (session_.eventBytes_ + event.message.size() > kMaxQueuedBytes) {
      flooded_ = true;
      event = {
          Event::Kind::kClosed,
          {},
          0,
          {ErrorCode::kProtocol, "the server sends more than the window allows"}};
    }
    session_.eventBytes_ += event.message.size();
    session_.events_.push_back(std::move(event));
    session_.wakeDecoder_.notify_one();
  }

  ClientSession& session_;
  bool flooded_ = false;  // guarded by session_.mutex_
};

ClientSession::ClientSession(ConnectionFactory connect, Options options)
    : connect_(std::move(connect)),
      options_(std::move(options)),
      machine_(options_.session),
      newViews_(machine_.modelCount()),
      models_(machine_.modelCount()),
      snapshots_(machine_.modelCount()),
      decoder_([this] { decodeLoop(); }) {}

ClientSession::~ClientSession() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    wakeDecoder_.notify_one();
  }
  decoder_.join();
}

template <class Condition>
bool ClientSession::waitFor(
    std::unique_lock<std::mutex>& lock,
    std::uint64_t timeoutMs,
    Condition condition) {
  return wakeCaller_.wait_for(lock, std::chrono::milliseconds(timeoutMs), condition);
}

Result<ModelDescription> ClientSession::waitForModel(std::uint64_t timeoutMs, std::size_t model) {
  std::unique_lock lock(mutex_);
  waitFor(lock, timeoutMs, [&] { return models_[model] || failure_; });
  if (models_[model]) return *models_[model];
  if (failure_) return tl::unexpected(*failure_);
  return fail(ErrorCode::kUnavailable, "the model's description has not arrived yet");
}

Result<SessionOutcome> ClientSession::waitUntilDone(std::uint64_t timeoutMs) {
  std::unique_lock lock(mutex_);
  waitFor(lock, timeoutMs, [this] { return outcome_ || failure_; });
  if (outcome_) return *outcome_;
  if (failure_) return tl::unexpected(*failure_);
  return fail(ErrorCode::kUnavailable, "the state asked for is not reached yet");
}

Result<SessionOutcome> ClientSession::waitForState(MeshState state, std::uint64_t timeoutMs) {
  std::unique_lock lock(mutex_);
  wantedState_ = state;
  stateReached_.reset();
  stateBlocked_.reset();
  checkWanted_ = true;
  wakeDecoder_.notify_one();
  waitFor(lock, timeoutMs, [this] { return stateReached_ || stateBlocked_ || failure_; });
  wantedState_.reset();
  if (stateReached_) return *stateReached_;
  if (stateBlocked_) return tl::unexpected(*stateBlocked_);
  if (failure_) return tl::unexpected(*failure_);
  return fail(ErrorCode::kUnavailable, "the state asked for is not reached yet");
}

bool ClientSession::isRunning() const {
  const std::lock_guard lock(mutex_);
  return !outcome_ && !failure_;
}

void ClientSession::setView(const ClientView& view, std::size_t model) {
  const std::lock_guard lock(mutex_);
  newViews_[model] = view;
  wakeDecoder_.notify_one();
}

bool ClientSession::hasNewView() const {
  return std::ranges::any_of(newViews_, [](const auto& view) { return view.has_value(); });
}

std::shared_ptr<const MeshSnapshot> ClientSession::latest(std::size_t model) const {
  const std::lock_guard lock(mutex_);
  return snapshots_[model];
}

ClientSession::Progress ClientSession::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

std::uint64_t ClientSession::nowMs() const {
  using namespace std::chrono;
  return static_cast<std::uint64_t>(
      duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count());
}

void ClientSession::decodeLoop() {
  machine_.start(nowMs());
  while (true) {
    serveConnection(nowMs());
    publish(nowMs());
    std::optional<Event> event;
    std::vector<std::optional<ClientView>> views(machine_.modelCount());
    {
      std::unique_lock lock(mutex_);
      const auto ready = [this] {
        return stopping_ || !events_.empty() || hasNewView() || checkWanted_;
      };
      if (!ready()) {
        // Idle: what was decoded so far is acknowledged before sleeping.
        lock.unlock();
        machine_.onIdle(nowMs());
        serveConnection(nowMs());
        lock.lock();
        if (const auto wake = machine_.wakeAtMs()) {
          const auto now = nowMs();
          wakeDecoder_.wait_for(
              lock,
              std::chrono::milliseconds(*wake > now ? *wake - now : 0),
              ready);
        } else {
          wakeDecoder_.wait(lock, ready);
        }
      }
      if (stopping_) break;
      std::swap(views, newViews_);
      checkWanted_ = false;
      if (!events_.empty()) {
        event = std::move(events_.front());
        events_.pop_front();
        eventBytes_ -= event->message.size();
      }
    }
    for (std::size_t m = 0; m < views.size(); ++m) {
      if (views[m]) machine_.setView(*views[m], nowMs(), m);
    }
    if (event) handle(std::move(*event), nowMs());
    if (const auto wake = machine_.wakeAtMs(); wake && nowMs() >= *wake) machine_.onTimer(nowMs());
  }
  if (connection_) connection_->close();
}

void ClientSession::handle(Event event, std::uint64_t now) {
  switch (event.kind) {
    case Event::Kind::kOpen:
      machine_.onOpen(now);
      break;
    case Event::Kind::kMessage:
      machine_.onMessage(event.message, event.wireBytes, now);
      break;
    case Event::Kind::kClosed:
      machine_.onClosed(event.reason, now);
      break;
  }
}

void ClientSession::serveConnection(std::uint64_t) {
  const bool wanted = machine_.wantsConnection();
  if (connection_ && (!wanted || connectionNumber_ != machine_.connectionNumber())) {
    connection_->close();
    connection_.reset();
    listener_.reset();
    // What the old connection still said must not be taken for the new one's.
    const std::lock_guard lock(mutex_);
    events_.clear();
    eventBytes_ = 0;
  }
  if (wanted && !connection_) {
    connectionNumber_ = machine_.connectionNumber();
    listener_ = std::make_shared<Inbox>(*this);
    connection_ = connect_();
    connection_->start(*listener_);
  }
  auto outbox = machine_.takeOutbox();
  if (!connection_) return;
  for (auto& message : outbox)
    connection_->send(std::move(message));
}

void ClientSession::publish(std::uint64_t now) {
  const bool done = machine_.phase() == SessionMachine::Phase::kDone;
  const std::size_t count = machine_.modelCount();
  bool wanted = false;
  std::vector<bool> changed(count, false);
  {
    const std::lock_guard lock(mutex_);
    if (outcome_ || failure_) return;
    progress_.state = machine_.state();
    progress_.splitsHeld = 0;
    progress_.splitsTotal = 0;
    progress_.bytes = machine_.bytes();
    progress_.notice = machine_.notice();
    for (std::size_t m = 0; m < count; ++m) {
      const StreamDecoder& decoder = machine_.decoder(m);
      if (decoder.hasModel() && (!models_[m] || models_[m]->asset != decoder.model().asset)) {
        models_[m] = decoder.model();
        wakeCaller_.notify_all();
      }
      if (!decoder.hasBase()) continue;
      progress_.splitsHeld += decoder.mesh().splitsHeld();
      progress_.splitsTotal += decoder.mesh().splitsTotal();
    }
    if (machine_.failure()) {
      failure_ = machine_.failure();
      wakeCaller_.notify_all();
      return;
    }
    // A view that the machine has not seen yet has reached nothing.
    wanted = wantedState_ && !stateReached_ && !hasNewView() && machine_.hasReached(*wantedState_);
    if (wantedState_ && !wanted && !hasNewView() && machine_.blocked()) {
      stateBlocked_ = machine_.blocked();
      wakeCaller_.notify_all();
    }
    const bool due = done || wanted || now >= publishedAtMs_ + options_.publishEveryMs;
    bool any = false;
    for (std::size_t m = 0; m < count; ++m) {
      const StreamDecoder& decoder = machine_.decoder(m);
      changed[m] = decoder.hasBase() &&
                   (!snapshots_[m] || (due && snapshots_[m]->revision != decoder.revision()));
      any = any || changed[m];
    }
    if (!done && !wanted && !any) return;
  }
  // Copied outside the lock, so that readers never wait for it; only this thread writes snapshots_.
  for (std::size_t m = 0; m < count; ++m) {
    if (!changed[m]) continue;
    auto fresh = machine_.decoder(m).snapshot();
    const std::lock_guard lock(mutex_);
    std::swap(snapshots_[m], fresh);
  }
  const std::lock_guard lock(mutex_);
  publishedAtMs_ = now;
  if (wanted) stateReached_ = outcomeNow();
  if (done) outcome_ = outcomeNow();
  if (wanted || done) wakeCaller_.notify_all();
}

SessionOutcome ClientSession::outcomeNow() const {
  return {
      snapshots_.front(),
      snapshots_,
      machine_.state(),
      machine_.bytes(),
      machine_.times(),
      machine_.reconnects(),
      machine_.contours()};
}

}  // namespace limn
