// SPDX-License-Identifier: Apache-2.0
#include "server/inspect/rate_distortion.h"

#include "server/session/contour_search.h"

#include "protocol/framing.h"
#include "protocol/messages.h"

#include "shared/codec/draco_codec.h"
#include "shared/codec/split_codec.h"
#include "shared/core/camera.h"
#include "shared/progressive/active_mesh.h"
#include "shared/silhouette/contour_distance.h"
#include "shared/silhouette/visible_contour.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>

namespace limn {
namespace {

constexpr std::array<float, 6> kErrorsPx = {32.0F, 16.0F, 8.0F, 4.0F, 2.0F, 1.0F};
constexpr double kSpacingPx = 0.5;
constexpr int kDracoSpeed = 3;               // draco_encoder -cl 7
constexpr std::size_t kPacketSplits = 4096;  // as sessions do, about

/// Compares visible silhouettes with the full mesh's in one picture.
class ContourMeter {
 public:
  ContourMeter(const FullMesh& full, const PictureView& picture)
      : picture_(picture),
        limitPx_(std::hypot(picture.width, picture.height)),
        truth_(pixelsOf(finder_.find(full.field(SilhouetteKind::kSmooth), picture, kSpacingPx))),
        nearTruth_(truth_, picture.width, picture.height, limitPx_) {}

  /// 95th percentile of the distance, both ways, the worse. Pixels.
  [[nodiscard]] double errorOf(const ActiveMesh& client) {
    const SilhouetteField field(client.mesh(), client.positions(), SilhouetteKind::kSmooth);
    const std::vector<glm::vec2> mine = pixelsOf(finder_.find(field, picture_, kSpacingPx));
    if (mine.empty() || truth_.empty()) return mine.empty() == truth_.empty() ? 0.0 : limitPx_;
    const PixelPoints nearMine(mine, picture_.width, picture_.height, limitPx_);
    return std::max(percentile(mine, nearTruth_), percentile(truth_, nearMine));
  }

 private:
  static std::vector<glm::vec2> pixelsOf(std::span<const ContourPoint> points) {
    std::vector<glm::vec2> pixels;
    pixels.reserve(points.size());
    for (const ContourPoint& point : points)
      pixels.push_back(point.px);
    return pixels;
  }

  static double percentile(std::span<const glm::vec2> from, const PixelPoints& to) {
    std::vector<float> distances;
    distances.reserve(from.size());
    for (const glm::vec2& p : from)
      distances.push_back(to.distanceTo(p));
    const auto rank = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(distances.size() - 1));
    std::nth_element(distances.begin(), distances.begin() + rank, distances.end());
    return distances[static_cast<std::size_t>(rank)];
  }

  PictureView picture_;
  double limitPx_;
  VisibleContourFinder finder_;
  std::vector<glm::vec2> truth_;
  PixelPoints nearTruth_;
};

/// Eyes spread evenly over the sphere of viewpoints (a Fibonacci spiral), at 3 radii.
std::vector<protocol::Pose> posesAround(const Model& model, const RateDistortionOptions& options) {
  const BoundingSphere sphere{model.info().center, model.info().radius};
  std::vector<protocol::Pose> poses;
  for (int i = 0; i < options.views; ++i) {
    const double azimuth = std::fmod(360.0 * std::numbers::phi * i, 360.0);
    const double elevation =
        std::asin(2.0 * (i + 0.5) / options.views - 1.0) * 180.0 / std::numbers::pi;
    const Camera camera = orbitCamera(sphere, azimuth, elevation);
    protocol::Pose pose;
    pose.eye = camera.eye;
    pose.forward = camera.forward();
    pose.up = camera.up;
    pose.fovY = static_cast<float>(camera.fovDegrees * std::numbers::pi / 180.0);
    pose.width = pose.height = static_cast<std::uint16_t>(options.pictureSize);
    poses.push_back(pose);
  }
  return poses;
}

/// What every client receives before anything is chosen for it: info, base, level blocks.
std::uint64_t startBytes(const Model& model, const ByteAccount& account) {
  std::uint64_t bytes = protocol::webSocketFrameBytes(model.base().size());
  for (const SectionBytes& section : account.sections)
    bytes += section.name == sections::kInfo ? section.bytes : 0;
  for (const protocol::Bytes block : model.blocks())
    bytes += protocol::webSocketFrameBytes(block.size());
  return bytes;
}

std::vector<std::uint64_t> startSet(const SplitForest& forest, std::size_t blockLevels) {
  std::vector<std::uint64_t> held((std::size_t{forest.vertexCount()} + 63) / 64, 0);
  for (VertexId v = 0; v < forest.levelBegin[1 + blockLevels]; ++v)
    held[v / 64] |= std::uint64_t{1} << (v % 64);
  return held;
}

std::vector<VertexId> idsOf(const TargetSet& target) {
  std::vector<VertexId> ids;
  const auto& words = target.all();
  for (std::size_t w = 0; w < words.size(); ++w) {
    for (std::uint64_t bits = words[w]; bits != 0; bits &= bits - 1)
      ids.push_back(static_cast<VertexId>(64 * w) + static_cast<VertexId>(std::countr_zero(bits)));
  }
  return ids;
}

std::uint64_t packetBytes(const Model& model, std::span<const VertexId> ids) {
  std::uint64_t bytes = 0;
  for (; !ids.empty(); ids = ids.subspan(std::min(kPacketSplits, ids.size()))) {
    const auto splits = encodeSplits(
        model.forest(),
        model.splitModel(),
        ids.first(std::min(kPacketSplits, ids.size())));
    const auto attributes =
        encodeAttributes(model.forest(), ids.first(std::min(kPacketSplits, ids.size())));
    bytes += protocol::webSocketFrameBytes(
        protocol::encodeMessage(protocol::Packet{.splits = splits, .attributes = attributes})
            .size());
  }
  return bytes;
}

Result<std::uint64_t> dracoBytesOf(const ActiveMesh& mesh, const Grid& grid) {
  const auto positions = mesh.positions();
  const auto triangles = mesh.mesh().triangles();
  const auto draco = encodeDraco(
      {grid,
       {positions.begin(), positions.end()},
       {triangles.begin(), triangles.end()},
       mesh.attributes()},
      kDracoSpeed);
  if (!draco) return tl::unexpected(draco.error());
  return draco->bytes.size();
}

}  // namespace

