// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/import/import.h"

#include "tests/unit/server/preprocess/import/mesh_files.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <string>

namespace limn {
namespace {

using testing::everyFormat;
using testing::oriented;

ImportedMesh loaded(std::string_view bytes, std::string_view extension) {
  auto mesh = importMesh(bytes, extension);
  EXPECT_TRUE(mesh.has_value()) << (mesh ? "" : mesh.error().message);
  return mesh ? *mesh : ImportedMesh{};
}

ErrorCode refused(std::string_view bytes, std::string_view extension) {
  const auto mesh = importMesh(bytes, extension);
  EXPECT_FALSE(mesh.has_value());
  if (mesh) return ErrorCode::kCancelled;
  EXPECT_EQ(mesh.error().message.find('\n'), std::string::npos) << mesh.error().message;
  EXPECT_GT(mesh.error().message.size(), 20U);
  return mesh.error().code;
}

std::uint32_t polygons(const ImportedMesh& mesh) {
  return static_cast<std::uint32_t>(mesh.polygonBegin.size() - 1);
}

TEST(Import, EveryFormatGivesTheMeshThatWasWritten) {
  for (const TriangleMesh& shape :
       {primitives::cube(), primitives::torus(12, 7), primitives::openGrid(5, 4)}) {
    for (const testing::NamedFile& file : everyFormat(shape)) {
      EXPECT_EQ(oriented(loaded(file.bytes, file.extension)), oriented(shape)) << file.name;
    }
  }
  EXPECT_EQ(
      oriented(loaded(testing::glbFile(primitives::cube(), 1), ".glb")),
      oriented(primitives::cube()));
}

TEST(Import, ContentDecidesBeforeTheExtension) {
  for (const testing::NamedFile& file : everyFormat(primitives::cube())) {
    for (const char* extension : {".txt", ".PLY", ".obj", ".stl", ""}) {
      EXPECT_EQ(polygons(loaded(file.bytes, extension)), 12U) << file.name << " as " << extension;
    }
  }
}

TEST(Import, EveryTruncationIsRefusedOrGivesValidIndices) {
  for (const testing::NamedFile& file : everyFormat(primitives::tetrahedron())) {
    for (std::size_t length = 0; length < file.bytes.size(); ++length) {
      const auto mesh = importMesh(std::string_view(file.bytes).substr(0, length), file.extension);
      if (!mesh) continue;
      for (const std::uint32_t corner : mesh->corners)
        ASSERT_LT(corner, mesh->positions.size()) << file.name;
    }
  }
}

TEST(Import, CutBinaryFilesAreRefused) {
  for (const testing::NamedFile& file : everyFormat(primitives::tetrahedron())) {
    if (file.name.find("text") != std::string::npos || file.name == "OBJ" || file.name == "OFF")
      continue;
    for (std::size_t length = 1; length < file.bytes.size(); length += 3) {
      EXPECT_FALSE(
          importMesh(std::string_view(file.bytes).substr(0, length), file.extension).has_value())
          << file.name << " cut to " << length;
    }
  }
}

TEST(Import, FilesAreReadAndNamedInErrors) {
  const testing::TemporaryFile good("ünïcode näme.obj", testing::objFile(primitives::cube()));
  const auto mesh = importMesh(good.path());
  ASSERT_TRUE(mesh.has_value());
  EXPECT_EQ(polygons(*mesh), 12U);
  const testing::TemporaryFile bad("broken.ply", "ply\n");
  const auto failed = importMesh(bad.path());
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().message.rfind("broken.ply: ", 0), 0U) << failed.error().message;
  EXPECT_EQ(
      importMesh(std::filesystem::path("/no/such/file.ply")).error().code,
      ErrorCode::kNotFound);
  EXPECT_EQ(importMesh(std::filesystem::temp_directory_path()).error().code, ErrorCode::kIo);
}

TEST(Import, ForeignFilesAreNamedForWhatTheyAre) {
  const auto message = [](std::string_view bytes) {
    return importMesh(bytes, ".obj").error().message;
  };
  EXPECT_NE(message("\x89PNG\r\n\x1a\n.........").find("PNG"), std::string::npos);
  EXPECT_NE(message("\x1f\x8b.........").find("gunzip"), std::string::npos);
  EXPECT_NE(
      message(std::string_view("\xFE\xFF\0v\0 \0001\0 \0002", 12)).find("UTF-8"),
      std::string::npos);
  EXPECT_NE(
      message(std::string_view("v\0 \0001\0 \0002\0 \0003\0\n\0v\0 \0", 22)).find("UTF-8"),
      std::string::npos);
  EXPECT_NE(message("").find("empty"), std::string::npos);
}

TEST(Import, MostlyBadFacesRefuseTheFile) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(loaded(vertices + "f 1 2 3\nf 1 2 9\n", ".obj").droppedFaces, 1U);
  EXPECT_EQ(refused(vertices + "f 1 2 3\nf 1 2 9\nf 1 2 0\n", ".obj"), ErrorCode::kCorrupt);
}

