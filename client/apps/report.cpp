// SPDX-License-Identifier: Apache-2.0
#include "client/apps/report.h"

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <algorithm>

namespace limn {
namespace {

using nlohmann::json;

json secondsJson(const std::optional<double>& ms) {
  return ms ? json(*ms / 1000.0) : json(nullptr);
}

template <class Part>
json medianJson(const std::vector<FrameTimes>& frames, Part part) {
  if (frames.empty()) return nullptr;
  std::vector<double> values;
  values.reserve(frames.size());
  for (const FrameTimes& frame : frames)
    values.push_back(part(frame));
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2.0;
}

json contoursJson(const SessionOutcome& outcome) {
  std::vector<double> ms = outcome.contours.answerMs;
  if (ms.empty()) return nullptr;
  std::sort(ms.begin(), ms.end());
  const auto points = static_cast<double>(std::max<std::uint64_t>(outcome.contours.points, 1));
  return {
      {"answers", ms.size()},
      {"points", outcome.contours.points},
      {"bytes_per_point", static_cast<double>(outcome.bytes.contours) / points},
      {"ms", {{"p50", ms[ms.size() / 2]}, {"p95", ms[ms.size() * 95 / 100]}, {"max", ms.back()}}}};
}

double peakRssMib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace

std::string reportJson(const RenderReport& report) {
  const SessionOutcome& outcome = *report.outcome;
  const ActiveMesh& mesh = outcome.snapshot->mesh;
  const ByteCounters& bytes = outcome.bytes;
  const json root = {
      {"state", nameOf(outcome.state)},
      {"model", report.modelName},
      {"asset", toHex(outcome.snapshot->model.asset)},
      {"mesh",
       {{"vertices", mesh.mesh().vertexCount()},
        {"faces", mesh.mesh().faceCount()},
        {"splits_held", mesh.splitsHeld()},
        {"splits_total", mesh.splitsTotal()}}},
      {"bytes",
       {{"received", bytes.received},
        {"base", bytes.base},
        {"level_blocks", bytes.levelBlocks},
        {"packets", bytes.packets},
        {"features", bytes.features},
        {"seeds", bytes.seeds},
        {"hull", bytes.hull},
        {"maps", bytes.maps},
        {"contours", bytes.contours},
        {"control", bytes.control}}},
      {"seconds",
       {{"connect", secondsJson(outcome.times.connectMs)},
        {"base", secondsJson(outcome.times.baseMs)},
        {"settled", secondsJson(outcome.times.settledMs)},
        {"exact", secondsJson(outcome.times.exactMs)},
        {"complete", secondsJson(outcome.times.completeMs)}}},
      {"reconnects", outcome.reconnects},
      {"frame_ms",
       {{"detect", medianJson(report.frames, [](const FrameTimes& f) { return f.detect; })},
        {"chain", medianJson(report.frames, [](const FrameTimes& f) { return f.chain; })},
        {"stroke", medianJson(report.frames, [](const FrameTimes& f) { return f.stroke; })},
        {"visibility", medianJson(report.frames, [](const FrameTimes& f) { return f.visibility; })},
        {"draw", medianJson(report.frames, [](const FrameTimes& f) { return f.draw; })},
        {"total", medianJson(report.frames, [](const FrameTimes& f) { return f.total(); })}}},
      {"detector",
       {{"name", report.detectorName},
        {"faces_visited", report.stats.facesVisited},
        {"segments", report.stats.segments},
        {"loops", report.loops},
        {"recall", report.recall ? json(*report.recall) : json(nullptr)}}},
      {"contour_error_px",
       report.contourError
           ? json{{"p95", report.contourError->p95}, {"max", report.contourError->max}}
           : json(nullptr)},
      {"exact_contours", contoursJson(outcome)},
      {"gl",
       report.gl ? json{{"renderer", report.gl->renderer}, {"version", report.gl->version}}
                 : json(nullptr)},
      {"peak_rss_mib", peakRssMib()}};
  return root.dump(2) + "\n";
}

}  // namespace limn
