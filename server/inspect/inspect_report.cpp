// SPDX-License-Identifier: Apache-2.0
#include "server/inspect/inspect_report.h"

#include "shared/plot/svg_plot.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdio>

namespace limn {
namespace {

using Json = nlohmann::ordered_json;

template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

double per(double part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : part / static_cast<double>(whole);
}

const char* placementName(const Model& model) {
  return model.forest().placement() == Placement::kVolume ? "volume" : "subset";
}

std::string levelLine(const char* name, const LevelBytes& level, std::uint64_t splits) {
  const SplitBits& bits = level.bits;
  return formatted(
      "%-6s %9u %9u %10llu %8.2f %8.2f %8.2f %8.2f %9.2f %8.2f %10.2f\n",
      name,
      level.vertices,
      level.faces,
      static_cast<unsigned long long>(level.bytes),
      per(8.0 * static_cast<double>(level.bytes), splits),
      per(bits.names, splits),
      per(bits.cuts, splits),
      per(bits.features, splits),
      per(bits.positions, splits),
      per(bits.moves, splits),
      per(level.attributes.total(), splits));
}

Json pointsJson(const std::vector<RatePoint>& points) {
  Json json = Json::array();
  for (const RatePoint& point : points) {
    json.push_back(
        {{"bytes", point.bytes},
         {"faces", point.faces},
         {"surface_rms", point.surfaceRms < 0.0 ? Json(nullptr) : Json(point.surfaceRms)},
         {"contour_px", point.contourPx}});
  }
  return json;
}

PlotCurve
curveOf(const char* label, const std::vector<RatePoint>& points, double RatePoint::*error) {
  PlotCurve curve{.label = label, .points = {}, .mark = PlotMark::kLineWithPoints};
  for (const RatePoint& point : points)
    curve.points.emplace_back(static_cast<double>(point.bytes) / 1000.0, point.*error);
  return curve;
}

}  // namespace

std::string byteTable(const Model& model, const ByteAccount& account) {
  const protocol::ModelInfo& info = model.info();
  std::string text = formatted(
      "asset %s\n%u vertices, %u faces, %d bits, %u levels, %s placement\n\n",
      toHex(model.id()).c_str(),
      info.vertices,
      info.faces,
      info.gridBits,
      model.forest().levelCount(),
      placementName(model));

  std::uint64_t wire = 0;
  for (const SectionBytes& section : account.sections)
    wire += section.messages == 0 ? 0 : section.bytes;
  text += "section      messages      bytes  share of the wire\n";
  for (const SectionBytes& section : account.sections) {
    if (section.messages == 0) {
      text += formatted(
          "%-12s        - %10llu  %s\n",
          section.name.c_str(),
          static_cast<unsigned long long>(section.bytes),
          section.bytes == 0 ? "empty" : "never sent");
      continue;
    }
    text += formatted(
        "%-12s %8llu %10llu  %5.1f %%\n",
        section.name.c_str(),
        static_cast<unsigned long long>(section.messages),
        static_cast<unsigned long long>(section.bytes),
        100.0 * per(static_cast<double>(section.bytes), wire));
    if (section.name == sections::kInfo) {
      text += formatted(
          "  tables              %10llu  of the split coder\n",
          static_cast<unsigned long long>(account.splitModelBytes));
    }
    if (section.name == sections::kBase && account.baseFeatureBytes != 0) {
      text += formatted(
          "  features            %10llu\n",
          static_cast<unsigned long long>(account.baseFeatureBytes));
    }
  }
  text += formatted("all on the wire       %10llu\n\n", static_cast<unsigned long long>(wire));

  text += "                                       bits a split, of which\n";
  text +=
      "level   vertices     faces      bytes      all    names     cuts features positions "
      "   moves attributes\n";
  LevelBytes all;
  std::uint64_t splits = 0;
  for (std::size_t i = 0; i < account.levels.size(); ++i) {
    const LevelBytes& level = account.levels[i];
    const std::uint64_t own = i == 0 ? 0 : level.vertices - account.levels[i - 1].vertices;
    text += levelLine(std::to_string(level.level).c_str(), level, own);
    if (i == 0) continue;
    splits += own;
    all.vertices = level.vertices;
    all.faces = level.faces;
    all.bytes += level.bytes;
    all.bits += level.bits;
    all.attributes += level.attributes;
  }
  return text + levelLine("splits", all, splits);
}

std::string rateTable(const RateDistortion& rates) {
  std::string text =
      "                        bytes  of Draco     faces  surface rms  contour px (p95)\n";
  const auto add = [&](const char* kind, const std::vector<RatePoint>& points) {
    for (const RatePoint& point : points) {
      text += formatted(
          "%-18s %10llu  %8.3f %9u",
          kind,
          static_cast<unsigned long long>(point.bytes),
          per(static_cast<double>(point.bytes), rates.dracoBytes),
          point.faces);
      text += point.surfaceRms < 0.0 ? "            -" : formatted(" %12.4g", point.surfaceRms);
      text += formatted(" %17.2f\n", point.contourPx);
    }
  };
  add("by pose", rates.byPose);
  add("by level", rates.levels);
  add("Draco of a level", rates.lods);
  return text;
}

std::string
inspectJson(const Model& model, const ByteAccount& account, const RateDistortion* rates) {
  Json json;
  json["asset"] = toHex(model.id());
  json["vertices"] = model.info().vertices;
  json["faces"] = model.info().faces;
  json["quantization_bits"] = model.info().gridBits;
  json["placement"] = placementName(model);
  json["split_model_bytes"] = account.splitModelBytes;
  json["base_feature_bytes"] = account.baseFeatureBytes;
  json["sections"] = Json::array();
  for (const SectionBytes& section : account.sections) {
    json["sections"].push_back(
        {{"name", section.name}, {"messages", section.messages}, {"bytes", section.bytes}});
  }
  json["levels"] = Json::array();
  for (const LevelBytes& level : account.levels) {
    json["levels"].push_back(
        {{"level", level.level},
         {"vertices", level.vertices},
         {"faces", level.faces},
         {"bytes", level.bytes},
         {"error", level.rmsError},
         {"bits",
          {{"names", level.bits.names},
           {"cuts", level.bits.cuts},
           {"features", level.bits.features},
           {"positions", level.bits.positions},
           {"moves", level.bits.moves},
           {"colors", level.attributes.colors},
           {"normals", level.attributes.normals},
           {"seams", level.attributes.seams}}}});
  }
  json["rates"] = nullptr;
  if (rates != nullptr) {
    json["rates"] = {
        {"draco_bytes", rates->dracoBytes},
        {"by_pose", pointsJson(rates->byPose)},
        {"by_level", pointsJson(rates->levels)},
        {"draco_lods", pointsJson(rates->lods)}};
  }
  return json.dump(2);
}

std::string ratePlot(const Model& model, const RateDistortion& rates) {
  const PlotAxis bytes{"kilobytes received", PlotScale::kLogarithmic};
  // Where one Draco mesh would show its first picture, which is then whole.
  const auto single = [&](double low, double high) {
    const double at = static_cast<double>(rates.dracoBytes) / 1000.0;
    return PlotCurve{
        "one Draco mesh: nothing before, all after",
        {{at, low}, {at, high}},
        PlotMark::kLine};
  };
  const auto rangeOf = [&](double RatePoint::*error) {
    double low = 1e300;
    double high = 0.0;
    for (const auto* points : {&rates.byPose, &rates.levels, &rates.lods}) {
      for (const RatePoint& point : *points) {
        if (point.*error <= 0.0) continue;
        low = std::min(low, point.*error);
        high = std::max(high, point.*error);
      }
    }
    return std::pair{low, high};
  };
  const auto [contourLow, contourHigh] = rangeOf(&RatePoint::contourPx);
  const auto [surfaceLow, surfaceHigh] = rangeOf(&RatePoint::surfaceRms);
  const std::array<PlotPanel, 2> panels = {
      PlotPanel{
          .title = "Visible silhouettes",
          .x = bytes,
          .y = {"distance, 95th percentile, pixels", PlotScale::kLogarithmic},
          .curves =
              {curveOf("Limn, by pose", rates.byPose, &RatePoint::contourPx),
               curveOf("Limn, level by level", rates.levels, &RatePoint::contourPx),
               curveOf("a Draco mesh of each level", rates.lods, &RatePoint::contourPx),
               single(contourLow, contourHigh)}},
      PlotPanel{
          .title = "Surface (" + std::to_string(model.info().faces) + " faces)",
          .x = bytes,
          .y = {"rms distance, model units", PlotScale::kLogarithmic},
          .curves = {
              curveOf("Limn, level by level", rates.levels, &RatePoint::surfaceRms),
              curveOf("a Draco mesh of each level", rates.lods, &RatePoint::surfaceRms),
              single(surfaceLow, surfaceHigh)}}};
  return svgPlot(panels);
}

}  // namespace limn
