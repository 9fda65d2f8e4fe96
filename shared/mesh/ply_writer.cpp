// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/ply_writer.h"

#include <bit>
#include <string>

namespace limn {

static_assert(std::endian::native == std::endian::little, "the file is little-endian");

std::vector<std::uint8_t> encodePly(
    const Grid& grid,
    std::span<const glm::ivec3> positions,
    std::span<const glm::uvec3> triangles) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(positions.size()) +
      "\nproperty double x\nproperty double y\nproperty double z\n"
      "property int qx\nproperty int qy\nproperty int qz\nelement face " +
      std::to_string(triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  std::vector<std::uint8_t> bytes(header.begin(), header.end());
  bytes.reserve(bytes.size() + 36 * positions.size() + 13 * triangles.size());
  const auto append = [&bytes](const auto& value) {
    const auto* begin = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), begin, begin + sizeof(value));
  };
  for (const glm::ivec3& p : positions) {
    append(grid.toModel(p));
    append(p);
  }
  for (const glm::uvec3& t : triangles) {
    bytes.push_back(3);
    append(t);
  }
  return bytes;
}

}  // namespace limn