Result<RateDistortion> measureRateDistortion(
    const Model& model,
    const ByteAccount& account,
    const RateDistortionOptions& options) {
  const SplitForest& forest = model.forest();
  const FullMesh* full = model.fullMesh();
  if (full == nullptr) {
    return fail(ErrorCode::kCorrupt, "the asset's mesh is no manifold; prepare the model again");
  }
  const std::vector<protocol::Pose> poses = posesAround(model, options);
  std::vector<ContourMeter> meters;
  for (const protocol::Pose& pose : poses)
    meters.emplace_back(*full, contourViewOf(pose, forest.grid).picture);
  const auto meanError = [&](const ActiveMesh& mesh) {
    double sum = 0.0;
    for (ContourMeter& meter : meters)
      sum += meter.errorOf(mesh);
    return sum / static_cast<double>(meters.size());
  };

  RateDistortion rates;
  const std::size_t blockLevels = model.blocks().size();
  std::uint64_t received = startBytes(model, account);
  for (std::size_t b = 0; b < blockLevels; ++b)
    received -= protocol::webSocketFrameBytes(model.blocks()[b].size());
  auto mesh = meshOf(forest, startSet(forest, 0));
  for (const LevelBytes& level : account.levels) {
    if (level.level > 0) {
      received += level.bytes;
      for (VertexId v = forest.levelBegin[level.level]; v < forest.levelBegin[level.level + 1];
           ++v) {
        if (auto applied = mesh.apply(forest.split(v)); !applied)
          return tl::unexpected(applied.error());
      }
    }
    const double contourPx = meanError(mesh);
    const auto draco = dracoBytesOf(mesh, forest.grid);
    if (!draco) return tl::unexpected(draco.error());
    rates.levels.push_back({received, level.faces, level.rmsError, contourPx});
    rates.lods.push_back({*draco, level.faces, level.rmsError, contourPx});
    rates.dracoBytes = *draco;  // the last level is the full mesh
  }

  const std::vector<std::uint64_t> start = startSet(forest, blockLevels);
  for (const float errorPx : kErrorsPx) {
    RatePoint mean;
    double bytes = 0.0;
    double faces = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      protocol::Pose pose = poses[i];
      pose.errorPx = errorPx;
      ContourSearch search(*full, contourViewOf(pose, forest.grid), start);
      search.run();
      const std::vector<VertexId> ids = idsOf(search.target());
      std::vector<std::uint64_t> held = start;
      for (const VertexId v : ids)
        held[v / 64] |= std::uint64_t{1} << (v % 64);
      const ActiveMesh client = meshOf(forest, held);
      bytes += static_cast<double>(startBytes(model, account) + packetBytes(model, ids));
      faces += client.mesh().faceCount();
      mean.contourPx += meters[i].errorOf(client) / static_cast<double>(poses.size());
    }
    mean.bytes = static_cast<std::uint64_t>(bytes / static_cast<double>(poses.size()));
    mean.faces = static_cast<std::uint32_t>(faces / static_cast<double>(poses.size()));
    rates.byPose.push_back(mean);
  }
  return rates;
}

}  // namespace limn