// OBJ

TEST(ImportObj, ReadsEveryFormOfAFace) {
  const ImportedMesh mesh = loaded(
      "\xEF\xBB\xBF# comment\r\nv 0 0 0\r\nv 1 0 0 # trailing\r\nv 1 1 0 1.0\r\n\tv 0 1 0\r\nvt 0 "
      "0\r\nvn 0 0 1\r\n"
      "o name\r\ng a b\r\ns off\r\nusemtl x\r\n"
      "f 1 2 3 4\r\nf 1/1 2/1 3/1\r\nf 1//1 2//1 3//1\r\nf 1/1/1 2/1/1 \\\r\n 3/1/1\r\nf -4 -3 -2 "
      "-1",
      ".obj");
  EXPECT_EQ(mesh.positions.size(), 4U);
  EXPECT_EQ(mesh.polygonBegin, (std::vector<std::uint32_t>{0, 4, 7, 10, 13, 17}));
  EXPECT_EQ(
      (std::vector<std::uint32_t>(mesh.corners.end() - 4, mesh.corners.end())),
      (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.droppedFaces, 0U);
}

TEST(ImportObj, KeepsDoubles) {
  const ImportedMesh mesh = loaded("v 500000.123456789 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ".obj");
  EXPECT_EQ(mesh.positions[0].x, 500000.123456789);
}

TEST(ImportObj, RelativeIndicesCountFromWhereTheyStand) {
  const ImportedMesh mesh =
      loaded("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -4 -3 -1\nf -9 1 2\n", ".obj");
  EXPECT_EQ(mesh.corners, (std::vector<std::uint32_t>{0, 1, 2, 0, 1, 3}));
  EXPECT_EQ(mesh.droppedFaces, 1U);
}

TEST(ImportObj, BadIndicesDropTheFaceOnly) {
  const std::string good = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3 2 1\n";
  for (const char* face :
       {"f 0 1 2",
        "f 1 2 99999999999999999999999",
        "f 1 2 4",
        "f 1 2",
        "f 1 2 x",
        "f",
        "f 1.5 2 3"}) {
    const ImportedMesh mesh = loaded(good + face, ".obj");
    EXPECT_EQ(polygons(mesh), 2U) << face;
    EXPECT_EQ(mesh.droppedFaces, 1U) << face;
  }
}

TEST(ImportObj, BadVerticesRefuseTheFile) {
  for (const char* vertex : {"v 1 2", "v a b c", "v 1e400 0 0", "v"}) {
    EXPECT_EQ(
        refused(std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\n") + vertex + "\nf 1 2 3\n", ".obj"),
        ErrorCode::kCorrupt);
  }
}

TEST(ImportObj, ColoursAndAgreedNormalsRideAlong) {
  const std::string vertices = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvn 0 0 1\nvn 1 0 0\n";
  const ImportedMesh agreed = loaded(vertices + "f 1//1 2//1 3//1\n", ".obj");
  ASSERT_EQ(agreed.colors.size(), 3U);
  EXPECT_EQ(agreed.colors[1], glm::vec3(0, 1, 0));
  ASSERT_EQ(agreed.normals.size(), 3U);
  EXPECT_EQ(agreed.normals[2], glm::vec3(0, 0, 1));
  EXPECT_TRUE(loaded(vertices + "f 1//1 2//1 3//1\nf 1//2 3//2 2//2\n", ".obj").normals.empty());
}

TEST(ImportObj, LinesAloneAreNoMesh) {
  EXPECT_EQ(refused("v 0 0 0\nv 1 0 0\nl 1 2\n", ".obj"), ErrorCode::kUnsupported);
  EXPECT_EQ(refused("just some text\n", ".obj"), ErrorCode::kCorrupt);
}

// PLY

TEST(ImportPly, ReadsOddButValidHeaders) {
  const std::string header =
      "ply\r\ncomment c\r\nformat ascii 1.0\r\nobj_info o\r\nelement camera 1\r\nproperty list "
      "uchar float m\r\n"
      "element face 1\r\nproperty float32 q\r\nproperty list uint8 uint32 vertex_index\r\nproperty "
      "list uchar float t\r\n"
      "element vertex 3\r\nproperty uchar red\r\nproperty uchar green\r\nproperty uchar "
      "blue\r\nproperty float64 z\r\n"
      "property list uchar int extra\r\nproperty int16 y\r\nproperty float x\r\nproperty float "
      "nz\r\nend_header\r\n";
  const ImportedMesh mesh = loaded(
      header +
          "2 1.5 2.5\r\n0.5 3 0 1 2 2 0 0\r\n255 0 0 0.1 0 0 0 1\r\n0 255 0 0.1 1 7 0 1 1\r\n0 0 "
          "255 0.1 0 1 0 1",
      ".ply");
  ASSERT_EQ(mesh.positions.size(), 3U);
  EXPECT_EQ(mesh.positions[1], glm::dvec3(1, 0, 0.1));
  EXPECT_EQ(mesh.positions[2], glm::dvec3(0, 1, 0.1));
  EXPECT_EQ(mesh.corners, (std::vector<std::uint32_t>{0, 1, 2}));
  ASSERT_EQ(mesh.colors.size(), 3U);
  EXPECT_EQ(mesh.colors[2], glm::vec3(0, 0, 1));
  ASSERT_EQ(mesh.normals.size(), 3U);
  EXPECT_EQ(mesh.normals[0], glm::vec3(0, 0, 1));
}

TEST(ImportPly, BinaryBodyBeginsRightAfterTheHeadersOwnLineEnding) {
  // The first vertex's first byte is 0x0A: after a CR header it must not be taken for a line feed.
  std::string file =
      testing::plyFile(primitives::tetrahedron(), testing::PlyEncoding::kLittleEndian);
  const std::size_t body = file.find("end_header\n") + 11;
  file[body] = '\n';
  const ImportedMesh expected = loaded(file, ".ply");
  std::string header = file.substr(0, body);
  std::replace(header.begin(), header.end(), '\n', '\r');
  EXPECT_EQ(oriented(loaded(header + file.substr(body), ".ply")), oriented(expected));
}

TEST(ImportPly, ReadsTriangleStrips) {
  const ImportedMesh mesh = loaded(
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n8 0 1 2 3 -1 2 3 4\n",
      ".ply");
  EXPECT_EQ(mesh.corners, (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3, 2, 3, 4}));
}

TEST(ImportPly, CountsThatLieAreRefusedBeforeAllocation) {
  const auto file = [](const std::string& vertices,
                       const std::string& faces,
                       const std::string& encoding) {
    return "ply\nformat " + encoding + " 1.0\nelement vertex " + vertices +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
           "\nproperty list uint int vertex_indices\nend_header\n0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n";
  };
  EXPECT_EQ(refused(file("18446744073709551615", "1", "ascii"), ".ply"), ErrorCode::kCorrupt);
  EXPECT_EQ(refused(file("4294967295", "1", "binary_little_endian"), ".ply"), ErrorCode::kCorrupt);
  EXPECT_EQ(refused(file("3", "4294967295", "ascii"), ".ply"), ErrorCode::kCorrupt);
  EXPECT_EQ(refused(file("-3", "1", "ascii"), ".ply"), ErrorCode::kCorrupt);
  EXPECT_EQ(refused(file("3", "1e9", "ascii"), ".ply"), ErrorCode::kCorrupt);
  EXPECT_EQ(refused(file("1", "1", "binary_big_endian"), ".ply"), ErrorCode::kCorrupt);
}

TEST(ImportPly, ListsThatLieAreRefused) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "element face 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  for (const char* face :
       {"2000000000 0 1 2", "-3 0 1 2", "2.5 0 1 2", "4 0 1 2", "3 0 1 two", ""}) {
    EXPECT_EQ(refused(header + face, ".ply"), ErrorCode::kCorrupt) << face;
  }
}

