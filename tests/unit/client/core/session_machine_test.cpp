// SPDX-License-Identifier: Apache-2.0
#include "client/core/session_machine.h"

#include "client/core/connection.h"
#include "tests/unit/client/core/small_asset.h"

#include "protocol/framing.h"

#include "shared/codec/contour_codec.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <span>
#include <vector>

namespace limn {
namespace {

using Phase = SessionMachine::Phase;

const SmallAsset& ball() {
  static const SmallAsset asset = makeSmallAsset(primitives::bumpySphere(3, 1));
  return asset;
}

/// A machine with its time and the messages it has sent.
struct Bench {
  explicit Bench(StopCondition stop = {}, std::string model = "ball")
      : machine(options(stop, model)) {
    machine.start(now);
  }

  explicit Bench(const SessionMachine::Options& options) : machine(options) { machine.start(now); }

  static SessionMachine::Options options(StopCondition stop, const std::string& model) {
    SessionMachine::Options o;
    o.model = model;
    o.stop = stop;
    return o;
  }

  void say(const std::vector<std::uint8_t>& message) {
    machine.onMessage(
        message,
        message.size() + protocol::webSocketHeaderBytes(message.size()),
        now);
    collect();
  }

  void say(const protocol::Body& body) { say(protocol::encodeMessage(body)); }

  void collect() {
    for (auto& message : machine.takeOutbox())
      sent.push_back(std::move(message));
  }

  void open() {
    machine.onOpen(now);
    collect();
  }

  /// Up to and with ModelInfo.
  void openModel(const SmallAsset& asset) {
    open();
    say(protocol::Welcome{1, "server"});
    say(asset.info);
  }

  void start(const SmallAsset& asset) {
    openModel(asset);
    say(asset.base);
    for (const auto& block : asset.blocks)
      say(block);
  }

  void view(double x) {
    ClientView v;
    v.camera.eye = {x, 0.0, 5.0};
    machine.setView(v, now);
    collect();
  }

  void lose() { machine.onClosed({ErrorCode::kNetwork, "lost"}, now); }

  /// Waits out the backoff.
  void wait() {
    ASSERT_TRUE(machine.wakeAtMs());
    now = std::max(now, *machine.wakeAtMs());
    machine.onTimer(now);
    collect();
  }

  /// Decodes the last message of a type that was sent, and keeps it alive.
  template <class T>
  const T* last() {
    for (auto it = sent.rbegin(); it != sent.rend(); ++it) {
      auto message = protocol::decodeMessage(*it, protocol::Sender::kClient);
      EXPECT_TRUE(message);
      if (message->as<T>() == nullptr) continue;
      kept = std::move(*message);
      return kept.as<T>();
    }
    return nullptr;
  }

  template <class T>
  int count() {
    int n = 0;
    for (const auto& bytes : sent) {
      n += protocol::decodeMessage(bytes, protocol::Sender::kClient)->as<T>() != nullptr ? 1 : 0;
    }
    return n;
  }

