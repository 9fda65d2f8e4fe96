// SPDX-License-Identifier: Apache-2.0
#include "client/net/lws_connection.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>

namespace limn {
namespace {

/// Waits for what a connection has to say.
class Listener : public ConnectionListener {
 public:
  void onOpen() override {}

  void onMessage(std::vector<std::uint8_t>, std::size_t) override {}

  void onClosed(const Error& reason) override {
    const std::lock_guard lock(mutex_);
    reason_ = reason;
    wake_.notify_all();
  }

  Error closed() {
    std::unique_lock lock(mutex_);
    wake_.wait(lock, [this] { return !reason_.message.empty(); });
    return reason_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable wake_;
  Error reason_;
};

/// A TCP port that is bound, and listens if asked to.
class Port {
 public:
  enum class Kind { kDeaf, kListening };

  explicit Port(Kind kind) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    socklen_t size = sizeof address;
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
    number_ = ntohs(address.sin_port);
    if (kind == Kind::kListening) ::listen(socket_, 4);
  }

  ~Port() { ::close(socket_); }

  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  [[nodiscard]] LwsConnectionOptions options() const {
    LwsConnectionOptions options;
    options.url.host = "127.0.0.1";
    options.url.port = number_;
    return options;
  }

  /// Takes one connection, says `answer` to it and hangs up.
  void answerOnce(const char* answer) const {
    const int peer = ::accept(socket_, nullptr, nullptr);
    char request[4096];
    (void)!::read(peer, request, sizeof request);
    (void)!::write(peer, answer, std::char_traits<char>::length(answer));
    ::close(peer);
  }

 private:
  int socket_;
  std::uint16_t number_ = 0;
};

TEST(LwsConnection, SaysWhenNobodyListens) {
  const Port port(Port::Kind::kDeaf);
  Listener listener;
  const auto connection = makeLwsConnection(port.options());
  connection->start(listener);
  EXPECT_EQ(listener.closed().code, ErrorCode::kNetwork);
  EXPECT_NE(listener.closed().message.find(port.options().url.text()), std::string::npos);
  connection->close();
}

TEST(LwsConnection, SaysThatTheTokenIsWrong) {
  const Port port(Port::Kind::kListening);
  Listener listener;
  const auto connection = makeLwsConnection(port.options());
  connection->start(listener);
  port.answerOnce("HTTP/1.1 401 Unauthorized\r\nContent-Length: 0\r\n\r\n");
  EXPECT_NE(listener.closed().message.find("--token-file"), std::string::npos)
      << listener.closed().message;
}

TEST(LwsConnection, SurvivesAnswersThatAreNoWebSocket) {
  for (const char* answer :
       {"HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n", "garbage\r\n\r\n", ""}) {
    const Port port(Port::Kind::kListening);
    Listener listener;
    const auto connection = makeLwsConnection(port.options());
    connection->start(listener);
    port.answerOnce(answer);
    EXPECT_FALSE(listener.closed().message.empty());
  }
}

TEST(LwsConnection, ClosesWhileItConnects) {
  const Port port(Port::Kind::kListening);  // takes the connection, never answers
  Listener listener;
  const auto connection = makeLwsConnection(port.options());
  connection->start(listener);
  connection->send({1, 2, 3});
  connection->close();
  connection->send({4});
}

}  // namespace
}  // namespace limn
