// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/map_sections.h"

#include "server/preprocess/maps/png.h"

#include "protocol/framing.h"
#include "protocol/limits.h"

#include "shared/codec/hull_codec.h"
#include "shared/progressive/progressive_hull.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr std::size_t kPieceBytes = 16 * 1024;

/// The outer hull as clients decode it: vertices and faces are numbered by the stream.
Result<TriangleMesh>
decodedLevel(const HullSections& hulls, const Grid& modelGrid, std::uint32_t faces) {
  Grid grid = modelGrid;
  grid.step = std::ldexp(grid.step, -hulls.info.extraBits);
  grid.bits += hulls.info.extraBits;
  std::optional<HullDecoder> decoder;
  protocol::FrameReader frames(hulls.outer);
  while (true) {
    const auto frame = frames.next();
    if (!frame) return tl::unexpected(frame.error());
    if (!*frame) break;
    const auto message = protocol::decodeMessage(**frame, protocol::Sender::kServer);
    if (!message) return tl::unexpected(message.error());
    if (const auto* base = message->as<protocol::Hull>()) {
      auto begun = HullDecoder::begin(base->draco, grid, hulls.info.outerBase);
      if (!begun) return tl::unexpected(begun.error());
      decoder = std::move(*begun);
    } else if (const auto* splits = message->as<protocol::HullSplits>(); splits && decoder) {
      const ProgressiveHull& hull = decoder->hull();
      if (hull.splitsFor(faces) < hull.splits.size()) break;
      const std::size_t most =
          (hulls.info.outerFinest - hulls.info.outerBase) / 2 - hull.splits.size();
      if (auto ok = decoder->addPiece(splits->splits, most); !ok) return tl::unexpected(ok.error());
    }
  }
  if (!decoder) return fail(ErrorCode::kCorrupt, "the hull has no base");
  return hullAfter(decoder->hull(), decoder->hull().splitsFor(faces));
}

}  // namespace

MapSections encodeMapSections(
    const TriangleMesh& mesh,
    const HullSections& hulls,
    std::uint32_t faces,
    const NormalMapOptions& options) {
  MapSections sections;
  if (hulls.outer.empty()) return sections;
  const auto level = decodedLevel(hulls, mesh.grid, std::min(faces, limits::kMaxMapFaces));
  if (!level || level->triangles.size() > limits::kMaxMapFaces) return sections;
  const NormalMap map = shootNormals(mesh, *level, options);
  const auto png = encodePng(map.layout.width(), map.layout.height(), 2, map.codes);
  if (png.empty() || png.size() > limits::kMaxMapBytes) return sections;
  std::uint32_t piece = 0;
  for (std::size_t at = 0; at < png.size(); at += kPieceBytes) {
    const auto bytes = std::span(png).subspan(at, std::min(kPieceBytes, png.size() - at));
    protocol::appendFrame(
        sections.normals,
        protocol::encodeMessage(protocol::Map{0, protocol::MapKind::kNormals, piece++, bytes}));
  }
  sections.info = protocol::MapInfo{
      map.layout.faces,
      static_cast<std::uint16_t>(map.layout.leg),
      static_cast<std::uint32_t>(png.size())};
  return sections;
}

}  // namespace limn
