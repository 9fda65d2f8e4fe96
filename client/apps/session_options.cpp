// SPDX-License-Identifier: Apache-2.0
#include "client/apps/session_options.h"

#include "client/apps/contour_lines.h"

#include <algorithm>

namespace limn {
namespace {

constexpr std::uint64_t kNeverMs = std::uint64_t{1} << 48;

StopCondition stopConditionOf(const Source& source, const RenderCommandOptions& options) {
  StopCondition until;
  until.state = source.isServer ? MeshState::kSettled : MeshState::kComplete;
  if (options.until) until = *options.until;
  if (!source.isServer && until.kind == StopCondition::Kind::kState &&
      until.state > MeshState::kBase) {
    until.state = MeshState::kComplete;
  }
  if (options.contours == SessionMachine::Options::Contours::kServer)
    until.state = MeshState::kBase;
  return until;
}

}  // namespace

ClientSession::Options sessionOptionsOf(const Source& source, std::uint64_t memoryMib) {
  ClientSession::Options options;
  options.session.model = source.model;
  options.session.cache = source.cache;
  options.session.memoryBytes = memoryMib << 20;
  options.publishEveryMs = kNeverMs;
  return options;
}

ClientSession::Options sessionOptionsOf(const Source& source, const RenderCommandOptions& options) {
  ClientSession::Options made = sessionOptionsOf(source, options.memoryMib);
  SessionMachine::Options& session = made.session;
  session.stop = stopConditionOf(source, options);
  session.contours = options.contours;
  session.needsSeeds =
      options.detector == DetectorMethod::kPrecomputed && session.stop.state > MeshState::kBase;
  const bool clips = options.draw == DrawMode::kClip;
  if (clips) session.maps = SessionMachine::Options::Maps::kWanted;
  if (clips || !options.dumpHull.empty()) session.outerHullFaces = options.hullFaces;
  if (!options.dumpInnerHull.empty()) session.innerHullFaces = options.hullFaces;
  // The server's lines are drawn on a hull: the mesh is not there.
  const bool needsStage = options.contours == SessionMachine::Options::Contours::kServer &&
                          options.draw == DrawMode::kStrokes;
  if (needsStage) session.innerHullFaces = std::max(options.hullFaces, kStageFaces);
  // A clipped mesh that has no hull can be drawn whole, if it is there.
  const bool needsHull = options.contours == SessionMachine::Options::Contours::kServer ||
                         !options.dumpHull.empty() || !options.dumpInnerHull.empty();
  if (needsHull) session.hulls = SessionMachine::Options::Hulls::kNeeded;
  return made;
}

}  // namespace limn
