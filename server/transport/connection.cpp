// SPDX-License-Identifier: Apache-2.0
#include "server/transport/connection.h"

#include "protocol/text.h"

#include <libwebsockets.h>
#include <linux/sockios.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>

namespace limn {
namespace {

constexpr std::size_t kMaxReasonBytes = 123;  // of a close frame [RFC 6455, 5.5]
constexpr double kBurstSeconds = 2.0;
constexpr std::size_t kSmallFrameBytes = 64;
constexpr std::size_t kSaidAtOnce = 64 * 1024;  // then others have their turn
constexpr std::int64_t kLookMs = 1000;
constexpr std::int64_t kPingMs = 20'000;    // of silence, then a ping
constexpr std::int64_t kPongMs = 10'000;    // without an answer, then the line is taken for dead
constexpr std::int64_t kFarewellMs = 2000;  // for a last message to a client that is given up

}  // namespace

Connection::Connection(Client client, Shared shared, std::int64_t nowMs)
    : wsi_(client.socket),
      number_(client.number),
      shared_(shared),
      session_(shared.sessions, *this, nowMs, std::move(client.grant)),
      rate_(shared.limits.messagesPerSecond, kBurstSeconds * shared.limits.messagesPerSecond),
      heardMs_(nowMs),
      progressMs_(nowMs) {}

void Connection::wantWrite() {
  if (!receiving_) askToWrite();
}

void Connection::askToWrite() {
  if (wantsWrite_) return;
  wantsWrite_ = true;
  lws_callback_on_writable(wsi_);
}

int Connection::closeNow(int code, const std::string& reason, Ending ending) {
  if (ending_ == Ending::kLeft) ending_ = ending;
  std::array<unsigned char, kMaxReasonBytes> text{};
  const std::size_t size = std::min(reason.size(), text.size());
  // A cut must not leave half a character: a close reason is UTF-8.
  std::transform(
      reason.begin(),
      reason.begin() + static_cast<std::ptrdiff_t>(size),
      text.begin(),
      [](char c) { return c >= ' ' && c < 0x7F ? static_cast<unsigned char>(c) : '?'; });
  lws_close_reason(wsi_, static_cast<lws_close_status>(code), text.data(), size);
  return -1;
}

void Connection::giveUp(const std::string& why, Ending ending, std::int64_t nowMs) {
  if (givenUpMs_ != 0) return;
  givenUpMs_ = nowMs;
  if (ending_ == Ending::kLeft) ending_ = ending;
  session_.refuseForLimit(why);
}

int Connection::receive(const void* in, std::size_t size, std::int64_t nowMs) {
  const auto* bytes = static_cast<const std::uint8_t*>(in);
  heardMs_ = nowMs;
  noteQuiet(nowMs);
  if (lws_frame_is_binary(wsi_) == 0) {
    return closeNow(LWS_CLOSE_STATUS_UNACCEPTABLE_OPCODE, "messages are binary", Ending::kProtocol);
  }
  const std::size_t remaining = lws_remaining_packet_payload(wsi_);
  const std::size_t most = shared_.limits.maxMessageBytes;
  if (remaining > most || partial_.size() + size + remaining > most) {
    return closeNow(
        LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE,
        "a message may have " + std::to_string(most) + " bytes",
        Ending::kTooLarge);
  }
  const bool last = lws_is_final_fragment(wsi_) != 0 && remaining == 0;
  // Small pieces count too: a message of empty ones need never end.
  if ((last || size < kSmallFrameBytes) && !rate_.take(nowMs)) {
    giveUp(
        "too many messages; at most " + std::to_string(shared_.limits.messagesPerSecond) +
            " a second",
        Ending::kTooMany,
        nowMs);
    return 0;
  }
  if (!last) {
    partial_.insert(partial_.end(), bytes, bytes + size);
    return 0;
  }
  ++shared_.traffic.receivedMessages;
  receiving_ = true;
  if (partial_.empty()) {
    session_.receive({bytes, size}, nowMs);
  } else {
    partial_.insert(partial_.end(), bytes, bytes + size);
    session_.receive(partial_, nowMs);
    partial_ = {};
  }
  receiving_ = false;
  // Most poses lead to nothing, and most answers fit what the network takes at once: then there is
  // no callback to wait for.
  return wantsWrite_ ? 0 : say(nowMs);
}

// The library would send back one byte as it came, and looks at the reason's bytes one by one, so
// that it misses a character that is cut off at the end.
int Connection::closedByPeer(std::string_view payload) {
  if (payload.size() == 1) {
    return closeNow(LWS_CLOSE_STATUS_PROTOCOL_ERR, "half a close code", Ending::kProtocol);
  }
  if (payload.size() > 2 && !protocol::isUtf8(payload.substr(2))) {
    return closeNow(LWS_CLOSE_STATUS_INVALID_PAYLOAD, "the reason is not UTF-8", Ending::kProtocol);
  }
  return 0;
}

int Connection::write(std::int64_t nowMs) {
  wantsWrite_ = false;
  return pingWanted_ ? ping() : say(nowMs);
}

/// Writes what there is to say as long as the network takes it at once, and asks for a callback for
/// the rest.
int Connection::say(std::int64_t nowMs) {
  std::size_t said = 0;
  while (true) {
    std::optional<OutMessage> message;
    if (next_) {
      message = std::move(*next_);
      next_ = nullptr;
    } else {
      message = session_.nextMessage(nowMs);
    }
    if (!message) return farewell();
    if (said >= kSaidAtOnce || lws_send_pipe_choked(wsi_) != 0) {
      next_ = std::make_unique<OutMessage>(std::move(*message));
      askToWrite();
      return 0;
    }
    if (put(message->bytes(), nowMs) < 0) return -1;
    said += message->bytes().size();
  }
}

int Connection::put(protocol::Bytes bytes, std::int64_t nowMs) {
  // The library writes its frame header in front of what it is given.
  std::vector<std::uint8_t>& scratch = shared_.scratch;
  scratch.resize(LWS_PRE + bytes.size());
  std::memcpy(scratch.data() + LWS_PRE, bytes.data(), bytes.size());
  const int written = lws_write(wsi_, scratch.data() + LWS_PRE, bytes.size(), LWS_WRITE_BINARY);
  if (written < 0 || static_cast<std::size_t>(written) < bytes.size()) return -1;
  progressMs_ = nowMs;
  shared_.traffic.sentBytes += bytes.size();
  ++shared_.traffic.sentMessages;
  rate_.give(static_cast<double>(bytes.size()) / 1024.0);
  return 0;
}

/// Closes if the session is at its end.
int Connection::farewell() {
  const auto close = session_.close();
  if (!close) return 0;
  return *close == Session::Close::kGoingAway
             ? closeNow(LWS_CLOSE_STATUS_GOINGAWAY, session_.closeReason(), Ending::kDrained)
             : closeNow(
                   LWS_CLOSE_STATUS_POLICY_VIOLATION,
                   session_.closeReason(),
                   Ending::kProtocol);
}

int Connection::ping() {
  pingWanted_ = false;
  // Not empty: the library keeps quiet about an empty answer.
  std::array<unsigned char, LWS_PRE + 1> text{};
  if (lws_write(wsi_, text.data() + LWS_PRE, 1, LWS_WRITE_PING) < 0) return -1;
  askToWrite();
  return 0;
}

/// While nothing waits, nothing can stall: waiting begins after this.
void Connection::noteQuiet(std::int64_t nowMs) {
  if (!wantsWrite_ && !session_.waitingSinceMs()) progressMs_ = nowMs;
}

/// Whether for too long the network took nothing of what we have for the client, or the client
/// acknowledged nothing of what it has been given. A slow link alone is no reason.
bool Connection::stalled(std::int64_t nowMs) {
  const auto waiting = session_.waitingSinceMs();
  if (!waiting && !wantsWrite_) return false;
  if (nowMs - lookedMs_ >= std::min(kLookMs, shared_.limits.progressMs / 4)) {
    lookedMs_ = nowMs;
    int queued = 0;
    if (ioctl(lws_get_socket_fd(wsi_), SIOCOUTQ, &queued) == 0 && queued != queuedBytes_) {
      queuedBytes_ = queued;
      progressMs_ = nowMs;
    }
  }
  const std::int64_t since =
      queuedBytes_ > 0 ? std::max(progressMs_, waiting.value_or(0)) : waiting.value_or(progressMs_);
  return nowMs - since > shared_.limits.progressMs;
}

bool Connection::tick(std::int64_t nowMs) {
  update(nowMs);
  if (givenUpMs_ != 0) return nowMs - givenUpMs_ <= kFarewellMs;
  if (nowMs - heardMs_ <= kPingMs) {
    pingedMs_ = 0;
  } else if (pingedMs_ == 0) {
    pingedMs_ = nowMs;
    pingWanted_ = true;
    askToWrite();
  } else if (nowMs - pingedMs_ > kPongMs) {
    return false;
  }
  if (!session_.greeted() && nowMs - session_.bornMs() > shared_.limits.handshakeMs) {
    giveUp(
        "no Hello within " + std::to_string(shared_.limits.handshakeMs) + " ms",
        Ending::kLate,
        nowMs);
  } else if (stalled(nowMs)) {
    giveUp(
        "nothing taken or acknowledged for " + std::to_string(shared_.limits.progressMs) + " ms",
        Ending::kStalled,
        nowMs);
  }
  return true;
}

void Connection::drain(std::uint32_t retryAfterMs) {
  session_.drain(retryAfterMs);
}

}  // namespace limn
