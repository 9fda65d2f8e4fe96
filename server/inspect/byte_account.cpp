// SPDX-License-Identifier: Apache-2.0
#include "server/inspect/byte_account.h"

#include "protocol/framing.h"
#include "protocol/messages.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace limn {
namespace {

/// Sections of messages go on the wire; a section that is anything else is the server's own.
SectionBytes measureSection(const std::string& name, std::span<const std::uint8_t> bytes) {
  SectionBytes wire{.name = name};
  protocol::FrameReader reader(bytes);
  while (true) {
    const auto next = reader.next();
    if (next && !*next) return wire;
    if (!next || !protocol::decodeMessage(**next, protocol::Sender::kServer)) {
      return {.name = name, .messages = 0, .bytes = bytes.size()};
    }
    ++wire.messages;
    wire.bytes += protocol::webSocketFrameBytes((*next)->size());
  }
}

// In runs as preparation makes them: probabilities begin anew with each.
void measureSplits(const Model& model, const LevelFronts& fronts, LevelBytes& level) {
  if (level.level == 0) return;
  const SplitForest& forest = model.forest();
  const VertexId last = forest.levelBegin[level.level + 1];
  for (VertexId begin = forest.levelBegin[level.level]; begin < last; begin += kLevelRunSplits) {
    const VertexId end = std::min(begin + kLevelRunSplits, last);
    level.bits += measureLevelRun(forest, model.splitModel(), fronts, begin, end);
    if (forest.attributeKinds() != 0) level.attributes += measureAttributes(forest, begin, end);
  }
}

}  // namespace

Result<ByteAccount> accountBytes(const Asset& asset, const Model& model) {
  ByteAccount account;
  for (const std::string& name : asset.sectionNames()) {
    const auto bytes = asset.section(name);
    if (!bytes) return tl::unexpected(bytes.error());
    account.sections.push_back(measureSection(name, *bytes));
  }
  account.splitModelBytes = model.info().splitModel.size();
  const auto base = protocol::decodeMessage(model.base(), protocol::Sender::kServer);
  if (!base) return tl::unexpected(base.error());
  account.baseFeatureBytes = base->as<protocol::Base>()->features.size();

  const auto report = nlohmann::json::parse(asset.report(), nullptr, false);
  const auto corrupt = [] {
    return fail(
        ErrorCode::kCorrupt,
        "the asset's report does not fit its forest; prepare it again");
  };
  if (!report.is_object() || !report.contains("levels") || !report["levels"].is_array() ||
      report["levels"].size() != model.forest().levelCount()) {
    return corrupt();
  }
  const LevelFronts fronts = frontsOf(model.forest());
  for (std::uint32_t level = 0; level < model.forest().levelCount(); ++level) {
    const auto& entry = report["levels"][level];
    for (const char* key : {"vertices", "faces", "bytes", "error"}) {
      if (!entry.is_object() || !entry.contains(key) || !entry[key].is_number()) return corrupt();
    }
    LevelBytes& bytes = account.levels.emplace_back();
    bytes.level = level;
    bytes.vertices = entry["vertices"].get<std::uint32_t>();
    bytes.faces = entry["faces"].get<std::uint32_t>();
    bytes.bytes = entry["bytes"].get<std::uint64_t>();
    bytes.rmsError = entry["error"].get<double>();
    measureSplits(model, fronts, bytes);
  }
  return account;
}

}  // namespace limn
