// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/import/import.h"

#include "shared/mesh/triangle_mesh.h"

#include <glm/glm.hpp>

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// Writers of the formats that import reads, for tests: independent of the readers, simple, slow.
namespace limn::testing {

enum class PlyEncoding { kText, kLittleEndian, kBigEndian, kBigEndianDouble };

[[nodiscard]] std::string plyFile(const TriangleMesh& mesh, PlyEncoding encoding);
[[nodiscard]] std::string objFile(const TriangleMesh& mesh);
[[nodiscard]] std::string offFile(const TriangleMesh& mesh);
[[nodiscard]] std::string offBinaryFile(const TriangleMesh& mesh);
[[nodiscard]] std::string stlTextFile(const TriangleMesh& mesh);
[[nodiscard]] std::string stlBinaryFile(const TriangleMesh& mesh);
/// A GLB with one mesh in one node. indexBytes: 1, 2 or 4; 0: no indices.
[[nodiscard]] std::string glbFile(const TriangleMesh& mesh, int indexBytes);
/// Any JSON and binary chunk as a GLB.
[[nodiscard]] std::string glbContainer(std::string json, std::string binary);

struct NamedFile {
  std::string name;
  std::string extension;
  std::string bytes;
};

/// The mesh in every format.
[[nodiscard]] std::vector<NamedFile> everyFormat(const TriangleMesh& mesh);

using Corners = std::array<std::array<float, 3>, 3>;

/// Triangles as positions in float, each beginning with its least corner, sorted: equal for meshes
/// that differ in numbering only.
[[nodiscard]] std::vector<Corners> oriented(const TriangleMesh& mesh);
/// Polygons fanned; a triangle mesh stays as it is.
[[nodiscard]] std::vector<Corners> oriented(const ImportedMesh& mesh);

/// A file that is removed at the end of the scope.
class TemporaryFile {
 public:
  TemporaryFile(std::string_view name, std::string_view bytes);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path folder_;
  std::filesystem::path path_;
};

}  // namespace limn::testing
