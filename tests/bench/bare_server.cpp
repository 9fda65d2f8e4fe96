// SPDX-License-Identifier: Apache-2.0
//
// A bare libwebsockets server, to compare limn-server with: it does nothing but send. Before it
// listens it records what a session answers to one client that circles a model (15 degrees a
// second, 10 poses a second, everything acknowledged at once); then every client is sent that
// recording, pose for pose, so that limn-load can drive it like the real one:
//   limn-bare-server STORE MODEL PORT
#include "server/session/session.h"
#include "server/store/directory_store.h"
#include "tests/bench/inline_session.h"
#include "tests/bench/one_model.h"

#include "protocol/limits.h"

#include <ev.h>
#include <libwebsockets.h>
#include <sys/resource.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr int kPoses = 300;
constexpr std::int64_t kPoseMs = 100;
constexpr double kDegreesAPose = 1.5;
constexpr std::size_t kTxPacketBytes = 64 * 1024;

/// A message with room in front for the library.
using Framed = std::vector<std::uint8_t>;

/// What each message of a client is answered with: Hello, Open, then poses.
using Recording = std::vector<std::vector<Framed>>;

Recording record(const std::shared_ptr<const Model>& model, std::string_view name) {
  InlineTasks tasks;
  ViewCells cells(tasks, {});
  OneModel models(model);
  SessionShared shared{models, cells, SessionOptions{}};
  NoPeer peer;
  Session session(shared, peer, 0);
  Recording recording;
  std::uint64_t payload = 0;
  const auto take = [&](std::int64_t nowMs) {
    session.update(nowMs);
    while (auto out = session.nextMessage(nowMs)) {
      const auto bytes = out->bytes();
      if (out->payload) payload += bytes.size();
      Framed framed(LWS_PRE);
      framed.insert(framed.end(), bytes.begin(), bytes.end());
      recording.back().push_back(std::move(framed));
      session.receive(protocol::encodeMessage(protocol::Acknowledge{payload}), nowMs);
    }
  };
  const auto tell = [&](const protocol::Body& body, std::int64_t nowMs) {
    recording.emplace_back();
    session.receive(protocol::encodeMessage(body), nowMs);
    take(nowMs);
  };
  tell(protocol::Hello{limits::kProtocolVersion, "bare"}, 0);
  tell(protocol::Open{0, std::string(name), false}, 0);
  const auto& info = model->info();
  for (int i = 0; i < kPoses; ++i) {
    const double angle = kDegreesAPose * i * std::numbers::pi / 180.0;
    const glm::dvec3 out = glm::normalize(glm::dvec3(std::sin(angle), 0.36, std::cos(angle)));
    protocol::Pose pose;
    pose.id = static_cast<std::uint32_t>(i + 1);
    pose.eye = info.center + 3.0 * info.radius * out;
    pose.forward = -out;
    const std::int64_t nowMs = kPoseMs * (i + 1);
    tell(pose, nowMs);
    take(nowMs + kPoseMs / 2);
  }
  return recording;
}

struct Client {
  std::size_t heard = 0;    // messages of it that are answered
  std::size_t message = 0;  // of those, of the first that is not sent whole, the next answer
  std::size_t sending = 0;  // which that is
};

struct Bare {
  Recording recording;
  std::size_t acknowledgeBytes = protocol::encodeMessage(protocol::Acknowledge{1U << 30}).size();

  int callback(lws* wsi, lws_callback_reasons reason, Client* client, std::size_t size) const {
    switch (reason) {
      case LWS_CALLBACK_ESTABLISHED:
        *client = {};
        return 0;
      case LWS_CALLBACK_RECEIVE:
        if (client->heard >= 2 && size <= acknowledgeBytes) return 0;
        client->heard = std::min(client->heard + 1, recording.size());
        return more(*client) ? (lws_callback_on_writable(wsi), 0) : 0;
      case LWS_CALLBACK_SERVER_WRITEABLE:
        return more(*client) ? write(wsi, *client) : 0;
      default:
        return 0;
    }
  }

