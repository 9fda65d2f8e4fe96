// SPDX-License-Identifier: Apache-2.0
#include "client/apps/command_line.h"
#include "client/apps/sweep_options.h"
#include "client/apps/sweep_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

namespace limn {
namespace {

Result<Command> parse(const std::string& line) {
  std::istringstream words(line);
  std::vector<std::string> arguments;
  for (std::string word; words >> word;)
    arguments.push_back(word);
  return parseCommandLine(arguments);
}

SweepCommandOptions sweep(const Result<Command>& line) {
  return std::get<SweepCommandOptions>(*line);
}

TEST(SweepOptions, AThesisSweepIsTheDefault) {
  const auto line = parse("sweep --asset a --csv f.csv --plot f.svg");
  ASSERT_TRUE(line) << line.error().message;
  ASSERT_TRUE(std::holds_alternative<SweepCommandOptions>(*line));
  EXPECT_EQ(sweep(line).frames, 400U);
  EXPECT_EQ(sweep(line).detectors.size(), allDetectors().size());
  EXPECT_EQ(sweep(line).parameters.random.fraction, 0.1);
  EXPECT_EQ(sweep(line).parameters.coherence.reseedEvery, 30);
  EXPECT_EQ(sweep(line).csv, "f.csv");
  EXPECT_EQ(sweep(line).plot, "f.svg");
}

TEST(SweepOptions, SeveralMeshesAndChosenDetectors) {
  const auto line = parse(
      "sweep --mesh a.ply --mesh b.ply --detectors cones,brute,cones --silhouette edges "
      "--frames 10 --camera orbit:10,20,4 --reseed-every 5");
  ASSERT_TRUE(line) << line.error().message;
  EXPECT_EQ(sweep(line).sources.size(), 2U);
  EXPECT_EQ(
      sweep(line).detectors,
      (std::vector<DetectorMethod>{DetectorMethod::kCones, DetectorMethod::kBrute}));
  EXPECT_EQ(sweep(line).silhouette, SilhouetteKind::kEdges);
  EXPECT_EQ(sweep(line).orbit.distanceRadii, 4.0);
  EXPECT_EQ(sweep(line).parameters.coherence.reseedEvery, 5);
}

TEST(SweepOptions, WrongUsageIsSaidInOneLine) {
  for (const char* line :
       {"sweep",
        "sweep --frames 10",
        "sweep --mesh a --frames 1",
        "sweep --mesh a --frames x",
        "sweep --mesh a --detectors magic",
        "sweep --mesh a --detectors brute,,cones",
        "sweep --mesh a --silhouette round",
        "sweep --mesh a --server ws://h:1 --model m",
        "sweep --server ws://h:1",
        "sweep --mesh a --camera 1,2"}) {
    const auto parsed = parse(line);
    ASSERT_FALSE(parsed) << line;
    EXPECT_EQ(parsed.error().code, ErrorCode::kInvalidArgument) << line;
    EXPECT_EQ(parsed.error().message.find('\n'), std::string::npos) << parsed.error().message;
  }
}

std::vector<SweepMesh> twoMeshes() {
  std::vector<SweepMesh> meshes;
  for (const std::uint32_t faces : {100U, 5000U}) {
    SweepMesh mesh{"m<" + std::to_string(faces), faces, {}};
    for (const DetectorMethod method : {DetectorMethod::kBrute, DetectorMethod::kRandom}) {
      SweepSeries series{method, 1.5, {}};
      for (std::uint32_t i = 0; i < 3; ++i)
        series.frames.push_back({0.1 * (i + 1), 10 * i, faces, 1.0 - 0.25 * i});
      mesh.series.push_back(series);
    }
    meshes.push_back(mesh);
  }
  return meshes;
}

TEST(SweepReport, SumsUpASeries) {
  const SweepSeries series = twoMeshes()[0].series[0];
  EXPECT_DOUBLE_EQ(series.medianMs(), 0.2);
  EXPECT_DOUBLE_EQ(series.meanSegments(), 10.0);
  EXPECT_DOUBLE_EQ(series.meanRecall(), 0.75);
  EXPECT_DOUBLE_EQ(series.worstRecall(), 0.5);
}

TEST(SweepReport, CsvHasARowAMeshDetectorAndFrame) {
  const std::string csv = sweepCsv(twoMeshes());
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * 2 * 3);
  EXPECT_EQ(
      csv.substr(0, csv.find('\n')),
      "mesh,faces,detector,frame,detect_ms,segments,recall,faces_visited");
  EXPECT_NE(csv.find("m<5000,5000,random,2,0.300000,20,0.500000,5000\n"), std::string::npos);
}

TEST(SweepReport, PlotIsWellFormedAndHasEveryCurve) {
  const std::string svg = sweepPlot(twoMeshes());
  EXPECT_TRUE(svg.starts_with("<svg "));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_EQ(svg.find("m<100"), std::string::npos);  // names are escaped
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  std::size_t curves = 0;
  for (std::size_t at = svg.find("<polyline"); at != std::string::npos;
       at = svg.find("<polyline", at + 1)) {
    ++curves;
  }
  EXPECT_EQ(curves, 2U * 2 * 3 + 2);  // three panels a mesh, and the sizes
}

TEST(SweepReport, NothingToPlotIsNoReasonToFail) {
  EXPECT_TRUE(sweepPlot({}).ends_with("</svg>\n"));
  EXPECT_EQ(sweepPlot({{"empty", 0, {}}}).find("nan"), std::string::npos);
}

}  // namespace
}  // namespace limn
