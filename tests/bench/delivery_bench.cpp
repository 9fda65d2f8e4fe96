// SPDX-License-Identifier: Apache-2.0
//
// What a pose costs the server's loop thread when its view cell's target set is cached: taking the
// pose in, and making the packets it leads to, encoding included. One line of JSON:
//   limn-delivery-bench STORE MODEL
// split_ns is what the poses that lead to packets cost above those that lead to none, a split.
#include "server/session/session.h"
#include "server/store/directory_store.h"
#include "tests/bench/one_model.h"

#include "protocol/limits.h"

#include "shared/codec/varint.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr int kPoses = 240;  // a whole turn at 15 degrees a second and 10 poses a second
constexpr int kRounds = 5;

double cpuUs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

class InlineTasks final : public TaskRunner {
 public:
  void submit(std::function<void()> work, std::function<void()> done) override {
    work();
    done();
  }

  [[nodiscard]] std::size_t pending() const override { return 0; }
};

class NoPeer final : public Peer {
 public:
  void wantWrite() override {}
};

struct Cost {
  double us = 0.0;
  std::uint32_t splits = 0;
};

/// One client that circles the model; what each pose cost.
std::vector<Cost> circle(SessionShared& shared, const Model& model) {
  NoPeer peer;
  Session session(shared, peer, 0);
  std::uint64_t payload = 0;
  std::uint32_t splits = 0;
  std::vector<std::vector<std::uint8_t>> arrived;
  const auto take = [&](std::int64_t nowMs) {
    while (auto out = session.nextMessage(nowMs)) {
      const auto bytes = out->bytes();
      if (out->payload) payload += bytes.size();
      arrived.emplace_back(bytes.begin(), bytes.end());
    }
  };
  session.receive(protocol::encodeMessage(protocol::Hello{1, "bench"}), 0);
  session.receive(protocol::encodeMessage(protocol::Open{0, "model", false}), 0);
  std::vector<Cost> costs;
  std::int64_t nowMs = 0;
  for (int i = 0; i < kPoses; ++i) {
    const double angle = 1.5 * i * std::numbers::pi / 180.0;
    const auto& info = model.info();
    const glm::dvec3 out = glm::normalize(glm::dvec3(std::sin(angle), 0.36, std::cos(angle)));
    protocol::Pose pose;
    pose.id = static_cast<std::uint32_t>(i + 1);
    pose.eye = info.center + 3.0 * info.radius * out;
    pose.forward = -out;
    const auto message = protocol::encodeMessage(pose);
    nowMs += 100;
    arrived.clear();
    const double begin = cpuUs();
    session.receive(message, nowMs);
    take(nowMs);
    Cost cost;
    cost.us = cpuUs() - begin;
    splits = 0;
    for (const auto& bytes : arrived) {
      const auto decoded = protocol::decodeMessage(bytes, protocol::Sender::kServer);
      if (const auto* packet = decoded->as<protocol::Packet>())
        splits += *VarintReader(packet->splits).read() / 2;
    }
    cost.splits = splits;
    costs.push_back(cost);
    session.receive(protocol::encodeMessage(protocol::Acknowledge{payload}), nowMs + 10);
    // What the window held back belongs to nobody's account here; it goes before the next pose.
    for (int step = 1; step < 6; ++step) {
      session.update(nowMs + 10 * step);
      take(nowMs + 10 * step);
      session.receive(protocol::encodeMessage(protocol::Acknowledge{payload}), nowMs + 10 * step);
    }
  }
  return costs;
}

int run(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: limn-delivery-bench STORE MODEL\n"), 2;
  const auto store = openDirectoryStore(argv[1]);
  if (!store) return std::fprintf(stderr, "%s\n", store.error().message.c_str()), 1;
  std::shared_ptr<const Model> model;
  const auto names = (*store)->names();
  for (const NameRecord& record : names ? *names : std::vector<NameRecord>{}) {
    if (record.name != argv[2]) continue;
    const auto asset = (*store)->open(record.asset);
    auto loaded = asset ? Model::load(*asset) : tl::unexpected(asset.error());
    if (!loaded) return std::fprintf(stderr, "%s\n", loaded.error().message.c_str()), 1;
    model = *loaded;
  }
  if (!model) return std::fprintf(stderr, "%s: no such model\n", argv[2]), 1;
  InlineTasks tasks;
  OneModel models(model);
  ViewCells cells(tasks, {});
  SessionOptions options;
  options.prefetchAfterMs = -1;
  options.aheadMs = 0;  // so that packets answer poses
  SessionShared shared{models, cells, options};
  circle(shared, *model);  // fills the cache of cells

  std::vector<double> idle;
  double splitUs = 0.0;
  double splits = 0.0;
  std::vector<Cost> sending;
  for (int round = 0; round < kRounds; ++round) {
    const auto costs = circle(shared, *model);
    // The first has a set of its own; the start is sent with it.
    for (std::size_t i = 1; i < costs.size(); ++i) {
      if (costs[i].splits == 0) idle.push_back(costs[i].us);
      if (costs[i].splits > 0) sending.push_back(costs[i]);
    }
  }
  std::ranges::sort(idle);
  const double poseUs = idle.empty() ? 0.0 : idle[idle.size() / 2];
  for (const Cost& cost : sending) {
    splitUs += cost.us - poseUs;
    splits += cost.splits;
  }
  std::printf(
      "{\"pose_us\":%.3f,\"split_ns\":%.3f,\"poses\":%zu,\"poses_that_send\":%zu,\"splits\":%.0f}"
      "\n",
      poseUs,
      splits > 0.0 ? 1000.0 * splitUs / splits : 0.0,
      idle.size() + sending.size(),
      sending.size(),
      splits);
  return 0;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(argc, argv);
}
