// SPDX-License-Identifier: Apache-2.0
//
// What a pose costs the server's loop thread when its view cell's target set is cached: taking the
// pose in, and making the packets it leads to, encoding included. One line of JSON:
//   limn-delivery-bench STORE MODEL
// pose_us is what a pose costs that leads to nothing. Those that lead to packets cost a line,
// {us: fixed, ns: a split}, fitted by least squares, and a part of them at most what the target
// says (20 µs and 100 ns a split), when
//   first     nobody was ever sent these splits: they are modelled too;
//   usual     they were modelled before, and nobody was sent these packets;
//   shared    other clients were sent the same packets.
#include "server/session/session.h"
#include "server/store/directory_store.h"
#include "tests/bench/inline_session.h"
#include "tests/bench/measure.h"
#include "tests/bench/one_model.h"

#include "protocol/limits.h"

#include "shared/codec/varint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

namespace limn {
namespace {

constexpr int kPoses = 240;  // a whole turn at 15 degrees a second and 10 poses a second
constexpr int kRounds = 5;

struct Cost {
  double us = 0.0;
  std::uint32_t splits = 0;
};

/// One client that circles the model, starting at an angle in degrees; what each pose cost.
std::vector<Cost> circle(SessionShared& shared, const Model& model, double start) {
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
    const double angle = (start + 1.5 * i) * std::numbers::pi / 180.0;
    const auto& info = model.info();
    const glm::dvec3 out = glm::normalize(glm::dvec3(std::sin(angle), 0.36, std::cos(angle)));
    protocol::Pose pose;
    pose.id = static_cast<std::uint32_t>(i + 1);
    pose.eye = info.center + 3.0 * info.radius * out;
    pose.forward = -out;
    const auto message = protocol::encodeMessage(pose);
    nowMs += 100;
    arrived.clear();
    const double begin = threadCpuMs();
    session.receive(message, nowMs);
    take(nowMs);
    Cost cost;
    cost.us = 1e3 * (threadCpuMs() - begin);
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

struct Price {
  std::vector<double> idleUs;  // poses that lead to nothing
  std::vector<Cost> sending;

  [[nodiscard]] double poseUs() const {
    std::vector<double> sorted = idleUs;
    std::ranges::sort(sorted);
    return sorted.empty() ? 0.0 : sorted[sorted.size() / 2];
  }

  /// As JSON.
  [[nodiscard]] std::string line() const {
    double sum = 0.0, sumX = 0.0, sumXX = 0.0, sumY = 0.0, sumXY = 0.0, within = 0.0;
    for (const Cost& cost : sending) {
      const double x = cost.splits;
      sum += 1.0;
      sumX += x;
      sumXX += x * x;
      sumY += cost.us;
      sumXY += x * cost.us;
      within += cost.us <= 20.0 + 0.1 * x ? 1.0 : 0.0;
    }
    const double slope = (sum * sumXY - sumX * sumY) / std::max(sum * sumXX - sumX * sumX, 1.0);
    const double mean = std::max(sum, 1.0);
    std::array<char, 160> text{};
    std::snprintf(
        text.data(),
        text.size(),
        "{\"us\":%.2f,\"ns\":%.1f,\"mean_us\":%.2f,\"mean_splits\":%.1f,\"within_target\":%.3f}",
        (sumY - slope * sumX) / mean,
        1000.0 * slope,
        sumY / mean,
        sumX / mean,
        within / mean);
    return text.data();
  }
};

/// Clients that come one after the other, from different sides, so that each lacks other splits.
Price circles(const std::shared_ptr<const Model>& model, ViewCells& cells) {
  OneModel models(model);
  SessionOptions options;
  options.prefetchAfterMs = -1;
  options.aheadMs = 0;  // so that packets answer poses
  SessionShared shared{models, cells, options};
  Price price;
  for (int round = 0; round < kRounds; ++round) {
    const auto costs = circle(shared, *model, 70.3 * round);
    // The first has a set of its own; the start is sent with it.
    for (std::size_t i = 1; i < costs.size(); ++i) {
      if (costs[i].splits == 0) price.idleUs.push_back(costs[i].us);
      if (costs[i].splits > 0) price.sending.push_back(costs[i]);
    }
  }
  return price;
}

/// Null, with a line on standard error, when there is no such model.
std::shared_ptr<const Model> load(const char* folder, std::string_view name) {
  const auto store = openDirectoryStore(folder);
  if (!store) return std::fprintf(stderr, "%s\n", store.error().message.c_str()), nullptr;
  const auto names = (*store)->names();
  for (const NameRecord& record : names ? *names : std::vector<NameRecord>{}) {
    if (record.name != name) continue;
    const auto asset = (*store)->open(record.asset);
    const auto model = asset ? Model::load(*asset) : tl::unexpected(asset.error());
    if (model) return *model;
    return std::fprintf(stderr, "%s\n", model.error().message.c_str()), nullptr;
  }
  return std::fprintf(stderr, "no model has this name\n"), nullptr;
}

int run(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: limn-delivery-bench STORE MODEL\n"), 2;
  InlineTasks tasks;
  ViewCells cells(tasks, {});
  // In memory three times: cells are shared by all that have one asset, packets are not.
  std::array<std::shared_ptr<const Model>, 3> models;
  for (auto& model : models) {
    model = load(argv[1], argv[2]);
    if (!model) return 1;
  }
  circles(models[0], cells);  // fills the cache of cells
  const Price first = circles(models[1], cells);
  const Price shared = circles(models[1], cells);
  std::vector<VertexId> all;
  for (VertexId v = models[2]->forest().baseVertexCount(); v < models[2]->forest().vertexCount();
       ++v)
    all.push_back(v);
  static_cast<void>(models[2]->packets().packet(all));
  const Price usual = circles(models[2], cells);
  std::printf(
      "{\"pose_us\":%.3f,\"first\":%s,\"usual\":%s,\"shared\":%s,\"poses\":%zu,"
      "\"poses_that_send\":%zu}\n",
      usual.poseUs(),
      first.line().c_str(),
      usual.line().c_str(),
      shared.line().c_str(),
      usual.idleUs.size() + usual.sending.size(),
      usual.sending.size());
  return 0;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(argc, argv);
}