TEST(ImportPly, PointCloudsAndUnknownThingsAreRefused) {
  EXPECT_EQ(
      refused(
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
          "float z\nend_header\n0 0 0\n",
          ".ply"),
      ErrorCode::kUnsupported);
  EXPECT_EQ(refused("ply\nformat binary_mixed 1.0\nend_header\n", ".ply"), ErrorCode::kUnsupported);
  EXPECT_EQ(
      refused("ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n", ".ply"),
      ErrorCode::kUnsupported);
  EXPECT_EQ(refused("ply\nproperty float x\nend_header\n", ".ply"), ErrorCode::kCorrupt);
}

// STL

TEST(ImportStl, CountsThatLieAreRefused) {
  std::string file = testing::stlBinaryFile(primitives::cube());
  for (const unsigned char count : {11, 13, 255}) {
    std::string lying = file;
    lying[80] = static_cast<char>(count);
    EXPECT_EQ(refused(lying, ".stl"), ErrorCode::kCorrupt) << int{count};
  }
  EXPECT_EQ(polygons(loaded(file + "trailing", ".stl")), 12U);
}

TEST(ImportStl, BrokenTextNamesTheLine) {
  const auto message = [](const std::string& body) {
    return importMesh("solid s\nfacet normal 0 0 1\n" + body, ".stl").error().message;
  };
  EXPECT_NE(message("outer loop\nvertex 0 0\n").find("line 4"), std::string::npos);
  EXPECT_NE(
      message("outer loop\nvertex 0 0 0\nendloop\nendfacet\n").find("line 6"),
      std::string::npos);
  EXPECT_NE(message("facet normal 0 0 1\n").find("line 3"), std::string::npos);
  EXPECT_EQ(refused("solid s\nendsolid s\n", ".stl"), ErrorCode::kUnsupported);
}

