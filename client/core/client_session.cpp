// SPDX-License-Identifier: Apache-2.0
#include "client/core/client_session.h"

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

Result<ModelDescription> ClientSession::waitForModel(std::uint64_t timeoutMs) {
  std::unique_lock lock(mutex_);
  waitFor(lock, timeoutMs, [this] { return model_ || failure_; });
  if (model_) return *model_;
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
  checkWanted_ = true;
  wakeDecoder_.notify_one();
  waitFor(lock, timeoutMs, [this] { return stateReached_ || failure_; });
  wantedState_.reset();
  if (stateReached_) return *stateReached_;
  if (failure_) return tl::unexpected(*failure_);
  return fail(ErrorCode::kUnavailable, "the state asked for is not reached yet");
}

bool ClientSession::isRunning() const {
  const std::lock_guard lock(mutex_);
  return !outcome_ && !failure_;
}

void ClientSession::setView(const View& view) {
  const std::lock_guard lock(mutex_);
  newView_ = view;
  wakeDecoder_.notify_one();
}

std::shared_ptr<const MeshSnapshot> ClientSession::latest() const {
  const std::lock_guard lock(mutex_);
  return snapshot_;
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
    std::optional<View> view;
    {
      std::unique_lock lock(mutex_);
      const auto ready = [this] {
        return stopping_ || !events_.empty() || newView_ || checkWanted_;
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
      std::swap(view, newView_);
      checkWanted_ = false;
      if (!events_.empty()) {
        event = std::move(events_.front());
        events_.pop_front();
        eventBytes_ -= event->message.size();
      }
    }
    if (view) machine_.setView(*view, nowMs());
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
  const StreamDecoder& decoder = machine_.decoder();
  const bool done = machine_.phase() == SessionMachine::Phase::kDone;
  bool wanted = false;
  bool changed = false;
  {
    const std::lock_guard lock(mutex_);
    if (outcome_ || failure_) return;
    progress_.state = machine_.state();
    progress_.splitsHeld = decoder.hasBase() ? decoder.mesh().splitsHeld() : 0;
    progress_.splitsTotal = decoder.hasBase() ? decoder.mesh().splitsTotal() : 0;
    progress_.bytes = machine_.bytes();
    progress_.notice = machine_.notice();
    if (decoder.hasModel() && (!model_ || model_->asset != decoder.model().asset)) {
      model_ = decoder.model();
      wakeCaller_.notify_all();
    }
    if (machine_.failure()) {
      failure_ = machine_.failure();
      wakeCaller_.notify_all();
      return;
    }
    // A view that the machine has not seen yet has reached nothing.
    wanted = wantedState_ && !stateReached_ && !newView_ && machine_.hasReached(*wantedState_);
    changed = decoder.hasBase() && (!snapshot_ || snapshot_->revision != decoder.revision());
    const bool due =
        done || wanted || !snapshot_ || now >= publishedAtMs_ + options_.publishEveryMs;
    if (!done && !wanted && !(changed && due)) return;
  }
  // Copied outside the lock, so that readers never wait for it; only this thread writes snapshot_.
  auto fresh = changed ? decoder.snapshot() : snapshot_;
  const std::lock_guard lock(mutex_);
  snapshot_ = fresh;
  publishedAtMs_ = now;
  if (wanted) stateReached_ = outcomeNow(fresh);
  if (done) outcome_ = outcomeNow(fresh);
  if (wanted || done) wakeCaller_.notify_all();
}

SessionOutcome ClientSession::outcomeNow(std::shared_ptr<const MeshSnapshot> snapshot) const {
  return {
      std::move(snapshot),
      machine_.state(),
      machine_.bytes(),
      machine_.times(),
      machine_.reconnects()};
}

}  // namespace limn
