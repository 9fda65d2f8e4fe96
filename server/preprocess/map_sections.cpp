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

/// A PNG in pieces. Empty: it has no right to be streamed.
struct Pieces {
  std::vector<std::uint8_t> section;
  std::uint32_t bytes = 0;  // of the PNG
  std::optional<protocol::SectionHash> hash;
};

Pieces piecesOf(protocol::MapKind kind, const std::vector<std::uint8_t>& png) {
  Pieces pieces;
  if (png.empty() || png.size() > limits::kMaxMapBytes) return pieces;
  std::uint32_t piece = 0;
  for (std::size_t at = 0; at < png.size(); at += kPieceBytes) {
    const auto bytes = std::span(png).subspan(at, std::min(kPieceBytes, png.size() - at));
    protocol::appendFrame(
        pieces.section,
        protocol::encodeMessage(protocol::Map{0, kind, piece++, bytes}));
  }
  pieces.bytes = static_cast<std::uint32_t>(png.size());
  pieces.hash = protocol::sectionHash(png);
  return pieces;
}

}  // namespace

MapSections encodeMapSections(
    const TriangleMesh& mesh,
    const HullSections& hulls,
    std::uint32_t faces,
    const MapOptions& options) {
  MapSections sections;
  if (hulls.outer.empty()) return sections;
  const auto level = decodedLevel(hulls, mesh.grid, std::min(faces, limits::kMaxMapFaces));
  if (!level || level->triangles.size() > limits::kMaxMapFaces) return sections;
  const HullMaps maps = shootMaps(mesh, *level, options);
  const int width = maps.layout.width();
  const int height = maps.layout.height();
  Pieces normals = piecesOf(protocol::MapKind::kNormals, encodePng(width, height, 2, maps.normals));
  if (normals.bytes == 0) return sections;
  Pieces colors;
  if (!maps.colors.empty())
    colors = piecesOf(protocol::MapKind::kColors, encodePng(width, height, 3, maps.colors));
  sections.normals = std::move(normals.section);
  sections.colors = std::move(colors.section);
  sections.info = protocol::MapInfo{
      maps.layout.faces,
      static_cast<std::uint16_t>(maps.layout.leg),
      normals.bytes,
      colors.bytes,
      normals.hash,
      colors.hash};
  return sections;
}

}  // namespace limn