// OFF

TEST(ImportOff, ReadsItsVariants) {
  const std::string body = "3 1 3\n";
  EXPECT_EQ(polygons(loaded("OFF\n# c\n\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", ".off")), 1U);
  EXPECT_EQ(polygons(loaded("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n", ".off")), 1U);
  EXPECT_EQ(polygons(loaded("3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", ".off")), 1U);
  EXPECT_EQ(
      loaded(
          "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 0 0 255 255\n3 0 1 2\n",
          ".off")
          .colors[1],
      glm::vec3(0, 1, 0));
  EXPECT_EQ(
      loaded("NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n", ".off").normals[2],
      glm::vec3(0, 0, 1));
  EXPECT_EQ(
      loaded("4OFF\n3 1 0\n0 0 0 1\n2 0 0 2\n0 1 0 1\n3 0 1 2\n", ".off").positions[1],
      glm::dvec3(1, 0, 0));
  EXPECT_EQ(refused("nOFF\n2\n3 1 0\n0 0\n1 0\n0 1\n3 0 1 2\n", ".off"), ErrorCode::kUnsupported);
}

TEST(ImportOff, CountsThatLieAreRefusedBeforeAllocation) {
  EXPECT_EQ(refused("OFF\n999999999 999999999 0\n0 0 0\n", ".off"), ErrorCode::kCorrupt);
  EXPECT_EQ(refused("OFF\n3 -1 0\n0 0 0\n1 0 0\n0 1 0\n", ".off"), ErrorCode::kCorrupt);
  EXPECT_EQ(
      refused("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n999999999 0 1 2\n", ".off"),
      ErrorCode::kCorrupt);
  EXPECT_EQ(refused("OFF\n0 0 0\n", ".off"), ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace limn
