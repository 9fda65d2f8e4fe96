// SPDX-License-Identifier: Apache-2.0
//
// Delivery over a connection's whole life: room, seeds, several models, slow links.
#include "tests/property/mutate.h"
#include "tests/unit/server/session/session_link.h"

#include "shared/codec/seed_codec.h"
#include "shared/core/rng.h"

#include <array>
#include <cmath>
#include <deque>

namespace limn {
namespace {

using protocol::Goal;
using protocol::WireError;

/// A model with seeds, too many for one piece.
const std::shared_ptr<const Model>& seeded() {
  static const auto model = [] {
    const BuiltForest built = builtForestOf(primitives::bumpySphere(4, 5), 60);
    SeedTable seeds;
    for (VertexId v = 0; v < built.forest.baseVertexCount(); ++v)
      seeds.nodes.push_back({v, kNone});
    seeds.seedBegin.push_back(0);
    for (int i = 0; i < 40; ++i) {
      seeds.directions.push_back(glm::normalize(glm::vec3(std::sin(i), std::cos(i), 0.3F)));
      for (std::uint32_t k = 0; k < 200; ++k)
        seeds.seeds.push_back(k % static_cast<std::uint32_t>(seeds.nodes.size()));
      seeds.seedBegin.push_back(static_cast<std::uint32_t>(seeds.seeds.size()));
    }
    Sha256Digest id{};
    id.fill(3);
    const WireSections wire = encodeWireSections(built, seeds, {id, true});
    auto loaded = Model::load(std::make_shared<MemoryAsset>(
        id,
        std::map<std::string, std::vector<std::uint8_t>, std::less<>>{
            {sections::kInfo, wire.info},
            {sections::kBase, wire.base},
            {sections::kBlocks, wire.blocks},
            {sections::kPackets, wire.packets},
            {sections::kSeeds, wire.seeds},
            {sections::kForest, serializeForest(built.forest)}}));
    EXPECT_TRUE(loaded) << loaded.error().message;
    return *loaded;
  }();
  return model;
}

/// The messages of a connection in order, by name.
std::vector<std::string> namesOf(Link& link) {
  std::vector<std::string> names;
  for (int quiet = 0; quiet < 2;) {
    const std::size_t worked = link.tasks_.runAll();
    link.session_.update(link.now_);
    std::size_t taken = 0;
    while (auto out = link.session_.nextMessage(link.now_)) {
      const auto message = protocol::decodeMessage(out->bytes(), protocol::Sender::kServer);
      names.emplace_back(protocol::nameOf(message->body));
      if (out->payload) link.payload_ += out->bytes().size();
      link.note(*message);
      ++taken;
    }
    link.acknowledge();
    quiet = worked + taken == 0 ? quiet + 1 : 0;
  }
  return names;
}

TEST(Delivery, SeedsComeInPiecesAfterThePicture) {
  Link link;
  link.models_.add("seeded", seeded());
  link.hello();
  link.open("seeded");
  EXPECT_EQ(std::ranges::count(namesOf(link), "Seeds"), 0) << "nobody looks yet";
  link.look({1, 0, 0}, Goal::kSettled);
  const auto names = namesOf(link);
  const auto count = std::ranges::count(names, "Seeds");
  EXPECT_GE(count, 2);
  const auto seeds = std::ranges::find(names, "Seeds");
  EXPECT_LT(std::ranges::find(names, "Packet"), seeds);
  EXPECT_LT(std::ranges::find(names, "Settled"), seeds);
  ASSERT_TRUE(link.decoder().seeds());
  EXPECT_TRUE(link.decoder().seedsAreThere());
  EXPECT_EQ(encodeSeeds(*link.decoder().seeds()).size(), seeded()->seeds().size());
}

TEST(Delivery, AResumedClientGetsTheRestOfTheSeeds) {
  Link first;
  first.models_.add("seeded", seeded());
  first.hello();
  first.open("seeded");
  first.look({1, 0, 0}, Goal::kSettled);
  namesOf(first);
  const std::uint32_t all = static_cast<std::uint32_t>(seeded()->seeds().size());
  const std::uint32_t vertices = seeded()->forest().vertexCount();
  std::vector<std::uint8_t> bits((vertices + 7) / 8, 0);
  for (const VertexId v : first.decoder().mesh().ids())
    bits[v / 8] = static_cast<std::uint8_t>(bits[v / 8] | 1U << (v % 8));
  for (const std::uint32_t held : {all, all - 100, 0U}) {
    Link second;
    second.models_.add("seeded", seeded());
    second.hello();
    second.open("seeded", 0, true);
    second.send(protocol::HaveSet{0, seeded()->id(), true, 0, bits, true, held});
    second.look({1, 0, 0}, Goal::kSettled);
    std::uint64_t seedBytes = 0;
    std::uint64_t otherPayload = 0;
    for (int i = 0; i < 4; ++i) {
      second.tasks_.runAll();
      second.session_.update(0);
      while (auto out = second.session_.nextMessage(0)) {
        const auto message = protocol::decodeMessage(out->bytes(), protocol::Sender::kServer);
        if (const auto* piece = message->as<protocol::Seeds>()) {
          EXPECT_EQ(piece->offset, held + seedBytes);
          EXPECT_EQ(piece->total, all);
          seedBytes += piece->seeds.size();
        } else if (out->payload) {
          otherPayload += out->bytes().size();
        }
      }
    }
    EXPECT_EQ(seedBytes, all - held);
    EXPECT_EQ(otherPayload, 0U) << "everything else it has";
  }
  Link liar;
  liar.models_.add("seeded", seeded());
  liar.hello();
  liar.open("seeded", 0, true);
  liar.send(protocol::HaveSet{0, seeded()->id(), true, 0, bits, true, all + 1});
  liar.take();
  EXPECT_EQ(liar.failures_, std::vector{WireError::kHaveSet});
}

/// Splits of a channel's decoder, ascending.
std::vector<VertexId> splitsOf(const ActiveMesh& mesh) {
  std::vector<VertexId> ids;
  for (const VertexId v : mesh.ids()) {
    if (v >= mesh.baseVertexCount()) ids.push_back(v);
  }
  std::ranges::sort(ids);
  return ids;
}

/// Asks to drop `ids` and undoes what was dropped. Returns how many that were.
std::size_t dropAll(Link& link, const std::vector<VertexId>& ids) {
  link.kept_.reset();
  link.send(protocol::Drop{0, encodeIdSet(ids)});
  // Up to the answer: what comes after it builds on what is left.
  while (!link.kept_) {
    const auto out = link.session_.nextMessage(link.now_);
    if (!out) break;
    if (out->payload) link.payload_ += out->bytes().size();
    link.note(*protocol::decodeMessage(out->bytes(), protocol::Sender::kServer));
  }
  EXPECT_TRUE(link.kept_);
  if (!link.kept_) return 0;
  std::vector<VertexId> gone;
  std::ranges::set_difference(ids, *link.kept_, std::back_inserter(gone));
  const auto undone = link.decoder().undo(gone);
  EXPECT_TRUE(undone) << undone.error().message;
  return gone.size();
}

TEST(Delivery, ADropTakesWhatNothingElseIsBuiltOn) {
  Link link;
  link.hello();
  link.open("bumpy");
  Rng rng(8);
  std::uint32_t kept = 0;
  std::uint32_t gone = 0;
  for (int round = 0; round < 12; ++round) {
    link.look({std::sin(round), 0.2, std::cos(round)}, Goal::kSettled);
    link.settle();
    std::vector<VertexId> ids;
    for (const VertexId v : splitsOf(link.decoder().mesh())) {
      if (rng.below(3) == 0) ids.push_back(v);
    }
    gone += static_cast<std::uint32_t>(dropAll(link, ids));
    kept += static_cast<std::uint32_t>(link.kept_->size());
    ASSERT_TRUE(validate(link.decoder().mesh().mesh()));
  }
  EXPECT_GT(gone, 100U);
  EXPECT_GT(kept, 100U);
  link.look({0, 0, 1}, Goal::kComplete);
  link.settle();
  EXPECT_TRUE(link.decoder().complete());
  EXPECT_TRUE(link.failures_.empty());
}

TEST(Delivery, NothingIsSentThatThereIsNoRoomFor) {
  Link link;
  link.hello();
  link.open("bumpy");
  link.settle();
  const SplitForest& forest = bumpy()->forest();
  const std::uint32_t room = forest.splitCount() / 2;
  protocol::Pose pose = poseAt(bumpy()->info(), {1, 2, 3});
  pose.id = 1;
  pose.goal = Goal::kComplete;
  pose.maxSplits = room;
  link.send(pose);
  link.settle(3000);
  EXPECT_EQ(link.decoder().mesh().splitsHeld(), room);
  ASSERT_EQ(link.full_.size(), 1U) << "said once";
  EXPECT_EQ(link.full_[0].second, forest.splitCount() - room);
  EXPECT_TRUE(link.settled_.empty());
  // The finest hundred go, others come in their place: a hundred, and it is full again.
  auto ids = splitsOf(link.decoder().mesh());
  ids.erase(ids.begin(), ids.end() - 100);
  EXPECT_EQ(dropAll(link, ids), 100U);
  link.settle();
  EXPECT_EQ(link.decoder().mesh().splitsHeld(), room);
  EXPECT_EQ(link.full_.size(), 2U);
  // With room for everything it goes on to the end.
  pose.id = 2;
  pose.maxSplits = 0;
  link.send(pose);
  link.settle();
  EXPECT_TRUE(link.decoder().complete());
}

TEST(Delivery, AClientWithLittleRoomGetsNothingItDoesNotNeed) {
  Link link;
  link.hello();
  link.open("bumpy");
  protocol::Pose pose = poseAt(bumpy()->info(), {1, 2, 3});
  pose.id = 1;
  pose.maxSplits = bumpy()->forest().splitCount();
  link.send(pose);
  link.settle(10'000);
  EXPECT_FALSE(link.decoder().complete());
  EXPECT_EQ(link.settled_, (std::vector<std::pair<std::uint32_t, Goal>>{{1, Goal::kSettled}}));
}

/// Ids of the channels that payload is sent on, in order.
std::vector<std::pair<int, std::string>> orderOf(Link& link, std::size_t most) {
  std::vector<std::pair<int, std::string>> order;
  for (int i = 0; i < 6; ++i) {
    link.tasks_.runAll();
    link.session_.update(link.now_);
    while (order.size() < most) {
      const auto out = link.session_.nextMessage(link.now_);
      if (!out) break;
      const auto message = protocol::decodeMessage(out->bytes(), protocol::Sender::kServer);
      if (!out->payload) continue;
      link.payload_ += out->bytes().size();
      order.emplace_back(
          *protocol::channelOf(message->body),
          std::string(protocol::nameOf(message->body)));
    }
    link.acknowledge();
  }
  return order;
}

TEST(Delivery, AModelOutOfViewWaitsForThoseInView) {
  Link link;
  link.hello();
  link.open("torus", 1);
  link.open("bumpy", 2);
  // The first looks away from its model.
  protocol::Pose away = poseAt(torus()->info(), {0, 0, 1});
  away.forward = -away.forward;
  away.channel = 1;
  away.id = 1;
  link.send(away);
  protocol::Pose at = poseAt(bumpy()->info(), {0, 0, 1});
  at.channel = 2;
  at.id = 1;
  link.send(at);
  const auto order = orderOf(link, 1000);
  const auto first = std::ranges::find(order, 1, [](const auto& m) { return m.first; });
  ASSERT_NE(first, order.end()) << "it comes in the end";
  const auto packets = std::pair<int, std::string>(2, "Packet");
  EXPECT_LT(std::ranges::find(order, packets), first);
  for (auto later = first; later != order.end(); ++later)
    EXPECT_NE(*later, packets) << "all the picture needs came before";
}

TEST(Delivery, ModelsInViewShareTheConnection) {
  SessionOptions options;
  options.packetBytes = 512;
  Link link(options);
  link.models_.add("again", modelOf(primitives::bumpySphere(4, 3), 4));
  link.hello();
  link.open("bumpy", 1);
  link.open("again", 2);
  for (const std::uint8_t channel : {1, 2}) {
    protocol::Pose pose = poseAt(bumpy()->info(), {0, 0, 1});
    pose.channel = channel;
    pose.id = 1;
    pose.goal = Goal::kComplete;
    link.send(pose);
  }
  int lead = 0;
  int farthest = 0;
  for (const auto& [channel, name] : orderOf(link, 30)) {
    lead += channel == 1 ? 1 : -1;
    farthest = std::max(farthest, std::abs(lead));
  }
  EXPECT_LE(farthest, 2) << "no channel gets far ahead of its equal";
}

// Damaged messages of a client are refused, and what the server sends stays decodable by whoever
// keeps to the rules on the other channel.
TEST(Delivery, DamagedMessagesHurtNobodyElse) {
  Rng rng(12);
  const int rounds = mutationRounds(600);
  std::optional<Link> link;
  int closed = 0;
  for (int round = 0; round < rounds; ++round) {
    if (!link || link->session_.close()) {
      closed += link ? 1 : 0;
      link.emplace();
      link->hello();
      link->open("torus", 1);
    }
    const std::vector<VertexId> ids{bumpy()->forest().vertexCount() - 1};
    const auto idBytes = encodeIdSet(ids);
    const std::vector<std::uint8_t> bits(64, 0xFF);
    protocol::Pose pose = poseAt(bumpy()->info(), {0, 0, 1});
    pose.id = static_cast<std::uint32_t>(round);
    pose.maxSplits = 100;
    const std::array<protocol::Body, 6> bodies{
        protocol::Open{0, "bumpy", round % 2 == 0},
        protocol::HaveSet{0, bumpy()->id(), true, 0, bits, true, 0},
        pose,
        protocol::Acknowledge{link->payload_},
        protocol::Drop{0, idBytes},
        protocol::GetCatalogue{}};
    const auto& body = bodies[rng.below(static_cast<std::uint32_t>(bodies.size()))];
    auto bytes = protocol::encodeMessage(body);
    if (rng.below(3) != 0) bytes = mutated(std::move(bytes), rng);
    link->session_.receive(bytes, link->now_);
    link->tasks_.runAll();
    link->session_.update(link->now_ += 20);
    while (auto out = link->session_.nextMessage(link->now_)) {
      const auto message = protocol::decodeMessage(out->bytes(), protocol::Sender::kServer);
      ASSERT_TRUE(message) << message.error().message;
      if (out->payload) link->payload_ += out->bytes().size();
      // A client that lies about what it holds cannot decode what comes; the other channel can.
      if (protocol::channelOf(message->body) == 1) link->note(*message);
    }
    if (!link->session_.close()) link->acknowledge();
  }
  EXPECT_GT(closed, 0);
}

/// A session at the other end of a slow link, in simulated time: what is sent arrives in order, at
/// so many bytes a millisecond and after a delay, is decoded and acknowledged.
class SlowLink {
 public:
  SlowLink(Link& link, double bytesAMs, std::int64_t oneWayMs)
      : link_(link),
        bytesAMs_(bytesAMs),
        oneWayMs_(oneWayMs) {}

  void pass(std::int64_t ms) {
    for (const std::int64_t until = link_.now_ + ms; link_.now_ < until; ++link_.now_) {
      const std::int64_t now = link_.now_;
      while (!up_.empty() && up_.front().first <= now) {
        link_.session_.receive(up_.front().second, now);
        up_.pop_front();
      }
      if (now % 50 == 0 || link_.tasks_.runAll() > 0) link_.session_.update(now);
      while (auto out = link_.session_.nextMessage(now)) {
        const auto bytes = out->bytes();
        freeAtMs_ = std::max(freeAtMs_, static_cast<double>(now)) +
                    static_cast<double>(bytes.size()) / bytesAMs_;
        down_.push_back(
            {static_cast<std::int64_t>(freeAtMs_) + oneWayMs_,
             {bytes.begin(), bytes.end()},
             out->payload});
      }
      while (!down_.empty() && down_.front().atMs <= now) {
        const auto& arrived = down_.front();
        const auto message = protocol::decodeMessage(arrived.bytes, protocol::Sender::kServer);
        ASSERT_TRUE(message);
        if (const auto* packet = message->as<protocol::Packet>()) newestPose_ = packet->pose;
        if (const auto* settled = message->as<protocol::Settled>()) newestPose_ = settled->pose;
        link_.note(*message);
        if (arrived.isPayload) {
          link_.payload_ += arrived.bytes.size();
          send(protocol::Acknowledge{link_.payload_});
        }
        down_.pop_front();
      }
    }
  }

  void send(const protocol::Body& body) {
    up_.emplace_back(link_.now_ + oneWayMs_, protocol::encodeMessage(body));
  }

  /// The pose that the last packet (or Settled) to arrive was for.
  [[nodiscard]] std::uint32_t newestPose() const { return newestPose_; }

 private:
  struct Arrival {
    std::int64_t atMs;
    std::vector<std::uint8_t> bytes;
    bool isPayload;
  };

  Link& link_;
  double bytesAMs_;
  std::int64_t oneWayMs_;
  double freeAtMs_ = 0.0;
  std::deque<Arrival> down_;
  std::deque<std::pair<std::int64_t, std::vector<std::uint8_t>>> up_;
  std::uint32_t newestPose_ = 0;
};

protocol::Pose orbitPose(const Model& model, double degrees, std::uint32_t id) {
  const double angle = degrees * std::acos(-1.0) / 180.0;
  protocol::Pose pose = poseAt(model.info(), {std::sin(angle), 0.35, std::cos(angle)});
  pose.id = id;
  pose.width = pose.height = 1024;
  return pose;
}

/// Circles a model at 15 degrees a second over a slow link. Returns what share of the poses lacked
/// something when they were shown that their error bound needs (`most`: more than so many splits).
double stallsOnAnOrbit(std::int64_t aheadMs, std::uint32_t most) {
  static const auto model = modelOf(primitives::bumpySphere(5, 9), 9, 200);
  SessionOptions options;
  options.aheadMs = aheadMs;
  options.prefetchAfterMs = -1;
  Link link(options);
  link.models_.add("large", model);
  link.hello();
  link.open("large");
  SlowLink slow(link, 8.0, 60);  // 64 kbit/s
  const SplitForest& forest = model->forest();
  slow.send(orbitPose(*model, 0.0, 1));
  slow.pass(8000);
  int stalls = 0;
  constexpr int kPoses = 60;
  for (int i = 0; i < kPoses; ++i) {
    const auto pose = orbitPose(*model, 1.5 * i, static_cast<std::uint32_t>(i + 2));
    slow.send(pose);
    slow.pass(100);
    const TargetSet target =
        selectForView(forest, viewOfPose(pose, forest.grid), model->smoothCones());
    HaveSet have(forest.vertexCount());
    for (const VertexId v : link.decoder().mesh().ids())
      have.add(v);
    stalls += missingOf(target, have) > most ? 1 : 0;
  }
  return static_cast<double>(stalls) / kPoses;
}

TEST(Delivery, FollowingTheMotionAheadLeavesFewerStalls) {
  const double without = stallsOnAnOrbit(0, 20);
  const double with = stallsOnAnOrbit(SessionOptions{}.aheadMs, 20);
  RecordProperty("stalls_without", std::to_string(without));
  RecordProperty("stalls_with", std::to_string(with));
  EXPECT_GT(without, 0.2) << "the link must be slow enough to matter";
  EXPECT_LT(with, 0.7 * without);
}

TEST(Delivery, WhatLiesAheadIsSentWithThePoseNotWithATick) {
  static const auto model = modelOf(primitives::bumpySphere(5, 9), 9, 200);
  SessionOptions options;
  options.prefetchAfterMs = -1;
  Link link(options);
  link.models_.add("large", model);
  for (double degrees = 0.0; degrees < 60.0; degrees += 0.5) {
    static_cast<void>(
        link.cells_.cell(model, viewCellOf(orbitPose(*model, degrees, 1), model->info())));
    link.tasks_.runAll();
  }
  link.hello();
  link.open("large");
  int withPose = 0;
  for (int i = 0; i < 20; ++i) {
    link.now_ += 100;
    link.send(orbitPose(*model, 1.5 * i, static_cast<std::uint32_t>(i + 1)));
    link.tasks_.runAll();
    if (i == 0) link.session_.update(link.now_);  // its own set has come
    int got = 0;
    while (const int some = link.take()) {
      got += some;
      link.acknowledge();
    }
    withPose += i > 0 ? got : 0;
    link.session_.update(link.now_);
    EXPECT_EQ(link.take(), 0) << "pose " << i;
  }
  EXPECT_GT(withPose, 3);
}

// A second turn, of which everything is held: what a pose costs then is what a thousand cost.
TEST(Delivery, AWayThatIsHeldIsNotAskedForAgain) {
  SessionOptions options;
  options.prefetchAfterMs = -1;
  Link link(options);
  link.hello();
  link.open("bumpy");
  std::uint32_t id = 0;
  const auto turn = [&](double from) {
    std::size_t got = 0;
    for (double degrees = from; degrees < from + 360.0; degrees += 1.5) {
      link.now_ += 100;
      link.send(orbitPose(*bumpy(), degrees, ++id));
      for (bool again = true; again; link.acknowledge()) {
        again = link.tasks_.runAll() > 0;
        link.session_.update(link.now_);
        const int taken = link.take();
        again = again || taken > 0;
        got += static_cast<std::size_t>(taken);
      }
    }
    return got;
  };
  EXPECT_GT(turn(0.0), 20U);
  const std::uint64_t before = link.cells_.hits();
  EXPECT_EQ(turn(360.0), 0U);
  // 64 cells on the way, each looked up when it comes into sight and when it is entered.
  EXPECT_LT(link.cells_.hits() - before, 200U) << "of 240 poses";
}

// Over 1 Mbit/s a new pose's packets come within a round trip and the queue that the window allows.
TEST(Delivery, ANewPoseTakesEffectWithinAWindowOnASlowLink) {
  Link link;
  link.hello();
  link.open("bumpy");
  SlowLink slow(link, 125.0, 40);
  std::int64_t worst = 0;
  for (std::uint32_t id = 1; id <= 8; ++id) {
    const double angle = 0.7 * id;
    protocol::Pose pose = poseAt(bumpy()->info(), {std::sin(angle), 0.2, std::cos(angle)});
    pose.id = id;
    pose.errorPx = 0.5F;
    pose.width = pose.height = 1024;
    slow.send(pose);
    std::int64_t waited = 0;
    for (; slow.newestPose() != id && waited < 5000; ++waited)
      slow.pass(1);
    worst = std::max(worst, waited);
    slow.pass(std::max<std::int64_t>(100 - waited, 0));
  }
  const auto options = WindowOptions{};
  EXPECT_LE(worst, 2 * 40 + 50 + static_cast<std::int64_t>(options.firstBytes) / 125);
}

}  // namespace
}  // namespace limn
