// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/ply_writer.h"

#include <bit>

namespace limn {

static_assert(std::endian::native == std::endian::little, "the file is little-endian");

std::string encodePly(
    const Grid& grid,
    std::span<const glm::ivec3> positions,
    std::span<const glm::uvec3> triangles,
    const AttributeArrays& attributes) {
  const bool hasColors = !attributes.colors.empty();
  const bool hasNormals = !attributes.normals.empty();
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                      std::to_string(positions.size()) +
                      "\nproperty double x\nproperty double y\nproperty double z\n"
                      "property int qx\nproperty int qy\nproperty int qz\n";
  if (hasColors) bytes += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (hasNormals) bytes += "property float nx\nproperty float ny\nproperty float nz\n";
  bytes += "element face " + std::to_string(triangles.size()) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
  bytes.reserve(bytes.size() + 51 * positions.size() + 13 * triangles.size());
  const auto append = [&bytes](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (std::size_t v = 0; v < positions.size(); ++v) {
    append(grid.toModel(positions[v]));
    append(positions[v]);
    if (hasColors) append(attributes.colors[v]);
    if (hasNormals) append(decodeNormal(attributes.normals[v]));
  }
  for (const glm::uvec3& t : triangles) {
    bytes.push_back(3);
    append(t);
  }
  return bytes;
}

}  // namespace limn
