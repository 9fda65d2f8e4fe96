// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/ply_writer.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <cstring>

namespace limn {
namespace {

template <class Value>
Value at(const std::string& bytes, std::size_t place) {
  Value value{};
  std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
}

TEST(PlyWriter, HasPositionsInModelUnitsAndOnTheGrid) {
  TriangleMesh mesh = primitives::tetrahedron();
  mesh.grid.origin = {10.0, 20.0, 30.0};
  mesh.grid.step = 0.5;
  const std::string bytes = encodePly(mesh.grid, mesh.positions, mesh.triangles);
  const std::size_t body = bytes.find("end_header\n") + std::strlen("end_header\n");
  ASSERT_EQ(bytes.size(), body + 4 * 36 + 4 * 13);
  EXPECT_EQ(bytes.find("red"), std::string::npos);
  for (std::size_t v = 0; v < 4; ++v) {
    const std::size_t vertex = body + 36 * v;
    EXPECT_EQ(at<glm::ivec3>(bytes, vertex + 24), mesh.positions[v]);
    EXPECT_EQ(at<glm::dvec3>(bytes, vertex), mesh.grid.toModel(mesh.positions[v]));
  }
  EXPECT_EQ(bytes[body + 4 * 36], 3);
  EXPECT_EQ(at<glm::uvec3>(bytes, body + 4 * 36 + 1), mesh.triangles[0]);
}

TEST(PlyWriter, HasColoursAndNormalsWhereTheMeshDoes) {
  TriangleMesh mesh = primitives::tetrahedron();
  mesh.attributes.colors.assign(4, SrgbColor(1, 2, 3));
  mesh.attributes.normals.assign(4, encodeNormal({0.0, 0.0, 1.0}));
  const std::string bytes = encodePly(mesh.grid, mesh.positions, mesh.triangles, mesh.attributes);
  const std::size_t body = bytes.find("end_header\n") + std::strlen("end_header\n");
  ASSERT_EQ(bytes.size(), body + 4 * (36 + 3 + 12) + 4 * 13);
  EXPECT_EQ(at<SrgbColor>(bytes, body + 36), SrgbColor(1, 2, 3));
  EXPECT_EQ(at<glm::vec3>(bytes, body + 39), glm::vec3(0.0F, 0.0F, 1.0F));
}

}  // namespace
}  // namespace limn
