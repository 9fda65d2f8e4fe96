// SPDX-License-Identifier: Apache-2.0
#include "server/session/contour_search.h"
#include "server/session/exact_set.h"
#include "tests/unit/server/session/session_link.h"

#include <optional>

namespace limn {
namespace {

using protocol::Goal;
using protocol::WireError;

using SettledList = std::vector<std::pair<std::uint32_t, Goal>>;

TEST(Session, RefusesEverythingBeforeHello) {
  Link link;
  link.send(protocol::GetCatalogue{});
  link.take();
  EXPECT_EQ(link.failures_, std::vector{WireError::kState});
  EXPECT_EQ(link.session_.close(), Session::Close::kProtocolError);
}

TEST(Session, ClosesOnBytesThatAreNoMessage) {
  Link link;
  link.hello();
  link.session_.receive(std::vector<std::uint8_t>{1, 2, 3, 4}, 0);
  link.take();
  EXPECT_EQ(link.failures_, std::vector{WireError::kBadMessage});
  EXPECT_TRUE(link.session_.close());
  link.open("bumpy");
  EXPECT_EQ(link.take(), 0) << "nothing is served after that";
}

TEST(Session, ClosesOnAMessageOverTheLimit) {
  Link link;
  link.hello();
  link.session_.receive(std::vector<std::uint8_t>(limits::kMaxClientMessageBytes + 1), 0);
  link.take();
  EXPECT_EQ(link.failures_, std::vector{WireError::kLimit});
}

TEST(Session, AnswersForTheCatalogueOnceHoweverOftenAskedBeforeReading) {
  Link link;
  link.hello();
  for (int i = 0; i < 100; ++i)
    link.send(protocol::GetCatalogue{});
  link.take();
  EXPECT_EQ(link.catalogueSizes_, std::vector<std::size_t>{2});
}

TEST(Session, AnErrorOnAChannelLeavesTheOthersOpen) {
  Link link;
  link.hello();
  link.open("bumpy", 0);
  link.open("nothing", 1);
  link.open("torus", 0);
  link.settle();
  EXPECT_EQ(link.failures_, (std::vector{WireError::kNotFound, WireError::kState}));
  EXPECT_EQ(link.failureChannels_, (std::vector{1, 0}));
  EXPECT_FALSE(link.session_.close());
  link.open("torus", 3);
  link.settle();
  EXPECT_TRUE(link.decoder(3).hasBase());
}

TEST(Session, AModelBeingPreparedIsNotReady) {
  Link link;
  link.models_.set("soon", {ModelSource::Availability::kNotReady, nullptr, 0, ""});
  link.hello();
  link.open("soon");
  link.take();
  EXPECT_EQ(link.failures_, std::vector{WireError::kNotReady});
}

TEST(Session, AModelBeingLoadedIsServedOnceItIsThere) {
  Link link;
  const std::uint32_t vertices = bumpy()->forest().vertexCount();
  link.models_.set("late", {ModelSource::Availability::kLoading, nullptr, vertices, ""});
  link.hello();
  link.open("late");
  link.look({0, 0, 1}, Goal::kSettled);
  link.settle();
  EXPECT_TRUE(link.names_.empty());
  link.models_.set("late", {ModelSource::Availability::kReady, bumpy(), vertices, ""});
  link.wants_ = 0;
  link.session_.update(100);
  EXPECT_GT(link.wants_, 0);
  link.settle();
  EXPECT_EQ(link.names_, std::vector<std::string>{"late"}) << "under the name it was opened by";
  EXPECT_EQ(link.settled_, (SettledList{{1, Goal::kSettled}}));
}

TEST(Session, WithoutAPoseOnlyTheStartIsSent) {
  Link link;
  link.hello();
  link.open("bumpy");
  link.settle(5000);
  EXPECT_TRUE(link.decoder().hasBase());
  EXPECT_EQ(
      link.decoder().mesh().splitsHeld() + bumpy()->forest().baseVertexCount(),
      bumpy()->forest().levelBegin[1 + bumpy()->blocks().size()]);
  EXPECT_TRUE(link.settled_.empty());
}

TEST(Session, SettlesThenStopsUntilThePoseHasRested) {
  Link link;
  link.hello();
  link.open("bumpy");
  link.look({1, 2, 3}, Goal::kSettled);
  link.settle();
  ASSERT_EQ(link.settled_, (SettledList{{1, Goal::kSettled}}));
  const std::uint32_t held = link.decoder().mesh().splitsHeld();
  EXPECT_LT(held, bumpy()->forest().splitCount());
  EXPECT_EQ(link.heldWhenSettled_[0], held) << "not a byte between settled and the rest";
  link.settle(900);
  EXPECT_EQ(link.decoder().mesh().splitsHeld(), held);
  link.settle(1000);
  EXPECT_TRUE(link.decoder().complete()) << "prefetched";
  EXPECT_EQ(link.settled_, (SettledList{{1, Goal::kSettled}, {1, Goal::kComplete}}));
}

/// A thousand splits a second, of all clients.
SessionOptions slowlyPrefetching() {
  SessionOptions options;
  options.prefetchSplitsPerSecond = 1000.0;
  return options;
}

TEST(Session, PrefetchingIsPacedOverAllClients) {
  Link link(slowlyPrefetching());
  Session second(link.shared_, link, 0);
  std::uint64_t payload = 0;
  bool isComplete = false;
  const auto tell = [&](const protocol::Body& body) {
    second.receive(protocol::encodeMessage(body), link.now_);
  };
  const auto step = [&] {
    link.settle();
    second.update(link.now_);
    while (const auto out = second.nextMessage(link.now_)) {
      if (out->payload) payload += out->bytes().size();
      const auto message = protocol::decodeMessage(out->bytes(), protocol::Sender::kServer);
      const auto* settled = message ? message->as<protocol::Settled>() : nullptr;
      isComplete = isComplete || (settled != nullptr && settled->state == Goal::kComplete);
      tell(protocol::Acknowledge{payload});
    }
  };
  link.hello();
  link.open("bumpy");
  tell(protocol::Hello{1, "test"});
  tell(protocol::Open{0, "bumpy", false});
  // Views of no other test: what was sent once is not paced.
  link.look({1.3, -2.1, 0.7}, Goal::kSettled);
  protocol::Pose pose = poseAt(bumpy()->info(), {-3.2, 1.1, 2});
  pose.id = 1;
  tell(pose);
  for (int i = 0; i < 3; ++i)
    step();
  const std::uint32_t lacking = bumpy()->forest().splitCount() - link.decoder().mesh().splitsHeld();
  link.now_ += SessionOptions{}.prefetchAfterMs;
  const std::int64_t begunMs = link.now_;
  step();
  EXPECT_TRUE(link.decoder().complete()) << "the first to ask";
  EXPECT_FALSE(isComplete) << "waits for its turn";
  while (!isComplete && link.now_ < begunMs + 60'000) {
    link.now_ += 100;
    step();
  }
  EXPECT_TRUE(isComplete);
  // A split a millisecond, but for what others were sent too.
  EXPECT_GE(link.now_ - begunMs, lacking / 2);
}

TEST(Session, WhatEndsBeforeItIsPrefetchedIsGivenBack) {
  const auto begin = [](Link& link) {
    link.hello();
    link.open("bumpy");
    link.look({1, 2, 3}, Goal::kSettled);
    link.settle();
    link.now_ += SessionOptions{}.prefetchAfterMs;
    link.session_.update(link.now_);
    EXPECT_FALSE(link.shared_.prefetch.allows(link.now_));
  };
  {
    Link link(slowlyPrefetching());
    begin(link);
    link.look({3, 2, 1}, Goal::kSettled);
    EXPECT_TRUE(link.shared_.prefetch.allows(link.now_)) << "by another pose";
  }
  {
    Link link(slowlyPrefetching());
    begin(link);
    link.session_.drain(0);
    EXPECT_TRUE(link.shared_.prefetch.allows(link.now_)) << "by the client's leaving";
  }
}

TEST(Session, WithoutPrefetchASettledClientGetsNothingMore) {
  SessionOptions options;
  options.prefetchAfterMs = -1;
  Link link(options);
  link.hello();
  link.open("bumpy");
  link.look({1, 2, 3}, Goal::kSettled);
  link.settle(10'000);
  EXPECT_FALSE(link.decoder().complete());
  EXPECT_EQ(link.settled_.size(), 1U);
}

TEST(Session, SettledHoldsExactlyWhatTheSearchFinds) {
  Link link;
  link.hello();
  link.open("bumpy");
  const protocol::Pose pose = link.look({1, 2, 3}, Goal::kSettled);
  link.settle();
  const SplitForest& forest = bumpy()->forest();
  HaveSet start(forest.vertexCount());
  start.addRange(0, forest.levelBegin[1 + bumpy()->blocks().size()]);
  ContourSearch search(*bumpy()->fullMesh(), contourViewOf(pose, forest.grid), start.words());
  ASSERT_TRUE(search.run());
  const TargetSet found = search.target();
  for (VertexId v = forest.baseVertexCount(); v < forest.vertexCount(); ++v) {
    const bool wanted = start.holds(v) || (found.classes[0][v / 64] >> (v % 64) & 1) != 0;
    EXPECT_EQ(link.decoder().mesh().holds(v), wanted) << v;
  }
}

TEST(Session, ExactSendsNothingThatExactDoesNotNeed) {
  Link link;
  link.hello();
  link.open("bumpy");
  const protocol::Pose pose = link.look({1, 2, 3}, Goal::kExact);
  link.settle();
  ASSERT_EQ(link.settled_, (SettledList{{1, Goal::kExact}}));
  const SplitForest& forest = bumpy()->forest();
  const TargetSet exact = selectExact(*bumpy()->fullMesh(), viewOfPose(pose, forest.grid));
  const VertexId blocksEnd = forest.levelBegin[1 + bumpy()->blocks().size()];
  for (VertexId v = forest.baseVertexCount(); v < forest.vertexCount(); ++v) {
    const bool wanted = v < blocksEnd || (exact.classes[0][v / 64] >> (v % 64) & 1) != 0;
    EXPECT_EQ(link.decoder().mesh().holds(v), wanted) << v;
  }
}

TEST(Session, CompleteIsTheWholeModel) {
  Link link;
  link.hello();
  link.open("bumpy");
  link.look({1, 2, 3}, Goal::kComplete);
  link.settle();
  EXPECT_TRUE(link.decoder().complete());
  EXPECT_EQ(link.settled_, (SettledList{{1, Goal::kComplete}}));
  EXPECT_EQ(link.decoder().mesh().mesh().faceCount(), bumpy()->forest().triangles.size());
  // From now on every pose is settled at once.
  link.look({-1, 0, 0}, Goal::kExact);
  link.settle();
  EXPECT_EQ(
      link.settled_,
      (SettledList{{1, Goal::kComplete}, {2, Goal::kExact}, {2, Goal::kComplete}}));
}

TEST(Session, EverythingFromTheStartIsTheStreamAsItWasPrepared) {
  Link link;
  link.hello();
  link.open("bumpy");
  link.look({1, 2, 3}, Goal::kComplete);
  link.settle();
  std::size_t prepared = 0;
  for (const Model::Run& run : bumpy()->runs())
    prepared += run.splits.size();
  EXPECT_EQ(link.packetBytes_, prepared);
}

TEST(Session, WhatIsMissingBetweenHeldSplitsAndUntouchedRunsComesCompletely) {
  Link link;
  link.hello();
  link.open("bumpy");
  link.look({0, 0, 2}, Goal::kSettled);
  link.settle();
  ASSERT_FALSE(link.decoder().complete());
  link.look({0, 0, 2}, Goal::kComplete);
  link.settle();
  EXPECT_TRUE(link.decoder().complete());
  EXPECT_EQ(link.decoder().mesh().mesh().faceCount(), bumpy()->forest().triangles.size());
}

TEST(Session, TheSamePoseAgainIsAnsweredAgainAndCostsNothing) {
  Link link;
  link.hello();
  link.open("bumpy");
  link.look({1, 2, 3}, Goal::kSettled);
  link.settle();
  const auto bytes = link.payload_;
  const auto computed = link.cells_.computed();
  link.look({1, 2, 3}, Goal::kSettled);
  link.settle();
  EXPECT_EQ(link.settled_, (SettledList{{1, Goal::kSettled}, {2, Goal::kSettled}}));
  EXPECT_EQ(link.payload_, bytes);
  EXPECT_EQ(link.cells_.computed(), computed);
}

TEST(Session, AMovingCameraIsServedFromCellsAndARestingOneFromItsOwnSet) {
  Link link;
  link.hello();
  link.open("bumpy");
  for (int frame = 0; frame < 20; ++frame) {
    const double angle = 0.05 * frame;
    link.look({std::sin(angle), 0.3, std::cos(angle)}, Goal::kSettled);
    link.tasks_.runAll();
    link.session_.update(link.now_);
    link.take();
    link.acknowledge();
    link.now_ += 100;
  }
  EXPECT_GT(link.cells_.hits(), 10U) << "most poses fall into a cell that is there";
  // The first pose comes after nothing, so it has a set, and an answer, of its own.
  for (const auto& [pose, state] : link.settled_)
    EXPECT_LE(pose, 1U) << "a moving pose was called settled";
  link.settle(300);
  ASSERT_FALSE(link.settled_.empty());
  EXPECT_EQ(link.settled_.back(), (std::pair<std::uint32_t, Goal>{20, Goal::kSettled}));
}

TEST(Session, KnowsWhenItWillHaveSomethingToDo) {
  Link link;
  EXPECT_EQ(link.session_.dueMs(), std::nullopt);
  link.hello();
  link.open("bumpy");
  link.settle();
  EXPECT_EQ(link.session_.dueMs(), std::nullopt) << "no pose yet";
  link.look({0, 0, 1}, protocol::Goal::kSettled);
  EXPECT_LE(link.session_.dueMs().value_or(1), 0) << "its set is being computed";
  link.settle();
  EXPECT_EQ(link.session_.dueMs(), std::nullopt) << "settled";
  link.now_ += 100;
  link.look({0.1, 0, 1}, protocol::Goal::kSettled);
  link.settle();
  EXPECT_EQ(link.session_.dueMs(), link.now_ + SessionOptions{}.restMs) << "moving";
}

TEST(Session, ANewPoseTakesEffectWithTheNextPacket) {
  SessionOptions options;
  options.packetBytes = 512;
  Link link(options);
  link.hello();
  link.open("bumpy");
  link.look({0, 0, 1}, Goal::kSettled);
  link.tasks_.runAll();
  link.session_.update(0);
  std::optional<std::uint32_t> last;
  while (!last) {
    const auto out = link.session_.nextMessage(link.now_);
    ASSERT_TRUE(out);
    const auto message = protocol::decodeMessage(out->bytes(), protocol::Sender::kServer);
    if (const auto* packet = message->as<protocol::Packet>()) last = packet->pose;
  }
  EXPECT_EQ(last, 1U);
  link.now_ = 1000;
  link.look({0, 0, -1}, Goal::kSettled);
  link.tasks_.runAll();
  link.session_.update(link.now_);
  const auto out = link.session_.nextMessage(link.now_);
  ASSERT_TRUE(out);
  const auto message = protocol::decodeMessage(out->bytes(), protocol::Sender::kServer);
  ASSERT_NE(message->as<protocol::Packet>(), nullptr);
  EXPECT_EQ(message->as<protocol::Packet>()->pose, 2U);
}

TEST(Session, ASlowReaderStopsTheStreamAtTheWindow) {
  SessionOptions options;
  options.windowBytes = 6 * 1024;
  options.packetBytes = 1024;
  Link link(options);
  link.hello();
  link.open("bumpy");
  link.look({0, 0, 1}, Goal::kComplete);
  for (int i = 0; i < 100; ++i) {
    link.tasks_.runAll();
    link.session_.update(i * 50);
    link.take();
  }
  EXPECT_LE(link.payload_, options.windowBytes + options.packetBytes);
  EXPECT_FALSE(link.decoder().complete());
  link.settle();
  EXPECT_TRUE(link.decoder().complete()) << "acknowledgements let it go on";
}

TEST(Session, OfManyPosesAtOnceTheNewestCounts) {
  SessionOptions options;
  options.posesPerSecond = 10.0;
  Link link(options);
  link.hello();
  link.open("bumpy");
  link.settle();
  for (int i = 0; i < 500; ++i)
    link.look({1.0, 0.001 * i, 0.0}, protocol::Goal::kSettled);
  EXPECT_EQ(link.shared_.poses, 500U);
  EXPECT_EQ(link.shared_.posesReplaced, 483U);
  link.settle(500);
  ASSERT_FALSE(link.settled_.empty());
  EXPECT_EQ(link.settled_.back().first, 500U);
}

TEST(Session, PacketsKeepToTheirSize) {
  SessionOptions options;
  options.packetBytes = 1024;
  Link link(options);
  link.hello();
  link.open("bumpy");
  link.look({0, 0, 1}, Goal::kComplete);
  std::size_t largest = 0;
  link.session_.update(0);
  while (auto out = link.session_.nextMessage(link.now_)) {
    const auto message = protocol::decodeMessage(out->bytes(), protocol::Sender::kServer);
    if (message->as<protocol::Packet>() != nullptr)
      largest = std::max(largest, out->bytes().size());
    if (out->payload) link.payload_ += out->bytes().size();
    link.acknowledge();
  }
  EXPECT_GT(largest, 300U);
  EXPECT_LE(largest, 2048U);
}

TEST(Session, AcknowledgingMoreThanWasSentEndsTheConnection) {
  Link link;
  link.hello();
  link.send(protocol::Acknowledge{1});
  link.take();
  EXPECT_EQ(link.failures_, std::vector{WireError::kBadMessage});
  EXPECT_TRUE(link.session_.close());
}

std::vector<std::uint8_t> bitsOf(const ActiveMesh& mesh, std::uint32_t vertices) {
  std::vector<std::uint8_t> bits((vertices + 7) / 8, 0);
  for (VertexId v = 0; v < vertices; ++v) {
    if (mesh.holds(v)) bits[v / 8] = static_cast<std::uint8_t>(bits[v / 8] | 1U << (v % 8));
  }
  return bits;
}

TEST(Session, AResumedClientGetsOnlyWhatItLacks) {
  Link first;
  first.hello();
  first.open("bumpy");
  first.look({1, 0, 0}, Goal::kSettled);
  first.settle();
  Link second;
  second.decoders_ = std::move(first.decoders_);
  const std::uint32_t vertices = bumpy()->forest().vertexCount();
  const auto bits = bitsOf(second.decoder().mesh(), vertices);
  const std::size_t half = bits.size() / 2;
  second.hello();
  second.open("bumpy", 0, true);
  second.take();
  EXPECT_EQ(second.payload_, 0U) << "nothing before the have-set";
  second.send(protocol::HaveSet{0, bumpy()->id(), true, 0, std::span(bits).first(half), false});
  second.send(protocol::HaveSet{
      0,
      bumpy()->id(),
      true,
      static_cast<std::uint32_t>(8 * half),
      std::span(bits).subspan(half),
      true,
      second.decoder().seedBytesHeld()});
  second.look({0, 0, 1}, Goal::kComplete);
  second.settle();
  // The decoder refuses a split that it holds already, so nothing came twice.
  EXPECT_TRUE(second.decoder().complete());
  EXPECT_LT(second.payload_ + 100, first.payload_ + second.payload_);
  EXPECT_TRUE(second.failures_.empty());
}

TEST(Session, AResumeWithoutAnythingStartsAfresh) {
  Link link;
  link.hello();
  link.open("bumpy", 0, true);
  link.take();
  link.send(protocol::HaveSet{0, bumpy()->id(), false, 0, {}, true});
  link.look({0, 0, 1}, Goal::kComplete);
  link.settle();
  EXPECT_TRUE(link.decoder().complete());
}

TEST(Session, RefusesAHaveSetOfAnotherAssetAsStale) {
  Link link;
  link.hello();
  link.open("bumpy", 0, true);
  link.send(protocol::HaveSet{0, torus()->id(), true, 0, {}, true});
  link.take();
  EXPECT_EQ(link.failures_, std::vector{WireError::kStale});
}

TEST(Session, RefusesAHaveSetThatIsNotClosed) {
  const std::uint32_t vertices = bumpy()->forest().vertexCount();
  std::vector<std::uint8_t> bits((vertices + 7) / 8, 0);
  bits[(vertices - 1) / 8] = static_cast<std::uint8_t>(1U << ((vertices - 1) % 8));
  Link link;
  link.hello();
  link.open("bumpy", 0, true);
  link.send(protocol::HaveSet{0, bumpy()->id(), true, 0, bits, true});
  link.take();
  EXPECT_EQ(link.failures_, std::vector{WireError::kHaveSet});
  link.open("bumpy", 1, true);
  std::vector<std::uint8_t> whole(bits.size(), 0xFF);
  link.send(protocol::HaveSet{1, bumpy()->id(), false, 0, whole, true});
  link.take();
  EXPECT_EQ(link.failures_.back(), WireError::kHaveSet) << "splits without the base mesh";
}

TEST(Session, RefusesHaveSetPiecesOutOfOrderOrUnasked) {
  Link link;
  link.hello();
  link.open("bumpy", 0, true);
  link.send(protocol::HaveSet{0, bumpy()->id(), true, 64, std::vector<std::uint8_t>(8), false});
  link.send(protocol::HaveSet{0, bumpy()->id(), true, 0, std::vector<std::uint8_t>(8), true});
  link.open("bumpy", 1);
  link.send(protocol::HaveSet{1, bumpy()->id(), true, 0, {}, true});
  link.send(protocol::HaveSet{9, bumpy()->id(), true, 0, {}, true});
  link.take();
  EXPECT_EQ(
      link.failures_,
      (std::vector{WireError::kHaveSet, WireError::kHaveSet, WireError::kState}));
}

TEST(Session, ServesSeveralModelsOverOneConnection) {
  Link link;
  link.hello();
  link.open("bumpy", 0);
  link.open("torus", 200);
  link.open("bumpy", 7);
  for (const std::uint8_t channel : {0, 200, 7})
    link.look({0, 0, 1}, Goal::kComplete, channel);
  link.settle();
  for (const std::uint8_t channel : {0, 200, 7})
    EXPECT_TRUE(link.decoder(channel).complete()) << int{channel};
}

TEST(Session, RefusesMoreModelsThanItsLimit) {
  SessionOptions options;
  options.maxChannels = 2;
  Link link(options);
  link.hello();
  for (std::uint8_t channel = 0; channel < 3; ++channel)
    link.open("torus", channel);
  link.take();
  EXPECT_EQ(link.failures_, std::vector{WireError::kLimit});
}

TEST(Session, CutsOffWhoeverKeepsProvokingErrors) {
  Link link;
  link.hello();
  for (int i = 0; i < 1000; ++i)
    link.open("nothing");
  link.take();
  EXPECT_LE(link.failures_.size(), 20U);
  EXPECT_TRUE(link.session_.close());
}

TEST(Session, RandomOrderIsDecodableAndComplete) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SessionOptions options;
    options.randomSeed = seed;
    options.packetBytes = 400;
    Link link(options);
    link.hello();
    link.open("bumpy");
    link.look({0, 0, 1}, Goal::kSettled);
    link.settle();
    EXPECT_TRUE(link.decoder().complete());
  }
}

TEST(Session, DroppedSplitsComeAgainWhenNeeded) {
  Link link;
  link.hello();
  link.open("bumpy");
  link.look({1, 0, 0}, Goal::kExact);
  link.settle();
  // Nothing is built on the finest split.
  const SplitForest& forest = bumpy()->forest();
  VertexId finest = 0;
  for (VertexId v = forest.baseVertexCount(); v < forest.vertexCount(); ++v) {
    if (link.decoder().mesh().holds(v)) finest = v;
  }
  const std::vector<VertexId> ids{finest};
  link.send(protocol::Drop{0, encodeIdSet(ids)});
  ASSERT_TRUE(link.decoder().undo(ids));
  const auto before = link.packetBytes_;
  link.settle();
  EXPECT_EQ(link.drops_, 1);
  EXPECT_TRUE(link.kept_->empty());
  EXPECT_GT(link.packetBytes_, before) << "the pose needs it";
  EXPECT_TRUE(link.decoder().mesh().holds(finest));
}

TEST(Session, RefusesToDropWhatIsNotHeld) {
  Link link;
  link.hello();
  for (const std::uint8_t channel : {0, 1, 2}) {
    link.open("bumpy", channel);
    link.settle();
    const VertexId last = bumpy()->forest().vertexCount() - 1;
    const std::vector<std::uint8_t> ids = channel == 0   ? encodeIdSet(std::vector<VertexId>{last})
                                          : channel == 1 ? encodeIdSet(std::vector<VertexId>{0})
                                                         : std::vector<std::uint8_t>(6, 0xFF);
    link.send(protocol::Drop{channel, ids});
    link.take();
  }
  EXPECT_EQ(link.failures_, std::vector(3, WireError::kBadMessage));
  EXPECT_EQ(link.failureChannels_, (std::vector{0, 1, 2}));
  EXPECT_FALSE(link.session_.close());
}

TEST(Session, DrainTellsTheClientToMoveOn) {
  Link link;
  link.hello();
  link.open("bumpy");
  link.look({1, 0, 0}, Goal::kSettled);
  link.take();
  link.session_.drain(700);
  link.take();
  EXPECT_EQ(link.failures_, std::vector{WireError::kDraining});
  EXPECT_EQ(link.session_.close(), Session::Close::kGoingAway);
}

TEST(Session, CostsABitASplitAndLittleElse) {
  Link link;
  link.hello();
  const std::size_t idle = link.session_.bytes();
  EXPECT_LE(idle, 1024U);
  link.open("bumpy");
  link.look({1, 0, 0}, Goal::kSettled);
  link.settle(3000);
  const std::size_t haveSet = bumpy()->forest().vertexCount() / 8 + 8;
  EXPECT_LE(link.session_.bytes(), idle + haveSet + 1792);
}

}  // namespace
}  // namespace limn
