// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "shared/core/result.h"

namespace limn {

/// A mesh as a file has it: real coordinates, polygons, nothing repaired. Attributes ride along
/// where the file has them.
struct ImportedMesh {
  std::string format;                      // "ply", "obj", "stl", "off", "glb", "gltf"
  std::vector<glm::dvec3> positions;
  std::vector<std::uint32_t> polygonBegin{0};  // polygons + 1 offsets into corners
  std::vector<std::uint32_t> corners;      // vertex indices, counter-clockwise from outside if known
  std::vector<glm::vec3> colors;           // empty, or one a vertex, linear 0 … 1
  std::vector<glm::vec3> normals;          // empty, or one a vertex
  std::uint32_t droppedFaces = 0;          // faces the reader had to leave out (counted as a repair)
};

/// Reads PLY (ASCII, both binaries, double), OBJ, STL (both), OFF, GLB/glTF; the format goes by
/// content first, then by extension. Sizes claimed by a header are checked against the file's length
/// before anything is allocated. Errors: kNotFound, kIo, kUnsupported, kCorrupt, kLimitExceeded,
/// each with what to do about it. Threads: reentrant.
[[nodiscard]] Result<ImportedMesh> importMesh(const std::filesystem::path& file);

}  // namespace limn
