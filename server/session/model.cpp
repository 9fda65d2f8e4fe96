// SPDX-License-Identifier: Apache-2.0
#include "server/session/model.h"

#include "server/session/target_set.h"
#include "server/store/manifest.h"

#include "protocol/framing.h"

#include <utility>

namespace limn {
namespace {

using protocol::Bytes;

/// The messages of a section, each of type T. Errors: kCorrupt.
template <class T>
Result<std::vector<Bytes>> messagesOf(const Asset& asset, const char* name) {
  const auto section = asset.section(name);
  if (!section) return tl::unexpected(section.error());
  std::vector<Bytes> messages;
  protocol::FrameReader reader(*section);
  while (true) {
    const auto next = reader.next();
    if (!next) return tl::unexpected(next.error().within(name));
    if (!*next) return messages;
    const auto message = protocol::decodeMessage(**next, protocol::Sender::kServer);
    if (!message) {
      return fail(ErrorCode::kCorrupt, std::string(name) + ": " + message.error().message);
    }
    if (message->template as<T>() == nullptr || protocol::channelOf(message->body) != 0) {
      return fail(ErrorCode::kCorrupt, std::string(name) + ": not the message it should be");
    }
    messages.push_back(**next);
  }
}

/// One Hull and its HullSplits in order, or nothing where the asset has no such section.
/// Errors: kCorrupt.
Result<std::vector<Bytes>>
hullMessagesOf(const Asset& asset, const char* name, protocol::HullSide side) {
  const auto damaged = [name] {
    return fail(ErrorCode::kCorrupt, std::string(name) + ": not a hull and its splits in order");
  };
  std::vector<Bytes> messages;
  const auto section = asset.section(name);
  if (!section) return messages;
  protocol::FrameReader reader(*section);
  while (true) {
    const auto next = reader.next();
    if (!next) return tl::unexpected(next.error().within(name));
    if (!*next) break;
    const auto message = protocol::decodeMessage(**next, protocol::Sender::kServer);
    if (!message || protocol::channelOf(message->body) != 0) return damaged();
    const auto* hull = message->as<protocol::Hull>();
    const auto* splits = message->as<protocol::HullSplits>();
    const bool inPlace = messages.empty() ? hull != nullptr && hull->side == side
                                          : splits != nullptr && splits->side == side &&
                                                splits->piece + 1 == messages.size();
    if (!inPlace) return damaged();
    messages.push_back(**next);
  }
  return messages;
}

template <class T>
Result<Bytes> oneMessageOf(const Asset& asset, const char* name) {
  const auto messages = messagesOf<T>(asset, name);
  if (!messages) return tl::unexpected(messages.error());
  if (messages->size() != 1) {
    return fail(ErrorCode::kCorrupt, std::string(name) + ": not one message");
  }
  return messages->front();
}

}  // namespace

Result<std::shared_ptr<const Model>> Model::load(std::shared_ptr<const Asset> asset) {
  const std::string where = "asset " + toHex(asset->id());
  const std::shared_ptr<Model> model(new Model());
  model->asset_ = std::move(asset);
  const Asset& source = *model->asset_;
  const auto corrupt = [&](const std::string& what) {
    return fail(ErrorCode::kCorrupt, where + ": " + what + "; prepare the model again");
  };

  if (const int format = assetFormatOf(source.report()); format != protocol::kAssetFormat) {
    return fail(
        ErrorCode::kUnsupported,
        where + " was prepared by " + (format < protocol::kAssetFormat ? "an older" : "a newer") +
            " Limn (asset format " + (format == 0 ? "before 7" : std::to_string(format)) +
            ", this program reads " + std::to_string(protocol::kAssetFormat) +
            "): prepare the model again with limn-prepare");
  }
  const auto info = oneMessageOf<protocol::ModelInfo>(source, sections::kInfo);
  if (!info) return tl::unexpected(info.error().within(where));
  auto infoMessage = protocol::decodeMessage(*info, protocol::Sender::kServer);
  if (!infoMessage) return corrupt(infoMessage.error().message);
  model->infoMessage_ = std::move(*infoMessage);
  const auto base = oneMessageOf<protocol::Base>(source, sections::kBase);
  if (!base) return tl::unexpected(base.error().within(where));
  model->base_ = *base;
  auto blocks = messagesOf<protocol::LevelBlock>(source, sections::kBlocks);
  if (!blocks) return tl::unexpected(blocks.error().within(where));
  model->blocks_ = std::move(*blocks);
  const auto seeds = source.section(sections::kSeeds);
  if (seeds && !seeds->empty()) {
    const auto message = oneMessageOf<protocol::Seeds>(source, sections::kSeeds);
    if (!message) return tl::unexpected(message.error().within(where));
    auto decoded = protocol::decodeMessage(*message, protocol::Sender::kServer);
    if (!decoded) return corrupt(decoded.error().message);
    model->seedsMessage_ = std::move(*decoded);
    model->seeds_ = model->seedsMessage_.as<protocol::Seeds>()->seeds;
  }
  for (const auto& [name, side] :
       {std::pair(sections::kHullOuter, protocol::HullSide::kOuter),
        std::pair(sections::kHullInner, protocol::HullSide::kInner)}) {
    auto hull = hullMessagesOf(source, name, side);
    if (!hull) return corrupt(hull.error().message);
    model->hulls_[static_cast<std::size_t>(side)] = std::move(*hull);
  }
  for (const auto& [name, kind] :
       {std::pair(sections::kMapNormals, protocol::MapKind::kNormals),
        std::pair(sections::kMapColors, protocol::MapKind::kColors)}) {
    if (!source.section(name)) continue;
    auto map = messagesOf<protocol::Map>(source, name);
    if (!map) return tl::unexpected(map.error().within(where));
    model->maps_[static_cast<std::size_t>(kind)] = std::move(*map);
  }
  const auto bytes = source.section(sections::kForest);
  if (!bytes) return tl::unexpected(bytes.error().within(where));
  auto forest = parseForest(*bytes);
  if (!forest) return tl::unexpected(forest.error().within(where));
  model->forest_ = std::move(*forest);
  const auto placement = static_cast<Placement>(model->info().placement);
  auto splitModel = parseSplitModel(model->info().splitModel, placement);
  if (!splitModel) return tl::unexpected(splitModel.error().within(where));
  model->splitModel_ = std::move(*splitModel);
  model->smoothCones_ = smoothConesOf(model->forest_);

  const protocol::ModelInfo& says = model->info();
  if (says.levelBegin != model->forest_.levelBegin ||
      says.attributes != model->forest_.attributeKinds() ||
      placement != model->forest_.placement() || says.blockLevels != model->blocks_.size() ||
      says.asset != model->asset_->id()) {
    return corrupt("its sections do not belong together");
  }
  for (std::size_t i = 0; i < model->blocks_.size(); ++i) {
    const auto block = protocol::decodeMessage(model->blocks_[i], protocol::Sender::kServer);
    if (!block || block->as<protocol::LevelBlock>()->level != i + 1) {
      return corrupt("its level blocks are not in order");
    }
  }
  const auto packets = messagesOf<protocol::Packet>(source, sections::kPackets);
  if (!packets) return tl::unexpected(packets.error().within(where));
  if (!model->takeRuns(*packets)) return corrupt("its packets are not the whole stream");
  return model;
}

bool Model::takeRuns(std::span<const Bytes> packets) {
  VertexId next = forest_.levelBegin[1 + blocks_.size()];
  for (const Bytes packet : packets) {
    auto message = protocol::decodeMessage(packet, protocol::Sender::kServer);
    if (!message) return false;
    const auto& [channel, pose, splits, attributes] = *message->as<protocol::Packet>();
    const auto head = levelRunHead(splits);
    if (!head || head->begin != next || head->count == 0 ||
        head->count > forest_.vertexCount() - next) {
      return false;
    }
    next += head->count;
    runs_.push_back({head->begin, next, splits, attributes});
    runMessages_.push_back(std::move(*message));
  }
  return next == forest_.vertexCount();
}

const FullMesh* Model::fullMesh() const {
  const std::lock_guard lock(mutex_);
  if (!full_ && !fullFailed_) {
    if (auto made = FullMesh::make(forest_)) {
      full_ = std::move(*made);
    } else {
      fullFailed_ = true;
    }
  }
  return full_.get();
}

const ContourExtractor* Model::contours(SilhouetteKind kind) const {
  const FullMesh* full = fullMesh();
  if (full == nullptr) return nullptr;
  auto& made = contours_[static_cast<std::size_t>(kind)];
  const std::lock_guard lock(mutex_);
  if (!made) made = std::make_unique<const ContourExtractor>(full->field(kind));
  return made.get();
}

const Dependents& Model::dependents() const {
  const std::lock_guard lock(mutex_);
  if (!dependents_) dependents_ = std::make_unique<const Dependents>(forest_);
  return *dependents_;
}

PacketMaker& Model::packets() const {
  const std::lock_guard lock(mutex_);
  if (!packets_) packets_ = std::make_unique<PacketMaker>(forest_, splitModel_);
  return *packets_;
}

std::size_t Model::bytes() const {
  const SplitForest& f = forest_;
  const std::size_t forest =
      f.positions.capacity() * sizeof(glm::ivec3) +
      (f.baseTriangles.capacity() + f.triangles.capacity()) * sizeof(glm::uvec3) +
      (f.parents.capacity() + f.ringBegin.capacity() + f.rings.capacity()) * sizeof(VertexId) +
      f.cuts.capacity() * sizeof(RingCut) + f.features.capacity() + f.seams.capacity() +
      f.attributes.colors.capacity() * sizeof(SrgbColor) +
      f.attributes.normals.capacity() * sizeof(OctNormal) + f.moves.bytes() +
      f.bounds.capacity() * sizeof(SplitBounds) + smoothCones_.capacity() * sizeof(SplitCone);
  const std::lock_guard lock(mutex_);
  return sizeof(*this) + forest + (full_ ? full_->bytes() : 0) +
         (dependents_ ? dependents_->bytes() : 0) + (contours_[0] ? contours_[0]->bytes() : 0) +
         (contours_[1] ? contours_[1]->bytes() : 0) + (packets_ ? packets_->bytes() : 0);
}

std::vector<std::uint8_t> withChannel(Bytes message, std::uint8_t channel) {
  auto decoded = protocol::decodeMessage(message, protocol::Sender::kServer);
  const auto current = decoded ? protocol::channelOf(decoded->body) : std::nullopt;
  if (!current || *current == channel) return {message.begin(), message.end()};
  std::visit(
      [&](auto& body) {
        if constexpr (requires { body.channel = channel; }) body.channel = channel;
      },
      decoded->body);
  return protocol::encodeMessage(decoded->body);
}

}  // namespace limn
