// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/import/import.h"

#include "shared/core/result.h"
#include "shared/mesh/triangle_mesh.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace limn {

/// What repair did, by the report's kinds: dropped_faces, dropped_vertices, merged_vertices,
/// triangulated, flipped, split_vertices, filled_holes, blended_attributes. Kinds with nothing done
/// may be absent.
using RepairCounts = std::map<std::string, std::uint64_t>;

struct RepairOptions {
  int quantizationBits = 14;  // 11 to 18
};

/// What is streamed: an oriented manifold on the grid, without degenerate or duplicate faces or
/// isolated vertices; closed components outward, cavities inward. Faces whose three different
/// corners lie on one line remain: without them their neighbours would have holes.
struct RepairedMesh {
  TriangleMesh mesh;
  std::vector<std::uint8_t> seams;  // kFeatureSeam or 0 a half-edge; empty: the model has none
  RepairCounts repairs;
  // The input as imported, triangulated by fans: what the report's "input" says.
  std::uint64_t inputVertices = 0;
  std::uint64_t inputFaces = 0;
  std::uint32_t inputComponents = 0;
  bool inputClosed = false;
  bool closed = false;  // of the result
};

/// Quantises, then repairs, in the order that README.md gives and explains. Deterministic.
/// Errors: kCorrupt or kUnsupported when nothing drawable is left, with the reason.
[[nodiscard]] Result<RepairedMesh> repairMesh(
    const ImportedMesh& input,
    const RepairOptions& options);

}  // namespace limn
