// SPDX-License-Identifier: Apache-2.0
#include "client/apps/session_options.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

using Contours = SessionMachine::Options::Contours;

Source server() {
  return {"dragon", {}, true};
}

Source file() {
  return {"dragon", {}, false};
}

RenderCommandOptions until(MeshState state) {
  RenderCommandOptions options;
  options.until = StopCondition{.state = state};
  return options;
}

TEST(SessionOptions, AServerSettlesAndFilesAreReadWhole) {
  const RenderCommandOptions usual;
  EXPECT_EQ(sessionOptionsOf(server(), usual).session.stop.state, MeshState::kSettled);
  EXPECT_EQ(sessionOptionsOf(file(), usual).session.stop.state, MeshState::kComplete);
  const RenderCommandOptions exact = until(MeshState::kExact);
  EXPECT_EQ(sessionOptionsOf(server(), exact).session.stop.state, MeshState::kExact);
  EXPECT_EQ(sessionOptionsOf(file(), exact).session.stop.state, MeshState::kComplete);
  const RenderCommandOptions base = until(MeshState::kBase);
  EXPECT_EQ(sessionOptionsOf(file(), base).session.stop.state, MeshState::kBase);
}

TEST(SessionOptions, OnlyWhatIsDrawnIsAskedFor) {
  RenderCommandOptions options;
  EXPECT_EQ(sessionOptionsOf(server(), options).session.outerHullFaces, 0U);
  EXPECT_FALSE(sessionOptionsOf(server(), options).session.needsSeeds);
  options.detector = DetectorMethod::kPrecomputed;
  EXPECT_TRUE(sessionOptionsOf(server(), options).session.needsSeeds);
  options.draw = DrawMode::kClip;
  options.hullFaces = 300;
  const auto clip = sessionOptionsOf(server(), options).session;
  EXPECT_EQ(clip.outerHullFaces, 300U);
  EXPECT_EQ(clip.innerHullFaces, 0U);
  EXPECT_EQ(clip.maps, SessionMachine::Options::Maps::kWanted);
  EXPECT_EQ(clip.hulls, SessionMachine::Options::Hulls::kWanted);
  options.dumpInnerHull = "inner.ply";
  EXPECT_EQ(sessionOptionsOf(server(), options).session.innerHullFaces, 300U);
  EXPECT_EQ(
      sessionOptionsOf(server(), options).session.hulls,
      SessionMachine::Options::Hulls::kNeeded);
}

TEST(SessionOptions, TheServersContoursNeedTheBaseAndForStrokesTheInnerHull) {
  RenderCommandOptions options;
  options.contours = Contours::kServer;
  const auto strokes = sessionOptionsOf(server(), options).session;
  EXPECT_EQ(strokes.stop.state, MeshState::kBase);
  EXPECT_GE(strokes.innerHullFaces, options.hullFaces);
  options.draw = DrawMode::kClip;
  EXPECT_EQ(sessionOptionsOf(server(), options).session.innerHullFaces, 0U);
}

TEST(SessionOptions, MemoryIsInMebibytes) {
  EXPECT_EQ(sessionOptionsOf(server(), 3).session.memoryBytes, 3ULL << 20);
  EXPECT_EQ(sessionOptionsOf(server()).session.memoryBytes, 0U);
}

}  // namespace
}  // namespace limn
