// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/import/import.h"
#include "tests/unit/server/preprocess/import/mesh_files.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

namespace limn {
namespace {

using testing::glbContainer;

/// Five points (a unit square and one beyond) as floats, then the indices 0 … 4 as 16-bit.
std::string fivePoints() {
  const float positions[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 2, 0};
  const std::uint16_t indices[5] = {0, 1, 2, 3, 4};
  std::string binary(reinterpret_cast<const char*>(positions), sizeof positions);
  binary.append(reinterpret_cast<const char*>(indices), sizeof indices);
  return binary;
}

/// A scene with those points; what differs is given.
struct Scene {
  std::string nodes = R"([{"mesh":0}])";
  std::string primitive = R"({"attributes":{"POSITION":0},"indices":1})";
  std::string accessors =
      R"([{"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}])";
  std::string views =
      R"([{"buffer":0,"byteLength":60},{"buffer":0,"byteOffset":60,"byteLength":10}])";
  std::string buffers = R"([{"byteLength":70}])";
  std::string more;

  [[nodiscard]] std::string glb() const {
    return glbContainer(
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
            R"(,"meshes":[{"primitives":[)" + primitive + R"(]}],"accessors":)" + accessors +
            R"(,"bufferViews":)" + views + R"(,"buffers":)" + buffers + more + "}",
        fivePoints());
  }
};

ImportedMesh loaded(const Scene& scene) {
  auto mesh = importMesh(scene.glb(), ".glb");
  EXPECT_TRUE(mesh.has_value()) << (mesh ? "" : mesh.error().message);
  return mesh ? *mesh : ImportedMesh{};
}

std::string refusal(const Scene& scene) {
  const auto mesh = importMesh(scene.glb(), ".glb");
  EXPECT_FALSE(mesh.has_value());
  return mesh ? "" : mesh.error().message;
}

TEST(ImportGltf, AppliesNodeTransformsDownTheTree) {
  Scene scene;
  scene.nodes =
      R"([{"children":[1],"translation":[10,0,0]},{"mesh":0,"scale":[2,2,2],"rotation":[0,0,0.70710678118654757,0.70710678118654757]}])";
  const ImportedMesh mesh = loaded(scene);
  ASSERT_EQ(mesh.positions.size(), 3U);
  EXPECT_NEAR(mesh.positions[1].x, 10.0, 1e-12);
  EXPECT_NEAR(mesh.positions[1].y, 2.0, 1e-12);
  EXPECT_NEAR(mesh.positions[2].x, 8.0, 1e-12);
}

TEST(ImportGltf, MirroringKeepsFacesOutward) {
  Scene scene;
  EXPECT_EQ(loaded(scene).corners, (std::vector<std::uint32_t>{0, 1, 2}));
  scene.nodes = R"([{"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}])";
  const ImportedMesh mirrored = loaded(scene);
  EXPECT_EQ(mirrored.positions[mirrored.corners[1]], glm::dvec3(0, 1, 0));
  EXPECT_EQ(mirrored.positions[mirrored.corners[2]], glm::dvec3(-1, 0, 0));
}

TEST(ImportGltf, ReadsStripsAndFans) {
  Scene scene;
  scene.accessors =
      R"([{"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":5,"type":"SCALAR"}])";
  scene.primitive = R"({"attributes":{"POSITION":0},"indices":1,"mode":5})";
  EXPECT_EQ(loaded(scene).corners, (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2, 2, 3, 4}));
  scene.primitive = R"({"attributes":{"POSITION":0},"indices":1,"mode":6})";
  EXPECT_EQ(loaded(scene).corners, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 0, 3, 4}));
  scene.primitive = R"({"attributes":{"POSITION":0},"mode":5})";
  EXPECT_EQ(loaded(scene).polygonBegin.size(), 4U);
  scene.primitive = R"({"attributes":{"POSITION":0},"mode":1})";
  EXPECT_NE(refusal(scene).find("no triangles"), std::string::npos);
}

TEST(ImportGltf, CyclesAndSharedNodesAreRefused) {
  Scene scene;
  scene.nodes = R"([{"mesh":0,"children":[0]}])";
  EXPECT_NE(refusal(scene).find("own ancestor"), std::string::npos);
  scene.nodes = R"([{"children":[1,1]},{"mesh":0}])";
  EXPECT_NE(refusal(scene).find("two parents"), std::string::npos);
  scene.nodes = R"([{"mesh":0,"children":[7]}])";
  (void)refusal(scene);
  scene.nodes = R"([{"mesh":3}])";
  (void)refusal(scene);
}

