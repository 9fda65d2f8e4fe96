// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/import/import.h"

#include "shared/core/result.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

// One reader a format, all over a file that is wholly in memory: what a header claims can then be
// compared with the bytes that are left. Each is total over any bytes, allocates no more than a
// small multiple of them, and leaves corners that no vertex can have as kNone for importMesh to
// drop. README.md, "Import", says why they are ours where OpenMesh has one.
namespace limn::import {

[[nodiscard]] Result<ImportedMesh> readPly(std::string_view bytes);
[[nodiscard]] Result<ImportedMesh> readObj(std::string_view text);
[[nodiscard]] Result<ImportedMesh> readStlBinary(std::string_view bytes);
[[nodiscard]] Result<ImportedMesh> readStlText(std::string_view text);
[[nodiscard]] Result<ImportedMesh> readOff(std::string_view bytes);
/// GLB by its magic, else glTF text. Buffers must be inside the file: nothing else is opened.
[[nodiscard]] Result<ImportedMesh> readGltf(std::string_view bytes);

/// Ends the polygon whose corners were pushed since the last end; fewer than three make no face.
void endPolygon(ImportedMesh& mesh);

/// Gives the polygons that have ended since the last call a material.
void endMaterial(ImportedMesh& mesh, std::uint32_t material);

/// A vertex index as a file has it; kNone for what can be none.
[[nodiscard]] std::uint32_t vertexIndex(double value);

/// 8-bit and text colours are sRGB by convention: linear from there.
[[nodiscard]] float linearFromSrgb(double value);

/// "line 12: what".
[[nodiscard]] std::string atLine(std::size_t line, std::string_view what);

}  // namespace limn::import
