// SPDX-License-Identifier: Apache-2.0
//
// The client's machine against the server's session, over memory: room and eviction, several
// models.
#include "client/core/session_machine.h"
#include "server/session/contour_search.h"
#include "tests/property/canonical_mesh.h"
#include "tests/unit/server/session/session_link.h"

#include <cmath>
#include <deque>

namespace limn {
namespace {

using protocol::Goal;

class NoPeer final : public Peer {
 public:
  void wantWrite() override {}
};

/// A server with some models, and a client that talks to it without a network. Connections are cut
/// when the test likes.
class Pair {
 public:
  Pair(std::map<std::string, std::shared_ptr<const Model>> models, SessionMachine::Options options)
      : cells_(tasks_, {}),
        shared_{models_, cells_, quiet()},
        machine_(std::move(options)) {
    for (auto& [name, model] : models)
      models_.add(name, model);
    machine_.start(0);
  }

  /// Until nothing moves, calling `check` after every message.
  template <class Check>
  void settle(Check check) {
    for (int still = 0; still < 3;) {
      bool moved = tasks_.runAll() > 0;
      if (machine_.wantsConnection() && connection_ != machine_.connectionNumber()) connect();
      for (auto& message : machine_.takeOutbox()) {
        session_->receive(message, now_);
        moved = true;
      }
      session_->update(now_);
      while (auto out = session_->nextMessage(now_)) {
        const auto bytes = out->bytes();
        machine_.onMessage(bytes, bytes.size() + 4, static_cast<std::uint64_t>(now_));
        moved = true;
        check();
      }
      machine_.onIdle(static_cast<std::uint64_t>(now_));
      machine_.onTimer(static_cast<std::uint64_t>(now_));
      now_ += 10;
      still = moved ? 0 : still + 1;
    }
  }

  void look(const Model& model, const glm::dvec3& direction, std::size_t index = 0) {
    const auto& info = model.info();
    ClientView view;
    view.camera.target = info.center;
    view.camera.eye = info.center + 3.0 * info.radius * glm::normalize(direction);
    view.viewport = {512, 512};
    machine_.setView(view, static_cast<std::uint64_t>(now_), index);
    now_ += 1000;  // it rests
  }

  SessionMachine& machine() { return machine_; }

  void cut() { machine_.onClosed({ErrorCode::kNetwork, "cut"}, static_cast<std::uint64_t>(now_)); }

  void wait(std::int64_t ms) {
    now_ += ms;
    machine_.onTimer(static_cast<std::uint64_t>(now_));
  }

 private:
  static SessionOptions quiet() {
    SessionOptions options;
    options.prefetchAfterMs = -1;
    return options;
  }

  void connect() {
    connection_ = machine_.connectionNumber();
    session_ = std::make_unique<Session>(shared_, peer_, now_);
    machine_.onOpen(static_cast<std::uint64_t>(now_));
  }

