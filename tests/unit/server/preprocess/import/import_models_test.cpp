// SPDX-License-Identifier: Apache-2.0
// The shared set of real, bad and odd models, where it is there. bad/EXPECT.tsv says for each bad
// file what a sensible program does.
#include "server/preprocess/import/import.h"
#include "server/preprocess/repair/repair.h"
#include "tests/corpus/corpus.h"
#include "tests/unit/server/preprocess/import/mesh_files.h"

#include "shared/mesh/half_edge.h"

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>
#include <string>
#include <vector>

namespace limn {
namespace {

struct Expectation {
  std::string file;
  std::string outcome;

  [[nodiscard]] bool mayLoad() const {
    return outcome.rfind("refuse", 0) != 0 || outcome.find("or ") != std::string::npos;
  }

  [[nodiscard]] bool mayRefuse() const { return outcome.find("refuse") != std::string::npos; }

  [[nodiscard]] bool mustSaySo() const { return outcome.find("say so") != std::string::npos; }
};

std::vector<Expectation> readExpectations(const std::filesystem::path& table) {
  std::vector<Expectation> expectations;
  std::ifstream lines(table);
  std::string line;
  std::getline(lines, line);  // column names
  while (std::getline(lines, line)) {
    std::vector<std::string> columns;
    for (std::size_t begin = 0; begin <= line.size();) {
      const std::size_t end = std::min(line.find('\t', begin), line.size());
      columns.push_back(line.substr(begin, end - begin));
      begin = end + 1;
    }
    if (columns.size() >= 4) expectations.push_back({columns[0], columns[3]});
  }
  return expectations;
}

TEST(BadModels, EachHasTheSensibleOutcome) {
  const auto folder = corpus::modelsFolder();
  if (!folder || !std::filesystem::exists(*folder / "bad/EXPECT.tsv"))
    GTEST_SKIP() << corpus::kNoModels;
  const auto expectations = readExpectations(*folder / "bad/EXPECT.tsv");
  ASSERT_GT(expectations.size(), 50U);
  for (const Expectation& expected : expectations) {
    SCOPED_TRACE(expected.file + ": " + expected.outcome);
    const auto imported = importMesh(*folder / "bad" / expected.file);
    const auto repaired = imported ? repairMesh(*imported, {}) : tl::unexpected(imported.error());
    if (!repaired) {
      EXPECT_TRUE(expected.mayRefuse()) << repaired.error().message;
      EXPECT_EQ(repaired.error().message.find('\n'), std::string::npos);
      continue;
    }
    EXPECT_TRUE(expected.mayLoad());
    EXPECT_TRUE(!expected.mustSaySo() || !repaired->repairs.empty());
    const auto linked = HalfEdgeMesh::build(
        static_cast<std::uint32_t>(repaired->mesh.positions.size()),
        repaired->mesh.triangles);
    ASSERT_TRUE(linked.has_value()) << linked.error().message;
    EXPECT_TRUE(validate(*linked).has_value());
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss, 1024 * 1024) << "KiB";
#endif
}

TEST(BadModels, RepairsAreTheOnesTheTableNames) {
  const auto folder = corpus::modelsFolder();
  if (!folder || !std::filesystem::exists(*folder / "bad")) GTEST_SKIP() << corpus::kNoModels;

  struct Row {
    const char* file;
    const char* kind;
    std::uint64_t count;
    std::size_t faces;
    bool closed;
  };

  for (const Row& row :
       {Row{"nonmanifold-edge.obj", "split_vertices", 2, 24, true},
        Row{"nonmanifold-vertex.obj", "split_vertices", 1, 8, true},
        Row{"inside-out-cube.obj", "flipped", 12, 12, true},
        Row{"orientation-shuffled.off", "flipped", 2017, 4050, true},
        Row{"duplicate-faces.obj", "dropped_faces", 8, 12, true},
        Row{"double-sided-sheet.obj", "dropped_faces", 2, 2, false},
        Row{"degenerate-indices.obj", "dropped_faces", 3, 318, true},
        Row{"isolated-vertices.ply", "dropped_vertices", 50, 318, true},
        Row{"zero-length-edge.off", "merged_vertices", 1, 316, true},
        Row{"soup.stl", "merged_vertices", 1117, 446, true},
        Row{"quads.obj", "triangulated", 2398, 4796, true},
        Row{"ngon-300.obj", "triangulated", 302, 1196, true},
        Row{"index-out-of-range.obj", "dropped_faces", 1, 12, true},
        Row{"stl-binary-says-solid.stl", "merged_vertices", 3000, 1200, true},
        Row{"crlf-comments-continuation.obj", "triangulated", 1, 6, true}}) {
    SCOPED_TRACE(row.file);
    const auto imported = importMesh(*folder / "bad" / row.file);
    ASSERT_TRUE(imported.has_value()) << imported.error().message;
    const auto repaired = repairMesh(*imported, {});
    ASSERT_TRUE(repaired.has_value()) << repaired.error().message;
    EXPECT_EQ(repaired->mesh.triangles.size(), row.faces);
    EXPECT_EQ(repaired->closed, row.closed);
    const auto count = repaired->repairs.find(row.kind);
    EXPECT_EQ(count == repaired->repairs.end() ? 0 : count->second, row.count) << row.kind;
  }
}

TEST(GoodModels, EveryFormatOfTheRotorIsOneMesh) {
  const auto folder = corpus::modelsFolder();
  if (!folder || !std::filesystem::exists(*folder / "formats")) GTEST_SKIP() << corpus::kNoModels;
  std::vector<testing::Corners> expected;
  for (const auto& entry : std::filesystem::directory_iterator(*folder / "formats")) {
    SCOPED_TRACE(entry.path().filename());
    const auto imported = importMesh(entry.path());
    ASSERT_TRUE(imported.has_value()) << imported.error().message;
    const auto repaired = repairMesh(*imported, {});
    ASSERT_TRUE(repaired.has_value()) << repaired.error().message;
    EXPECT_EQ(repaired->mesh.positions.size(), 600U);
    EXPECT_TRUE(repaired->closed);
    TriangleMesh onGrid = repaired->mesh;
    onGrid.grid = {};  // formats differ in the last bits of a float; on the grid they agree
    const auto triangles = testing::oriented(onGrid);
    if (expected.empty()) expected = triangles;
    EXPECT_EQ(triangles, expected);
  }
  EXPECT_EQ(expected.size(), 1200U);
}

// OpenMesh's readers as the oracle for ours, on files both can read: positions and faces, in order.
TEST(GoodModels, OpenMeshReadsTheSame) {
  const auto folder = corpus::modelsFolder();
  if (!folder || !std::filesystem::exists(*folder / "formats")) GTEST_SKIP() << corpus::kNoModels;
  using OpenMeshMesh = OpenMesh::TriMesh_ArrayKernelT<>;
  int compared = 0;
  for (const char* name :
       {"formats/rotor-le.ply",
        "formats/rotor-be.ply",
        "formats/rotor-ascii.ply",
        "formats/rotor.obj",
        "formats/rotor.off",
        "bunny-low.off",
        "spot.obj",
        "turbine-housing.ply",
        "terrain.ply"}) {
    SCOPED_TRACE(name);
    if (!std::filesystem::exists(*folder / name)) continue;
    OpenMeshMesh theirs;
    ASSERT_TRUE(OpenMesh::IO::read_mesh(theirs, (*folder / name).string()));
    const auto ours = importMesh(*folder / name);
    ASSERT_TRUE(ours.has_value()) << ours.error().message;
    ASSERT_EQ(ours->positions.size(), theirs.n_vertices());
    ASSERT_EQ(ours->polygonBegin.size() - 1, theirs.n_faces());
    for (const auto vertex : theirs.vertices()) {
      const auto p = theirs.point(vertex);
      ASSERT_EQ(
          glm::vec3(ours->positions[static_cast<std::size_t>(vertex.idx())]),
          glm::vec3(p[0], p[1], p[2]));
    }
    std::vector<testing::Corners> faces;
    for (const auto face : theirs.faces()) {
      testing::Corners corners{};
      std::size_t k = 0;
      for (const auto vertex : face.vertices())
        corners[k++] = {theirs.point(vertex)[0], theirs.point(vertex)[1], theirs.point(vertex)[2]};
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      faces.push_back(corners);
    }
    std::sort(faces.begin(), faces.end());
    EXPECT_EQ(testing::oriented(*ours), faces);
    ++compared;
  }
  EXPECT_GE(compared, 5);
}

TEST(GoodModels, ClosedMeshesStayClosedOnCoarseAndFineGrids) {
  const auto folder = corpus::modelsFolder();
  if (!folder) GTEST_SKIP() << corpus::kNoModels;
  for (const auto& path : corpus::modelFiles(corpus::Size::kSmall)) {
    SCOPED_TRACE(path.filename());
    const auto imported = importMesh(path);
    ASSERT_TRUE(imported.has_value()) << imported.error().message;
    for (const int bits : {11, 14}) {
      const auto repaired = repairMesh(*imported, {.quantizationBits = bits});
      ASSERT_TRUE(repaired.has_value()) << repaired.error().message;
      EXPECT_TRUE(repaired->closed || !repaired->inputClosed) << bits << " bits";
    }
  }
}

}  // namespace
}  // namespace limn
