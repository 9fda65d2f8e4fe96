// SPDX-License-Identifier: Apache-2.0
#include "client/apps/child_process.h"
#include "client/apps/contour_check.h"
#include "client/apps/dumps.h"
#include "client/apps/line_finder.h"
#include "client/apps/output_file.h"
#include "client/apps/report.h"
#include "client/apps/temporary_directory.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstring>
#include <filesystem>

namespace limn {
namespace {

/// A snapshot of a mesh that has no splits.
std::shared_ptr<const MeshSnapshot> snapshotOf(const TriangleMesh& mesh) {
  auto snapshot = std::make_shared<MeshSnapshot>();
  snapshot->model.grid = mesh.grid;
  snapshot->model.sphere = boundingSphere(mesh.grid, mesh.positions);
  snapshot->model.vertices = static_cast<std::uint32_t>(mesh.positions.size());
  snapshot->model.faces = static_cast<std::uint32_t>(mesh.triangles.size());
  snapshot->mesh = *ActiveMesh::fromBase({0, snapshot->model.vertices}, mesh, {});
  return snapshot;
}

template <class T>
T readAt(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST(Dumps, PlyHoldsModelAndGridPositionsAndFaces) {
  const TriangleMesh mesh = primitives::icosphere(1);
  const auto snapshot = snapshotOf(mesh);
  const std::string ply = meshPly(*snapshot);
  const std::size_t header = ply.find("end_header\n") + 11;
  EXPECT_NE(ply.find("format binary_little_endian 1.0"), std::string::npos);
  EXPECT_NE(ply.find("element vertex " + std::to_string(mesh.positions.size())), std::string::npos);
  EXPECT_NE(ply.find("element face " + std::to_string(mesh.triangles.size())), std::string::npos);
  ASSERT_EQ(ply.size(), header + 36 * mesh.positions.size() + 13 * mesh.triangles.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::dvec3 model = mesh.grid.toModel(mesh.positions[v]);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(readAt<double>(ply, header + 36 * v + 8 * static_cast<std::size_t>(i)), model[i]);
      EXPECT_EQ(
          readAt<std::int32_t>(ply, header + 36 * v + 24 + 4 * static_cast<std::size_t>(i)),
          mesh.positions[v][i]);
    }
  }
  const std::size_t faces = header + 36 * mesh.positions.size();
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    EXPECT_EQ(ply[faces + 13 * f], 3);
    EXPECT_EQ(readAt<std::uint32_t>(ply, faces + 13 * f + 1), mesh.triangles[f].x);
  }
}

TEST(Dumps, LinesNameTheirEdgesAndTheirCamera) {
  const auto snapshot = snapshotOf(primitives::icosphere(2));
  const Camera camera = orbitCamera(snapshot->model.sphere, 30.0, 20.0);
  LineFinder finder(snapshot, {DetectorMethod::kBrute, SilhouetteKind::kEdges, {}});
  const auto found = finder.find(camera);
  ASSERT_FALSE(found.lines.lines.empty());
  const std::vector<std::uint8_t> visible(found.lines.points.size(), 1);
  const auto json = nlohmann::json::parse(
      linesJson({*snapshot, found.lines, visible, camera, Viewport{640, 480}}));
  const auto& matrix = json["camera"]["view_projection"];
  ASSERT_EQ(matrix.size(), 16U);
  EXPECT_EQ(matrix[1].get<double>(), camera.clipFromWorld(640.0 / 480.0)[1][0]);
  std::size_t segments = 0;
  for (const auto& line : json["lines"]) {
    EXPECT_EQ(line["kind"], "silhouette");
    EXPECT_TRUE(line["closed"].get<bool>());
    EXPECT_EQ(line["points"].size(), line["visible"].size());
    ASSERT_EQ(line["edges"].size(), line["visible"].size());
    segments += line["edges"].size();
    // A segment's first point is its edge's first vertex.
    const auto v = line["edges"][0][0].get<std::size_t>();
    const glm::dvec3 p = snapshot->model.grid.toModel(snapshot->mesh.positions()[v]);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(line["points"][0][i].get<double>(), p[static_cast<int>(i)], 1e-6);
    }
  }
  EXPECT_EQ(segments, found.stats.segments);
  EXPECT_EQ(finder.recallFrom(camera), 1.0);
}