  ManualTasks tasks_;
  FixedModels models_;
  ViewCells cells_;
  SessionShared shared_;
  NoPeer peer_;
  std::unique_ptr<Session> session_;
  SessionMachine machine_;
  std::uint32_t connection_ = 0;
  std::int64_t now_ = 0;
};

SessionMachine::Options going(const std::string& model, std::uint64_t memoryBytes = 0) {
  SessionMachine::Options options;
  options.model = model;
  options.stop.kind = StopCondition::Kind::kNever;
  options.memoryBytes = memoryBytes;
  return options;
}

/// The mesh of the same splits, never undone.
CanonicalMesh afresh(const Model& model, const ActiveMesh& held) {
  ActiveMesh mesh = baseMeshOf(model.forest());
  for (VertexId v = model.forest().baseVertexCount(); v < model.forest().vertexCount(); ++v) {
    if (!held.holds(v)) continue;
    EXPECT_TRUE(mesh.apply(model.forest().split(v)));
  }
  return canonicalOf(mesh);
}

// A camera that goes around and around with memory for a part of the model only.
TEST(ClientMemory, StaysWithinItsLimitAndEveryViewEndsRight) {
  static const auto model = modelOf(primitives::bumpySphere(5, 7), 5, 120);
  const SplitForest& forest = model->forest();
  constexpr std::uint64_t kBudget = 700'000;
  Pair pair({{"large", model}}, going("large", kBudget));
  SessionMachine& machine = pair.machine();
  std::uint32_t most = 0;
  const auto check = [&] {
    if (!machine.decoder().hasBase()) return;
    most = std::max(most, machine.decoder().mesh().splitsHeld());
    EXPECT_LE(3 * machine.decoder().mesh().bytes(), kBudget);
  };
  std::uint32_t drops = 0;
  std::uint32_t before = 0;
  for (int i = 0; i < 20; ++i) {
    const double angle = 0.42 * i;
    const glm::dvec3 direction(std::sin(angle), 0.3 * std::sin(0.3 * i), std::cos(angle));
    pair.look(*model, direction);
    pair.settle(check);
    ASSERT_FALSE(machine.failure()) << machine.failure()->message;
    ASSERT_FALSE(machine.blocked()) << machine.blocked()->message;
    ASSERT_EQ(machine.state(), MeshState::kSettled) << "view " << i;
    const ActiveMesh& mesh = machine.decoder().mesh();
    if (mesh.splitsHeld() < before) ++drops;
    before = mesh.splitsHeld();
    // Settled means that the search finds nothing to add to what is held now.
    ClientView view;
    view.camera.target = model->info().center;
    view.camera.eye = model->info().center + 3.0 * model->info().radius * glm::normalize(direction);
    view.viewport = {512, 512};
    HaveSet have(forest.vertexCount());
    for (const VertexId v : mesh.ids())
      have.add(v);
    ContourSearch search(
        *model->fullMesh(),
        contourViewOf(toPose(view, 0, 1), forest.grid),
        have.words());
    ASSERT_TRUE(search.run());
    ASSERT_EQ(missingOf(search.target(), have), 0U) << "view " << i;
    if (i % 6 == 0) {
      ASSERT_EQ(canonicalOf(mesh), afresh(*model, mesh));
    }
    if (i == 11) {
      // What is held after drops is what a new connection is told.
      pair.cut();
      pair.wait(1000);
    }
  }
  EXPECT_EQ(machine.reconnects(), 1U);
  ASSERT_TRUE(machine.room());
  EXPECT_LE(most, *machine.room());
  EXPECT_LT(*machine.room(), forest.splitCount() * 3 / 4) << "the limit must matter";
  EXPECT_GT(most, *machine.room() * 9 / 10);
}

TEST(ClientMemory, AViewThatDoesNotFitIsSaidSo) {
  static const auto model = modelOf(primitives::bumpySphere(5, 7), 5, 120);
  auto options = going("large", 400'000);
  options.stop.kind = StopCondition::Kind::kState;
  options.stop.state = MeshState::kComplete;
  Pair pair({{"large", model}}, options);
  ClientView view;
  view.camera.target = model->info().center;
  view.camera.eye = model->info().center + glm::dvec3(0, 0, 3.0 * model->info().radius);
  view.goal = Goal::kComplete;
  pair.machine().setView(view, 0);
  pair.settle([] {});
  ASSERT_TRUE(pair.machine().failure());
  EXPECT_EQ(pair.machine().failure()->code, ErrorCode::kLimitExceeded);
  EXPECT_NE(pair.machine().failure()->message.find("allow more"), std::string::npos);
}

TEST(ClientMemory, TooLittleForAnythingIsRefusedAtOnce) {
  Pair pair({{"bumpy", bumpy()}}, going("bumpy", 10'000));
  pair.settle([] {});
  ASSERT_TRUE(pair.machine().failure());
  EXPECT_EQ(pair.machine().failure()->code, ErrorCode::kLimitExceeded);
}

TEST(ClientModels, SeveralComeOverOneConnection) {
  auto options = going("bumpy");
  options.moreModels = {"torus", "bumpy"};
  options.stop.kind = StopCondition::Kind::kState;
  options.stop.state = MeshState::kSettled;
  Pair pair({{"bumpy", bumpy()}, {"torus", torus()}}, options);
  pair.look(*bumpy(), {0, 0, 1}, 0);
  pair.look(*torus(), {0, 1, 1}, 1);
  pair.settle([] {});
  EXPECT_EQ(pair.machine().state(0), MeshState::kSettled);
  EXPECT_EQ(pair.machine().state(1), MeshState::kSettled);
  EXPECT_EQ(pair.machine().phase(), SessionMachine::Phase::kStreaming) << "one has no view yet";
  pair.look(*bumpy(), {1, 0, 0}, 2);
  pair.settle([] {});
  EXPECT_EQ(pair.machine().phase(), SessionMachine::Phase::kDone);
  EXPECT_EQ(pair.machine().decoder(1).model().name, "torus");
  EXPECT_EQ(pair.machine().reconnects(), 0U);
}

TEST(ClientModels, AllAreResumedAfterALoss) {
  auto options = going("bumpy");
  options.moreModels = {"torus"};
  Pair pair({{"bumpy", bumpy()}, {"torus", torus()}}, options);
  pair.look(*bumpy(), {0, 0, 1}, 0);
  pair.look(*torus(), {0, 1, 1}, 1);
  pair.settle([] {});
  const auto before = pair.machine().bytes();
  pair.cut();
  pair.wait(1000);
  pair.settle([] {});
  EXPECT_EQ(pair.machine().state(), MeshState::kSettled);
  EXPECT_EQ(pair.machine().reconnects(), 1U);
  const auto after = pair.machine().bytes();
  EXPECT_EQ(
      after.base + after.levelBlocks + after.packets + after.seeds + after.features,
      before.base + before.levelBlocks + before.packets + before.seeds + before.features)
      << "not a byte of the meshes came twice";
}

}  // namespace
}  // namespace limn
