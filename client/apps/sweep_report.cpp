// SPDX-License-Identifier: Apache-2.0
#include "client/apps/sweep_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

namespace limn {
namespace {

template <class... Arguments>
std::string format(const char* pattern, Arguments... arguments) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, arguments...);
  return text;
}

double mean(
    const std::vector<SweepFrame>& frames,
    const std::function<double(const SweepFrame&)>& f) {
  double sum = 0.0;
  for (const SweepFrame& frame : frames)
    sum += f(frame);
  return frames.empty() ? 0.0 : sum / static_cast<double>(frames.size());
}

}  // namespace

double SweepSeries::medianMs() const {
  if (frames.empty()) return 0.0;
  std::vector<double> times;
  for (const SweepFrame& frame : frames)
    times.push_back(frame.ms);
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

double SweepSeries::meanSegments() const {
  return mean(frames, [](const SweepFrame& f) { return f.segments; });
}

double SweepSeries::meanRecall() const {
  return mean(frames, [](const SweepFrame& f) { return f.recall; });
}

double SweepSeries::worstRecall() const {
  double worst = 1.0;
  for (const SweepFrame& frame : frames)
    worst = std::min(worst, frame.recall);
  return worst;
}

std::string sweepCsv(const std::vector<SweepMesh>& meshes) {
  std::string csv = "mesh,faces,detector,frame,detect_ms,segments,recall,faces_visited\n";
  for (const SweepMesh& mesh : meshes) {
    for (const SweepSeries& series : mesh.series) {
      for (std::size_t i = 0; i < series.frames.size(); ++i) {
        const SweepFrame& frame = series.frames[i];
        csv += mesh.name + "," + std::to_string(mesh.faces) + "," +
               std::string(detectorName(series.method)) +
               format(
                   ",%zu,%.6f,%u,%.6f,%u\n",
                   i,
                   frame.ms,
                   frame.segments,
                   frame.recall,
                   frame.facesVisited);
      }
    }
  }
  return csv;
}

std::string sweepTable(const std::vector<SweepMesh>& meshes) {
  std::string table = format(
      "%-20s %9s  %-12s %10s %9s %8s %8s %10s\n",
      "mesh",
      "faces",
      "detector",
      "median ms",
      "segments",
      "recall",
      "worst",
      "build ms");
  for (const SweepMesh& mesh : meshes) {
    for (const SweepSeries& s : mesh.series) {
      table += format(
          "%-20.20s %9u  %-12s %10.4f %9.0f %7.2f%% %7.2f%% %10.2f\n",
          mesh.name.c_str(),
          mesh.faces,
          std::string(detectorName(s.method)).c_str(),
          s.medianMs(),
          s.meanSegments(),
          100.0 * s.meanRecall(),
          100.0 * s.worstRecall(),
          s.buildMs);
    }
  }
  return table;
}

}  // namespace limn