  std::uint64_t now = 1000;
  SessionMachine machine;
  std::vector<std::vector<std::uint8_t>> sent;
  protocol::Message kept;
};

StopCondition untilState(MeshState state) {
  StopCondition stop;
  stop.state = state;
  return stop;
}

TEST(SessionMachine, GreetsOpensAndStreamsToTheEnd) {
  Bench bench(untilState(MeshState::kComplete));
  EXPECT_TRUE(bench.machine.wantsConnection());
  bench.open();
  ASSERT_NE(bench.last<protocol::Hello>(), nullptr);
  bench.say(protocol::Welcome{1, "server"});
  ASSERT_NE(bench.last<protocol::Open>(), nullptr);
  EXPECT_EQ(bench.last<protocol::Open>()->model, "ball");
  EXPECT_FALSE(bench.last<protocol::Open>()->resume);
  bench.say(ball().info);
  EXPECT_EQ(bench.machine.state(), MeshState::kNothing);
  bench.say(ball().base);
  EXPECT_EQ(bench.machine.state(), MeshState::kBase);
  for (const auto& block : ball().blocks)
    bench.say(block);
  EXPECT_EQ(bench.machine.state(), MeshState::kPartial);
  for (const auto& packet : ball().packets)
    bench.say(packet);
  EXPECT_EQ(bench.machine.phase(), Phase::kDone);
  EXPECT_EQ(bench.machine.state(), MeshState::kComplete);
  EXPECT_FALSE(bench.machine.wantsConnection());
  EXPECT_TRUE(isWhole(ball(), bench.machine.decoder().mesh()));
}

TEST(SessionMachine, AcknowledgesExactlyThePayloadItTook) {
  Bench bench(untilState(MeshState::kComplete));
  bench.start(ball());
  bench.machine.onIdle(bench.now);
  bench.collect();
  std::uint64_t payload = ball().base.size();
  for (const auto& block : ball().blocks)
    payload += block.size();
  ASSERT_NE(bench.last<protocol::Acknowledge>(), nullptr);
  EXPECT_EQ(bench.last<protocol::Acknowledge>()->bytes, payload);
  const int before = bench.count<protocol::Acknowledge>();
  bench.machine.onIdle(bench.now);
  bench.collect();
  EXPECT_EQ(bench.count<protocol::Acknowledge>(), before);
}

TEST(SessionMachine, StopsAtTheBaseMeshAndTakesNothingMore) {
  Bench bench(untilState(MeshState::kBase));
  bench.start(ball());
  EXPECT_EQ(bench.machine.phase(), Phase::kDone);
  EXPECT_EQ(bench.machine.state(), MeshState::kBase);
  EXPECT_EQ(bench.machine.decoder().mesh().splitsHeld(), 0U);
  EXPECT_EQ(bench.machine.bytes().levelBlocks, 0U);
}

TEST(SessionMachine, SettledCountsForTheNewestViewOnly) {
  Bench bench(untilState(MeshState::kSettled));
  bench.start(ball());
  bench.view(1.0);
  const std::uint32_t old = bench.last<protocol::Pose>()->id;
  bench.now += 1000;
  bench.view(2.0);
  const std::uint32_t newest = bench.last<protocol::Pose>()->id;
  ASSERT_NE(old, newest);
  bench.say(protocol::Settled{0, old, protocol::Goal::kSettled});
  EXPECT_EQ(bench.machine.phase(), Phase::kStreaming);
  bench.say(protocol::Settled{0, newest, protocol::Goal::kExact});
  EXPECT_EQ(bench.machine.phase(), Phase::kDone);
  EXPECT_EQ(bench.machine.state(), MeshState::kExact);
  EXPECT_TRUE(bench.machine.times().settledMs);
  EXPECT_TRUE(bench.machine.times().exactMs);
  EXPECT_FALSE(bench.machine.times().completeMs);
}

TEST(SessionMachine, AViewSetBeforeTheModelIsSentOnceItIsOpen) {
  Bench bench;
  bench.view(1.0);
  EXPECT_EQ(bench.count<protocol::Pose>(), 0);
  bench.openModel(ball());
  EXPECT_EQ(bench.count<protocol::Pose>(), 1);
}

TEST(SessionMachine, BytesMeansWhatHasWhollyArrivedWithinThem) {
  Bench whole(untilState(MeshState::kComplete));
  whole.start(ball());
  StopCondition stop;
  stop.kind = StopCondition::Kind::kBytes;
  stop.bytes = whole.machine.bytes().received + 10;
  Bench bench(stop);
  bench.start(ball());
  EXPECT_EQ(bench.machine.phase(), Phase::kStreaming);
  bench.say(ball().packets.front());
  EXPECT_EQ(bench.machine.phase(), Phase::kDone);
  EXPECT_LE(bench.machine.bytes().received, stop.bytes);
  EXPECT_EQ(bench.machine.bytes().packets, 0U);

  stop.bytes = 100;
  Bench tooFew(stop);
  tooFew.start(ball());
  EXPECT_EQ(tooFew.machine.phase(), Phase::kFailed);
}

TEST(SessionMachine, SecondsEndTheSessionWithWhatIsThere) {
  StopCondition stop;
  stop.kind = StopCondition::Kind::kSeconds;
  stop.seconds = 2.5;
  Bench bench(stop);
  bench.start(ball());
  ASSERT_TRUE(bench.machine.wakeAtMs());
  EXPECT_LE(*bench.machine.wakeAtMs(), 3500U);
  bench.now = 3499;
  bench.machine.onTimer(bench.now);
  EXPECT_EQ(bench.machine.phase(), Phase::kStreaming);
  bench.now = 3500;
  bench.machine.onTimer(bench.now);
  EXPECT_EQ(bench.machine.phase(), Phase::kDone);
}

TEST(SessionMachine, ResumesALostConnectionWithItsHaveSet) {
  Bench bench(untilState(MeshState::kComplete));
  bench.start(ball());
  bench.view(1.0);
  const std::uint32_t pose = bench.last<protocol::Pose>()->id;
  bench.say(ball().packets.front());
  const std::uint32_t held = bench.machine.decoder().mesh().splitsHeld();
  bench.lose();
  EXPECT_EQ(bench.machine.phase(), Phase::kWaiting);
  EXPECT_FALSE(bench.machine.wantsConnection());
  bench.sent.clear();
  bench.wait();
  EXPECT_TRUE(bench.machine.wantsConnection());
  EXPECT_EQ(bench.machine.connectionNumber(), 2U);
  bench.openModel(ball());
  EXPECT_TRUE(bench.last<protocol::Open>()->resume);
  ASSERT_NE(bench.last<protocol::HaveSet>(), nullptr);
  EXPECT_TRUE(bench.last<protocol::HaveSet>()->base);
  EXPECT_TRUE(bench.last<protocol::HaveSet>()->last);
  EXPECT_GT(bench.last<protocol::Pose>()->id, pose);
  EXPECT_EQ(bench.machine.decoder().mesh().splitsHeld(), held);
  for (std::size_t i = 1; i < ball().packets.size(); ++i)
    bench.say(ball().packets[i]);
  EXPECT_EQ(bench.machine.phase(), Phase::kDone);
  EXPECT_EQ(bench.machine.reconnects(), 1U);
  EXPECT_TRUE(isWhole(ball(), bench.machine.decoder().mesh()));
}

TEST(SessionMachine, AnotherAssetAfterALossStartsAfresh) {
  Bench bench(untilState(MeshState::kComplete));
  bench.start(ball());
  bench.lose();
  bench.wait();
  const SmallAsset other = makeSmallAsset(primitives::icosphere(3), 9);
  bench.openModel(other);
  const auto* have = bench.last<protocol::HaveSet>();
  ASSERT_NE(have, nullptr);
  EXPECT_FALSE(have->base);
  EXPECT_TRUE(have->bits.empty());
  EXPECT_EQ(have->asset, other.id);
  bench.say(other.base);
  for (const auto& block : other.blocks)
    bench.say(block);
  for (const auto& packet : other.packets)
    bench.say(packet);
  EXPECT_EQ(bench.machine.phase(), Phase::kDone);
  EXPECT_TRUE(isWhole(other, bench.machine.decoder().mesh()));
}

TEST(SessionMachine, StaleDropsEverythingAndOpensAfresh) {
  Bench bench(untilState(MeshState::kComplete));
  bench.start(ball());
  bench.lose();
  bench.wait();
  bench.openModel(ball());
  bench.sent.clear();
  bench.say(protocol::Failure{protocol::WireError::kStale, 0, "changed", 0});
  EXPECT_FALSE(bench.machine.decoder().hasModel());
  ASSERT_NE(bench.last<protocol::Open>(), nullptr);
  EXPECT_FALSE(bench.last<protocol::Open>()->resume);
  EXPECT_EQ(bench.machine.phase(), Phase::kOpening);
}

TEST(SessionMachine, AsksAgainForAModelThatIsNotReady) {
  Bench bench;
  bench.open();
  bench.say(protocol::Welcome{1, "server"});
  bench.say(protocol::Failure{protocol::WireError::kNotReady, 0, "preparing", 4000});
  EXPECT_EQ(bench.machine.notice(), "preparing");
  EXPECT_EQ(bench.count<protocol::Open>(), 1);
  bench.wait();
  EXPECT_EQ(bench.now, 5000U);
  EXPECT_EQ(bench.count<protocol::Open>(), 2);
}

TEST(SessionMachine, ADrainingServerIsLeftForAsLongAsItAsks) {
  Bench bench;
  bench.start(ball());
  bench.say(protocol::Failure{protocol::WireError::kDraining, -1, "bye", 3000});
  EXPECT_EQ(bench.machine.phase(), Phase::kWaiting);
  ASSERT_TRUE(bench.machine.wakeAtMs());
  EXPECT_GE(*bench.machine.wakeAtMs(), bench.now + 3000);
}

TEST(SessionMachine, GivesUpWhatCannotGetBetter) {
  using protocol::WireError;
  for (const WireError code :
       {WireError::kNotFound,
        WireError::kVersion,
        WireError::kLimit,
        WireError::kBadMessage,
        WireError::kState}) {
    Bench bench;
    bench.open();
    bench.say(protocol::Welcome{1, "server"});
    bench.say(protocol::Failure{code, -1, "no", 0});
    EXPECT_EQ(bench.machine.phase(), Phase::kFailed) << protocol::nameOf(code);
    ASSERT_TRUE(bench.machine.failure());
    EXPECT_EQ(bench.machine.failure()->message, "no");
    EXPECT_FALSE(bench.machine.wantsConnection());
  }
}

TEST(SessionMachine, AServerThatWasNeverThereFailsAtOnce) {
  Bench bench;
  bench.lose();
  EXPECT_EQ(bench.machine.phase(), Phase::kFailed);
}

TEST(SessionMachine, GivesUpALostServerAfterItsTime) {
  Bench bench;
  bench.start(ball());
  bench.lose();
  int tries = 0;
  while (bench.machine.phase() == Phase::kWaiting && tries < 1000) {
    bench.wait();
    ++tries;
    bench.lose();
  }
  EXPECT_EQ(bench.machine.phase(), Phase::kFailed);
  EXPECT_GT(tries, 5);
  EXPECT_LT(tries, 30);
  EXPECT_LE(bench.now, 1000U + 30'000U);
}

TEST(SessionMachine, ADamagedStreamIsTriedThreeTimes) {
  Bench bench(untilState(MeshState::kComplete));
  bench.start(ball());
  const std::vector<std::uint8_t> garbage(100, 0xAB);
  int losses = 0;
  while (bench.machine.phase() != Phase::kFailed && losses < 10) {
    bench.say(garbage);
    ++losses;
    if (bench.machine.phase() == Phase::kFailed) break;
    ASSERT_EQ(bench.machine.phase(), Phase::kWaiting);
    bench.wait();
    bench.openModel(ball());
  }
  EXPECT_EQ(losses, 3);
}

TEST(SessionMachine, SilenceIsALoss) {
  Bench bench;
  bench.start(ball());
  bench.view(1.0);
  bench.wait();  // nothing is said for the time that a server may be silent
  EXPECT_EQ(bench.machine.phase(), Phase::kWaiting);
  EXPECT_EQ(bench.now, 31'000U);
}

TEST(SessionMachine, WrongMessagesEndTheConnection) {
  const std::vector<std::vector<std::uint8_t>> wrong = {
      protocol::encodeMessage(protocol::Hello{1, "a client"}),
      protocol::encodeMessage(protocol::Welcome{1, "again"}),
      protocol::encodeMessage(protocol::Settled{7, 1, protocol::Goal::kExact}),
      ball().info,
      ball().base};
  for (const auto& message : wrong) {
    Bench bench;
    bench.start(ball());
    bench.say(message);
    EXPECT_EQ(bench.machine.phase(), Phase::kWaiting);
    EXPECT_TRUE(validate(bench.machine.decoder().mesh().mesh()));
  }
  Bench early;
  early.open();
  early.say(ball().base);
  EXPECT_EQ(early.machine.phase(), Phase::kWaiting);
}

TEST(SessionMachine, DoesNotBelieveACompleteThatIsNone) {
  Bench bench(untilState(MeshState::kComplete));
  bench.start(ball());
  bench.view(1.0);
  bench.say(protocol::Settled{
      0,
      bench.machine.decoder().hasModel() ? bench.last<protocol::Pose>()->id : 0U,
      protocol::Goal::kComplete});
  EXPECT_EQ(bench.machine.phase(), Phase::kWaiting);
}

TEST(SessionMachine, RefusesAVersionItDidNotOffer) {
  Bench bench;
  bench.open();
  bench.say(protocol::Welcome{2, "server"});
  EXPECT_EQ(bench.machine.phase(), Phase::kFailed);
}

SessionMachine::Options exactContours() {
  SessionMachine::Options options = Bench::options(untilState(MeshState::kBase), "ball");
  options.contours = SessionMachine::Options::Contours::kServer;
  options.stop.kind = StopCondition::Kind::kNever;
  return options;
}

std::vector<std::uint8_t> triangleContour() {
  ContourLines lines;
  lines.points = {{0, 0, 0}, {5, 0, 0}, {0, 5, 0}};
  lines.lines = {{0, 3, true}};
  return encodeContour(lines);
}

TEST(SessionMachine, AsksForOneContourAtATimeAndThenForTheNewestView) {
  Bench bench(exactContours());
  bench.start(ball());
  EXPECT_EQ(bench.count<protocol::GetContour>(), 0);
  bench.view(1.0);
  ASSERT_EQ(bench.count<protocol::GetContour>(), 1);
  EXPECT_EQ(bench.count<protocol::Pose>(), 0);
  const std::uint32_t first = bench.last<protocol::GetContour>()->id;
  bench.view(2.0);
  bench.view(3.0);
  EXPECT_EQ(bench.count<protocol::GetContour>(), 1);
  EXPECT_FALSE(bench.machine.hasReached(MeshState::kBase));
  const auto lines = triangleContour();
  bench.say(protocol::Contour{0, first, lines});
  ASSERT_EQ(bench.count<protocol::GetContour>(), 2);
  const auto* second = bench.last<protocol::GetContour>();
  EXPECT_DOUBLE_EQ(second->eye.x, 3.0);
  EXPECT_FALSE(bench.machine.hasReached(MeshState::kBase));
  bench.say(protocol::Contour{0, second->id, lines});
  EXPECT_TRUE(bench.machine.hasReached(MeshState::kBase));
  ASSERT_TRUE(bench.machine.decoder().contour());
  EXPECT_EQ(bench.machine.decoder().contour()->lines.points.size(), 3U);
  EXPECT_EQ(bench.machine.contours().answerMs.size(), 2U);
}

TEST(SessionMachine, AContourThatWasNotAskedForEndsTheConnection) {
  Bench bench(exactContours());
  bench.start(ball());
  bench.view(1.0);
  const auto lines = triangleContour();
  bench.say(protocol::Contour{0, bench.last<protocol::GetContour>()->id + 1, lines});
  EXPECT_EQ(bench.machine.phase(), Phase::kWaiting);
}

TEST(SessionMachine, AsksForTheContourAgainAfterALoss) {
  Bench bench(exactContours());
  bench.start(ball());
  bench.view(1.0);
  bench.lose();
  bench.wait();
  bench.openModel(ball());
  EXPECT_EQ(bench.count<protocol::GetContour>(), 2);
}

// ---- Hulls and maps

/// In memory.
class RememberedSections final : public SectionCache {
 public:
  std::vector<std::uint8_t> load(const protocol::SectionHash& hash) override {
    const auto found = kept.find(hash);
    return found == kept.end() ? std::vector<std::uint8_t>() : found->second;
  }

  void keep(const protocol::SectionHash& hash, std::span<const std::uint8_t> bytes) override {
    kept[hash].assign(bytes.begin(), bytes.end());
  }

  std::map<protocol::SectionHash, std::vector<std::uint8_t>> kept;
};

/// The ball's description, as if it had hulls and a map of so many bytes over 500 faces.
std::vector<std::uint8_t> infoWithMap(const std::vector<std::uint8_t>& png) {
  auto message = protocol::decodeMessage(ball().info, protocol::Sender::kServer);
  auto info = *message->as<protocol::ModelInfo>();
  info.hull = protocol::HullInfo{2, 200, 5000, 200, 5000, {}};
  info.maps = protocol::MapInfo{500, 4, static_cast<std::uint32_t>(png.size()), 0};
  info.maps->normalHash = protocol::sectionHash(png);
  return protocol::encodeMessage(info);
}

TEST(SessionMachine, AViewThatWantsAHullAsksForItAndItsMapOnce) {
  const std::vector<std::uint8_t> png(300, 7);
  StopCondition never;
  never.kind = StopCondition::Kind::kNever;
  Bench bench(never);
  bench.open();
  bench.say(protocol::Welcome{1, "server"});
  bench.say(infoWithMap(png));
  bench.view(0.0);
  EXPECT_EQ(bench.count<protocol::GetHull>(), 0);
  ClientView view;
  view.camera.eye = {1.0, 0.0, 5.0};
  for (const std::uint32_t faces : {500U, 500U, 700U}) {
    view.hullFaces = faces;
    bench.machine.setView(view, bench.now);
    bench.collect();
  }
  // More is asked for once the first has come, of which it is not yet known how much that is.
  EXPECT_EQ(bench.count<protocol::GetHull>(), 1);
  EXPECT_EQ(bench.last<protocol::GetHull>()->faces, 500U);
  EXPECT_EQ(bench.count<protocol::GetMap>(), 1);
  EXPECT_EQ(bench.machine.phase(), Phase::kStreaming);
}

TEST(SessionMachine, AModelPreparedAgainWithoutHullsGoesOnWhereTheyAreNotNeeded) {
  using Hulls = StreamOptions::Hulls;
  auto message = protocol::decodeMessage(ball().info, protocol::Sender::kServer);
  auto info = *message->as<protocol::ModelInfo>();
  info.name = "ball";
  info.asset[0] ^= 1;
  info.hull = protocol::HullInfo{};
  info.hull->reason = "the mesh is open";
  const auto without = protocol::encodeMessage(info);
  for (const Hulls hulls : {Hulls::kWanted, Hulls::kNeeded}) {
    SessionMachine::Options options = Bench::options({}, "ball");
    options.hulls = hulls;
    Bench bench(options);
    bench.open();
    bench.say(protocol::Welcome{1, "server"});
    bench.say(infoWithMap(std::vector<std::uint8_t>(300, 7)));
    ClientView view;
    view.hullFaces = 500;
    bench.machine.setView(view, bench.now);
    bench.collect();
    EXPECT_EQ(bench.count<protocol::GetHull>(), 1);
    bench.say(protocol::Failure{protocol::WireError::kStale, 0, "prepared again", 0});
    bench.say(without);
    EXPECT_EQ(bench.count<protocol::GetHull>(), 1);
    if (hulls == Hulls::kNeeded) {
      ASSERT_EQ(bench.machine.phase(), Phase::kFailed);
      EXPECT_EQ(bench.machine.failure()->message, "'ball' has no hull, because the mesh is open");
      continue;
    }
    ASSERT_EQ(bench.machine.phase(), Phase::kStreaming);
    bench.say(ball().base);
    EXPECT_TRUE(bench.machine.hasReached(MeshState::kBase));
    view.hullFaces = 700;
    bench.machine.setView(view, bench.now);
    EXPECT_EQ(bench.machine.phase(), Phase::kStreaming);
  }
}

TEST(SessionMachine, AMapThatTheCacheHasIsNotAskedForAndADamagedOneIs) {
  const std::vector<std::uint8_t> png(300, 7);
  const auto cache = std::make_shared<RememberedSections>();
  const auto begin = [&] {
    SessionMachine::Options options = Bench::options({}, "ball");
    options.outerHullFaces = 500;
    options.maps = SessionMachine::Options::Maps::kWanted;
    options.cache = cache;
    auto bench = std::make_unique<Bench>(options);
    bench->open();
    bench->say(protocol::Welcome{1, "server"});
    bench->say(infoWithMap(png));
    return bench;
  };
  const auto first = begin();
  EXPECT_EQ(first->count<protocol::GetMap>(), 1);
  first->say(protocol::Map{0, protocol::MapKind::kNormals, 0, std::span(png).first(200)});
  EXPECT_TRUE(cache->kept.empty());
  first->say(protocol::Map{0, protocol::MapKind::kNormals, 1, std::span(png).subspan(200)});
  ASSERT_EQ(cache->kept.size(), 1U);
  EXPECT_EQ(cache->kept.begin()->second, png);

  const auto second = begin();
  EXPECT_EQ(second->count<protocol::GetMap>(), 0);
  ASSERT_TRUE(second->machine.decoder().maps().map(protocol::MapKind::kNormals));
  EXPECT_EQ(second->machine.decoder().maps().map(protocol::MapKind::kNormals)->png, png);

  cache->kept.begin()->second[5] ^= 1;
  const auto third = begin();
  EXPECT_EQ(third->count<protocol::GetMap>(), 1);
  third->say(protocol::Map{0, protocol::MapKind::kNormals, 0, png});
  EXPECT_EQ(cache->kept.begin()->second, png);
}

}  // namespace
}  // namespace limn
