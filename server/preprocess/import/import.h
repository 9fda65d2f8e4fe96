// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

/// A mesh as a file has it: real coordinates, polygons, nothing repaired. Attributes ride along
/// where the file has them.
struct ImportedMesh {
  std::string format;  // "ply", "obj", "stl", "off", "glb", "gltf"
  std::vector<glm::dvec3> positions;
  std::vector<std::uint32_t> polygonBegin{0};  // polygons + 1 offsets into corners
  std::vector<std::uint32_t> corners;     // vertex indices, counter-clockwise from outside if known
  std::vector<glm::vec3> colors;          // empty, or one a vertex, linear 0 … 1
  std::vector<glm::vec3> normals;         // empty, or one a vertex
  std::vector<std::uint32_t> materials;   // empty, or one a polygon: its material or face colour
  std::vector<glm::vec3> materialColors;  // empty, or by material, linear 0 … 1
  std::uint32_t droppedFaces = 0;         // faces the reader had to leave out (counted as a repair)
};

/// Larger files are refused: they are read whole, and no viewer of lines wants them.
inline constexpr std::uint64_t kMaxImportBytes = std::uint64_t{4} << 30;

/// Reads PLY (ASCII, both binaries, double), OBJ, STL (both), OFF, GLB/glTF; the format goes by
/// content first, then by extension. Sizes claimed by a header are checked against the file's
/// length before anything is allocated. Errors: kNotFound, kIo, kUnsupported, kCorrupt,
/// kLimitExceeded, each with what to do about it. Threads: reentrant.
[[nodiscard]] Result<ImportedMesh> importMesh(const std::filesystem::path& file);

/// The same for bytes in memory; `extension` (".obj") decides where the content does not. Total
/// over any bytes; memory is at most a small multiple of theirs. Errors: as above, without the
/// file's name.
[[nodiscard]] Result<ImportedMesh> importMesh(std::string_view bytes, std::string_view extension);

}  // namespace limn
