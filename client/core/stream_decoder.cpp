// SPDX-License-Identifier: Apache-2.0
#include "client/core/stream_decoder.h"

#include "protocol/base_features.h"
#include "protocol/limits.h"

#include "shared/codec/draco_codec.h"
#include "shared/codec/seed_codec.h"

#include <string>
#include <utility>

namespace limn {
namespace {

ModelDescription describe(const protocol::ModelInfo& info) {
  ModelDescription model;
  model.name = std::string(info.name);
  model.asset = info.asset;
  model.grid.origin = info.gridOrigin;
  model.grid.step = info.gridStep;
  model.grid.bits = info.gridBits;
  model.sphere.center = info.center;
  model.sphere.radius = info.radius;
  model.vertices = info.vertices;
  model.faces = info.faces;
  model.closed = info.closed;
  model.attributeKinds = info.attributes;
  if (info.hull) {
    model.hull = HullDescription{
        {info.hull->outerBase, info.hull->outerFinest},
        {info.hull->innerBase, info.hull->innerFinest},
        info.hull->extraBits,
        std::string(info.hull->reason),
        {info.hull->outerHash, info.hull->innerHash}};
  }
  if (info.maps) {
    model.maps = MapLayout{info.maps->faces, info.maps->leg};
    model.mapFiles = {
        {{info.maps->normalBytes, info.maps->normalHash},
         {info.maps->colorBytes, info.maps->colorHash}}};
  }
  model.baseHash = info.baseHash;
  return model;
}

Result<void> checkOnGrid(const TriangleMesh& mesh, int bits) {
  const int side = 1 << bits;
  for (const glm::ivec3& p : mesh.positions) {
    if (p.x < 0 || p.y < 0 || p.z < 0 || p.x >= side || p.y >= side || p.z >= side) {
      return fail(ErrorCode::kCorrupt, "a position of the base mesh lies off the model's grid");
    }
  }
  return {};
}

}  // namespace

Result<void> StreamDecoder::beginModel(const protocol::ModelInfo& info) {
  auto splitModel = parseSplitModel(info.splitModel, static_cast<Placement>(info.placement));
  if (!splitModel) return tl::unexpected(splitModel.error().within("split coder of the model"));
  const bool same = model_ && model_->asset == info.asset && levelBegin_ == info.levelBegin;
  if (!same) drop();
  model_ = describe(info);
  levelBegin_ = info.levelBegin;
  blockLevels_ = info.blockLevels;
  splits_ = SplitDecoder(std::move(*splitModel), info.attributes);
  seedBytesExpected_ = info.seedBytes;
  return {};
}

Result<void> StreamDecoder::take(const protocol::Base& message) {
  if (!model_) return fail(ErrorCode::kProtocol, "a base mesh came before the model's description");
  if (hasBase_) return fail(ErrorCode::kProtocol, "a second base mesh came");
  if (model_->baseHash &&
      protocol::sectionHash(message.draco, message.features) != *model_->baseHash)
    return fail(ErrorCode::kCorrupt, "the base mesh is not what its hash says");
  auto base = decodeDraco(message.draco, levelBegin_[1], model_->faces);
  if (!base) return tl::unexpected(base.error().within("base mesh"));
  if (auto onGrid = checkOnGrid(*base, model_->grid.bits); !onGrid) {
    return tl::unexpected(onGrid.error());
  }
  if (base->attributes.kinds() != (model_->attributeKinds & ~kAttributeSeams)) {
    return fail(
        ErrorCode::kCorrupt,
        "the base mesh has other attributes than the model's description says");
  }
  base->grid = model_->grid;
  auto features = protocol::unpackBaseFeatures(
      message.features,
      static_cast<std::uint32_t>(3 * base->triangles.size()));
  if (!features) return tl::unexpected(features.error());
  auto mesh = ActiveMesh::fromBase(levelBegin_, *base, *features);
  if (!mesh) return tl::unexpected(mesh.error().within("base mesh"));
  mesh_ = std::move(*mesh);
  hasBase_ = true;
  ++revision_;
  return {};
}

Result<void> StreamDecoder::take(const protocol::LevelBlock& message) {
  if (!hasBase_) return fail(ErrorCode::kProtocol, "a level block came before the base mesh");
  if (message.level > blockLevels_) {
    return fail(
        ErrorCode::kProtocol,
        "level " + std::to_string(message.level) + " does not travel as a level block");
  }
  return takeSplits(message.splits, message.attributes);
}

Result<void> StreamDecoder::take(const protocol::Packet& message) {
  if (!hasBase_) return fail(ErrorCode::kProtocol, "a packet came before the base mesh");
  return takeSplits(message.splits, message.attributes);
}

Result<void> StreamDecoder::take(const protocol::Seeds& message) {
  if (!model_) return fail(ErrorCode::kProtocol, "seeds came before the model's description");
  if (message.offset != seedBytesHeld_ || (message.total == 0 && seedBytesHeld_ != 0) || seeds_) {
    return fail(ErrorCode::kProtocol, "a piece of the seeds that does not go on where they ended");
  }
  protocol::Bytes whole = message.seeds;
  if (message.total != 0) {
    seedPieces_.insert(seedPieces_.end(), message.seeds.begin(), message.seeds.end());
    seedBytesHeld_ = static_cast<std::uint32_t>(seedPieces_.size());
    if (seedBytesHeld_ < message.total) return {};
    whole = seedPieces_;
  }
  auto seeds = decodeSeeds(whole, model_->vertices);
  if (!seeds) return tl::unexpected(seeds.error().within("silhouette seeds"));
  seedBytesHeld_ = static_cast<std::uint32_t>(whole.size());
  seedPieces_ = {};
  seeds_ = std::make_shared<const SeedTable>(std::move(*seeds));
  ++revision_;
  return {};
}

Result<void> StreamDecoder::take(const protocol::Hull& message) {
  if (!model_) return fail(ErrorCode::kProtocol, "a hull came before the model's description");
  ++revision_;
  return hulls_.take(message, *model_);
}

Result<void> StreamDecoder::take(const protocol::HullSplits& message) {
  if (!model_) return fail(ErrorCode::kProtocol, "a hull came before the model's description");
  ++revision_;
  return hulls_.take(message, *model_);
}

Result<void> StreamDecoder::take(const protocol::Map& message) {
  if (!model_) return fail(ErrorCode::kProtocol, "a map came before the model's description");
  ++revision_;
  return maps_.take(message, *model_);
}

bool StreamDecoder::restoreMap(protocol::MapKind kind, std::vector<std::uint8_t> png) {
  if (!model_ || !maps_.restore(kind, std::move(png), *model_)) return false;
  ++revision_;
  return true;
}

Result<void> StreamDecoder::take(const protocol::Contour& message) {
  if (!model_) return fail(ErrorCode::kProtocol, "a contour came before the model's description");
  auto lines = decodeContour(message.lines, limits::kMaxContourPoints);
  if (!lines) return tl::unexpected(lines.error());
  contour_ = std::make_shared<const ExactContour>(ExactContour{message.id, std::move(*lines)});
  ++revision_;
  return {};
}

Result<void> StreamDecoder::undo(std::span<const VertexId> ids) {
  ++revision_;
  for (std::size_t i = ids.size(); i-- > 0;) {
    if (auto undone = mesh_.undo(ids[i]); !undone) {
      return fail(ErrorCode::kProtocol, undone.error().message);
    }
  }
  return {};
}

Result<void> StreamDecoder::takeSplits(protocol::Bytes splits, protocol::Bytes attributes) {
  // Even a run that fails half-way may have changed the mesh.
  ++revision_;
  const auto applied = splits_.decode(splits, mesh_, attributes);
  if (!applied) return tl::unexpected(applied.error().within("vertex splits"));
  if (complete() && mesh_.mesh().faceCount() != model_->faces) {
    return fail(
        ErrorCode::kCorrupt,
        "the complete mesh has " + std::to_string(mesh_.mesh().faceCount()) +
            " faces, the model's description says " + std::to_string(model_->faces));
  }
  return {};
}

void StreamDecoder::drop() {
  model_.reset();
  levelBegin_.clear();
  blockLevels_ = 0;
  splits_ = {};
  mesh_ = {};
  hasBase_ = false;
  seeds_.reset();
  seedBytesExpected_ = 0;
  seedBytesHeld_ = 0;
  seedPieces_ = {};
  hulls_ = {};
  maps_ = {};
  contour_.reset();
  ++revision_;
}

std::shared_ptr<const MeshSnapshot> StreamDecoder::snapshot() const {
  auto snapshot = std::make_shared<MeshSnapshot>();
  if (model_) snapshot->model = *model_;
  snapshot->mesh = mesh_;
  snapshot->seeds = seeds_;
  snapshot->outerHull = hulls_.hull(protocol::HullSide::kOuter);
  snapshot->innerHull = hulls_.hull(protocol::HullSide::kInner);
  snapshot->normalMap = maps_.map(protocol::MapKind::kNormals);
  snapshot->colorMap = maps_.map(protocol::MapKind::kColors);
  snapshot->contour = contour_;
  snapshot->revision = revision_;
  return snapshot;
}

}  // namespace limn