  bool more(Client& client) const {
    while (client.sending < client.heard && client.message == recording[client.sending].size()) {
      ++client.sending;
      client.message = 0;
    }
    return client.sending < client.heard;
  }

  int write(lws* wsi, Client& client) const {
    // The library writes its frame header in front.
    static Framed scratch;
    scratch = recording[client.sending][client.message++];
    const std::size_t size = scratch.size() - LWS_PRE;
    const int sent = lws_write(wsi, scratch.data() + LWS_PRE, size, LWS_WRITE_BINARY);
    if (sent < static_cast<int>(size)) return -1;
    if (more(client)) lws_callback_on_writable(wsi);
    return 0;
  }
};

int callback(lws* wsi, lws_callback_reasons reason, void* user, void*, std::size_t size) {
  const auto* bare = static_cast<const Bare*>(lws_context_user(lws_get_context(wsi)));
  return bare == nullptr ? 0 : bare->callback(wsi, reason, static_cast<Client*>(user), size);
}

std::shared_ptr<const Model> load(const char* folder, std::string_view name) {
  const auto store = openDirectoryStore(folder);
  const auto names = store ? (*store)->names() : Result<std::vector<NameRecord>>{};
  for (const NameRecord& record : names ? *names : std::vector<NameRecord>{}) {
    if (record.name != name) continue;
    const auto asset = (*store)->open(record.asset);
    const auto model = asset ? Model::load(*asset) : tl::unexpected(asset.error());
    if (model) return *model;
  }
  return nullptr;
}

int serve(const Bare& bare, int port) {
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;
  setrlimit(RLIMIT_NOFILE, &files);
  const std::array<lws_protocols, 2> protocols = {{
      {limits::kSubprotocol, callback, sizeof(Client), 4096, 0, nullptr, kTxPacketBytes},
      {nullptr, nullptr, 0, 0, 0, nullptr, 0},
  }};
  struct ev_loop* loop = ev_loop_new(EVFLAG_AUTO);
  void* loops[] = {loop};
  const lws_retry_bo_t noPings = {nullptr, 0, 0, 0, 0, 0};
  lws_context_creation_info info{};
  info.port = port;
  info.iface = "127.0.0.1";
  info.protocols = protocols.data();
  info.foreign_loops = loops;
  info.user = const_cast<Bare*>(&bare);
  info.options = LWS_SERVER_OPTION_LIBEV | LWS_SERVER_OPTION_DISABLE_IPV6;
  info.fd_limit_per_thread = static_cast<unsigned>(files.rlim_cur);
  info.pt_serv_buf_size = static_cast<unsigned>(kTxPacketBytes);
  info.retry_and_idle_policy = &noPings;
  lws_set_log_level(LLL_ERR, nullptr);
  lws_context* context = lws_create_context(&info);
  if (context == nullptr) return std::fprintf(stderr, "cannot listen\n"), 1;
  std::printf("limn-bare-server: listening on ws://127.0.0.1:%d\n", port);
  std::fflush(stdout);
  ev_run(loop, 0);  // until it is killed
  return 0;
}

int run(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "usage: limn-bare-server STORE MODEL PORT\n"), 2;
  const auto model = load(argv[1], argv[2]);
  if (!model) return std::fprintf(stderr, "no such model, or it cannot be read\n"), 1;
  Bare bare;
  bare.recording = record(model, argv[2]);
  std::size_t bytes = 0, messages = 0;
  for (const auto& answers : bare.recording) {
    messages += answers.size();
    for (const Framed& answer : answers)
      bytes += answer.size() - LWS_PRE;
  }
  std::printf("limn-bare-server: %zu messages, %zu bytes a client\n", messages, bytes);
  return serve(bare, std::atoi(argv[3]));
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(argc, argv);
}