TEST(Report, HasEveryKeyAndMediansOfTheFrames) {
  SessionOutcome outcome;
  outcome.snapshot = snapshotOf(primitives::cube());
  outcome.state = MeshState::kSettled;
  outcome.times.settledMs = 1500.0;
  RenderReport report;
  report.outcome = &outcome;
  report.modelName = "cube";
  report.detectorName = "exact";
  report.frames = {{1, 10, 0, 0, 0}, {3, 30, 0, 0, 0}, {2, 20, 0, 0, 0}};
  const auto json = nlohmann::json::parse(reportJson(report));
  EXPECT_EQ(json["state"], "settled");
  EXPECT_EQ(json["seconds"]["settled"], 1.5);
  EXPECT_TRUE(json["seconds"]["complete"].is_null());
  EXPECT_EQ(json["frame_ms"]["detect"], 2.0);
  EXPECT_EQ(json["frame_ms"]["total"], 22.0);
  EXPECT_EQ(json["mesh"]["faces"], 12);
  EXPECT_GT(json["peak_rss_mib"].get<double>(), 0.0);
  for (const char* key :
       {"received",
        "base",
        "level_blocks",
        "packets",
        "features",
        "seeds",
        "hull",
        "maps",
        "contours",
        "control"}) {
    EXPECT_TRUE(json["bytes"].contains(key)) << key;
  }
  for (const char* key : {"name", "faces_visited", "segments", "loops", "recall"}) {
    EXPECT_TRUE(json["detector"].contains(key)) << key;
  }
  for (const char* key : {"contour_error_px", "gl"})
    EXPECT_TRUE(json.contains(key)) << key;
}

std::vector<glm::dvec2> circle(double radius) {
  std::vector<glm::dvec2> points;
  for (int i = 0; i < 2000; ++i) {
    const double a = 2.0 * 3.14159265358979 * i / 2000;
    points.emplace_back(256.0 + radius * std::cos(a), 256.0 + radius * std::sin(a));
  }
  return points;
}

TEST(ContourCheck, MeasuresTheWorseOfBothWays) {
  const Viewport viewport{512, 512};
  EXPECT_NEAR(compareContours(circle(100.0), circle(103.0), viewport).p95, 3.0, 0.01);
  EXPECT_NEAR(compareContours(circle(100.0), circle(103.0), viewport).max, 3.0, 0.01);
  EXPECT_EQ(compareContours(circle(50.0), circle(50.0), viewport).max, 0.0);
  // A contour that only one side has counts, whichever side that is.
  auto two = circle(100.0);
  const auto small = circle(20.0);
  two.insert(two.end(), small.begin(), small.end());
  EXPECT_NEAR(compareContours(circle(100.0), two, viewport).max, 80.0, 0.1);
  EXPECT_NEAR(compareContours(two, circle(100.0), viewport).max, 80.0, 0.1);
  EXPECT_EQ(compareContours({}, {}, viewport).max, 0.0);
  EXPECT_GT(compareContours({}, two, viewport).p95, 700.0);
}

TEST(ContourCheck, AgreesWithComparingEveryPair) {
  const Viewport viewport{200, 100};
  std::vector<glm::dvec2> a;
  std::vector<glm::dvec2> b;
  for (int i = 0; i < 60; ++i) {
    a.emplace_back((i * 37) % 200, (i * 53) % 100);
    b.emplace_back((i * 71 + 11) % 200, (i * 29 + 5) % 100);
  }
  double worst = 0.0;
  for (int way = 0; way < 2; ++way) {
    for (const glm::dvec2& p : way == 0 ? a : b) {
      double best = 1e9;
      for (const glm::dvec2& q : way == 0 ? b : a)
        best = std::min(best, glm::distance(p, q));
      worst = std::max(worst, best);
    }
  }
  EXPECT_NEAR(compareContours(a, b, viewport).max, worst, 1e-9);
}

TEST(OutputFile, IsWholeOrNotThere) {
  const auto folder = TemporaryDirectory::create();
  ASSERT_TRUE(folder);
  const auto path = (*folder)->path() / "out.txt";
  ASSERT_TRUE(writeOutputFile(path, "first"));
  ASSERT_TRUE(writeOutputFile(path, "second, longer"));
  EXPECT_EQ(std::filesystem::file_size(path), 14U);
  EXPECT_FALSE(writeOutputFile((*folder)->path() / "missing" / "x", "y"));
  EXPECT_FALSE(writeOutputFile((*folder)->path(), "y"));
  // Nothing is left lying beside it.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator((*folder)->path()), {}), 1);
}

TEST(TemporaryDirectory, GoesWithEverythingInIt) {
  std::filesystem::path path;
  {
    const auto folder = TemporaryDirectory::create();
    ASSERT_TRUE(folder);
    path = (*folder)->path();
    std::filesystem::create_directories(path / "a" / "b");
    ASSERT_TRUE(writeOutputFile(path / "a" / "b" / "c", "x"));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(ChildProcess, CollectsBothStreamsAndTheStatus) {
  const auto never = [] { return false; };
  const auto child = runChild({"sh", "-c", "echo out; echo err >&2; exit 3"}, never);
  ASSERT_TRUE(child) << child.error().message;
  EXPECT_EQ(child->output, "out\n");
  EXPECT_EQ(child->complaint, "err\n");
  EXPECT_EQ(child->exitCode, 3);
  EXPECT_EQ(runChild({"sh", "-c", "kill -11 $$"}, never)->exitCode, 128 + 11);
  EXPECT_EQ(runChild({"limn-no-such-program"}, never).error().code, ErrorCode::kIo);
}

TEST(ChildProcess, IsKilledOnRequest) {
  const auto child = runChild({"sleep", "1000"}, [] { return true; });
  ASSERT_FALSE(child);
  EXPECT_EQ(child.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace limn