TEST(ImportGltf, OverrunsAreRefused) {
  for (
      const char* views :
      {R"([{"buffer":0,"byteLength":61440},{"buffer":0,"byteOffset":60,"byteLength":10}])",
       R"([{"buffer":0,"byteOffset":18446744073709551600,"byteLength":60},{"buffer":0,"byteOffset":60,"byteLength":10}])",
       R"([{"buffer":0,"byteLength":59},{"buffer":0,"byteOffset":60,"byteLength":10}])",
       R"([{"buffer":9,"byteLength":60},{"buffer":0,"byteOffset":60,"byteLength":10}])",
       R"([{"buffer":0,"byteLength":60,"byteStride":252},{"buffer":0,"byteOffset":60,"byteLength":10}])",
       R"([])"}) {
    Scene scene;
    scene.views = views;
    (void)refusal(scene);
  }
  for (const char* accessor :
       {R"("componentType":5126,"count":4000000000,"type":"VEC3")",
        R"("componentType":5126,"count":-1,"type":"VEC3")",
        R"("componentType":5126,"count":5,"byteOffset":4,"type":"VEC3")",
        R"("componentType":5126,"count":5,"type":"MAT4")",
        R"("componentType":99,"count":5,"type":"VEC3")",
        R"("componentType":5126,"count":0,"type":"VEC3")",
        R"("componentType":5126,"count":5,"type":"SCALAR")"}) {
    Scene scene;
    scene.accessors = std::string(R"([{"bufferView":0,)") + accessor +
                      R"(},{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}])";
    (void)refusal(scene);
  }
}

TEST(ImportGltf, RequiredExtensionsThatHideGeometryAreRefusedByName) {
  Scene scene;
  scene.more = R"(,"extensionsRequired":["KHR_draco_mesh_compression"])";
  EXPECT_NE(refusal(scene).find("KHR_draco_mesh_compression"), std::string::npos);
  scene.more = R"(,"extensionsRequired":["EXT_unknown"])";
  EXPECT_NE(refusal(scene).find("EXT_unknown"), std::string::npos);
  scene.more = R"(,"extensionsRequired":["KHR_mesh_quantization","KHR_materials_unlit"])";
  EXPECT_EQ(loaded(scene).corners.size(), 3U);
}

TEST(ImportGltf, NothingOutsideTheFileIsOpened) {
  Scene scene;
  scene.buffers = R"([{"byteLength":70,"uri":"/etc/hostname"}])";
  EXPECT_NE(refusal(scene).find("another file"), std::string::npos);
}

TEST(ImportGltf, TextWithAnEmbeddedBufferIsRead) {
  // One triangle: nine floats, base64.
  const std::string gltf =
      R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
      R"("buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
  const auto mesh = importMesh(gltf, ".gltf");
  ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
  EXPECT_EQ(mesh->format, "gltf");
  EXPECT_EQ(mesh->positions[1], glm::dvec3(1, 0, 0));
}

TEST(ImportGltf, PicturesAndExtrasAreNotLookedAt) {
  Scene scene;
  scene.more =
      R"(,"images":[{"bufferView":77,"mimeType":"image/png"}],"materials":5,"extras":[[[[]]]])";
  EXPECT_EQ(loaded(scene).corners.size(), 3U);
}

TEST(ImportGltf, EndlessNestingIsRefused) {
  Scene scene;
  scene.more = R"(,"deep":)" + std::string(100000, '[') + std::string(100000, ']');
  EXPECT_NE(refusal(scene).find("nested"), std::string::npos);
}

TEST(ImportGltf, InstancesCannotOutgrowMemory) {
  // 600 instances of a strip that names its vertices 1,000,000 times.
  Scene scene;
  std::string nodes = "[{\"children\":[";
  std::string leaves;
  for (int i = 1; i <= 600; ++i) {
    nodes += (i > 1 ? "," : "") + std::to_string(i);
    leaves += ",{\"mesh\":0}";
  }
  scene.nodes = nodes + "]}" + leaves + "]";
  std::string binary = fivePoints();
  binary.resize(60 + 500000, '\0');
  scene.primitive = R"({"attributes":{"POSITION":0},"indices":1,"mode":5})";
  scene.accessors =
      R"([{"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"},{"bufferView":1,"componentType":5121,"count":500000,"type":"SCALAR"}])";
  scene.views =
      R"([{"buffer":0,"byteLength":60},{"buffer":0,"byteOffset":60,"byteLength":500000}])";
  scene.buffers = R"([{"byteLength":500060}])";
  std::string json = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" +
                     scene.nodes + R"(,"meshes":[{"primitives":[)" + scene.primitive +
                     R"(]}],"accessors":)" + scene.accessors + R"(,"bufferViews":)" + scene.views +
                     R"(,"buffers":)" + scene.buffers + "}";
  const auto mesh = importMesh(glbContainer(json, binary), ".glb");
  ASSERT_FALSE(mesh.has_value());
  EXPECT_EQ(mesh.error().code, ErrorCode::kLimitExceeded);
}

}  // namespace
}  // namespace limn
