// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/pipeline.h"

#include "server/preprocess/asset_sections.h"
#include "server/preprocess/forest/base_reach.h"
#include "server/preprocess/hull_sections.h"
#include "server/preprocess/hulls/hulls.h"
#include "server/preprocess/import/import.h"
#include "server/preprocess/map_sections.h"
#include "server/preprocess/seeds/build_seeds.h"

#include "protocol/framing.h"

#include "shared/progressive/split_forest.h"

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <utility>

namespace limn {
namespace {

using Json = nlohmann::ordered_json;

// Part of every asset's id, with protocol::kAssetFormat: raised when preparation gives other bytes,
// of the same format, for the same input.
constexpr char kPreparationVersion[] = "limn-asset-9";

class Stopwatch {
 public:
  /// Seconds since the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

double peakRssMib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

std::span<const std::uint8_t> bytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string describe(const PrepareOptions& options) {
  Json json;
  json["version"] = kPreparationVersion;
  json["asset_format"] = protocol::kAssetFormat;
  json["quantization"] = options.repair.quantizationBits;
  json["base_faces"] = options.forest.baseFaces;
  json["cost"] = static_cast<int>(options.forest.cost);
  if (options.forest.placement != Placement::kSubset)
    json["placement"] = static_cast<int>(options.forest.placement);
  json["crease_angle"] = options.forest.creaseAngleDegrees;
  json["hull_faces"] = options.hullFaces;
  json["viewpoints"] = {options.seedAzimuths, options.seedElevations};
  return json.dump();
}

Result<Sha256Digest> contentId(const std::filesystem::path& input, const PrepareOptions& options) {
  std::ifstream file(input, std::ios::binary);
  if (!file)
    return fail(
        ErrorCode::kNotFound,
        "cannot open " + input.string() + ": check the path and its permissions");
  std::string content;
  std::error_code error;
  const auto size = std::filesystem::file_size(input, error);
  if (!error) content.reserve(size);
  content.assign(std::istreambuf_iterator<char>(file), {});
  if (file.bad()) return fail(ErrorCode::kIo, "cannot read " + input.string());
  const std::string description = describe(options);
  const std::span<const std::uint8_t> pieces[] = {bytesOf(description), bytesOf(content)};
  return sha256(pieces);
}

Json repairsJson(const RepairCounts& repairs) {
  Json json = Json::object();
  for (const auto& [kind, count] : repairs)
    json[kind] = count;
  return json;
}

// The parts of the report that take shape stage by stage.
struct Stages {
  double import = 0, repair = 0, hull = 0, simplify = 0, encode = 0, seeds = 0, maps = 0;
};

Json hullJson(const Hulls& hulls, const HullSections& sections, std::uint32_t faces) {
  if (!sections.reason.empty()) return {{"reason", "no hull, because " + sections.reason}};
  const auto level = [&](const BuiltHull& built) {
    const ProgressiveHull& hull = built.hull;
    return Json{
        {"faces", hull.facesAfter(hull.splitsFor(faces))},
        {"volume", hullVolume(hull, faces)},
        {"base_faces", hull.facesAfter(0)},
        {"finest_faces", hull.facesAfter(hull.splits.size())},
        {"clean_faces", built.cleanFaces}};
  };
  return {
      {"outer", level(*hulls.outer)},
      {"inner", level(*hulls.inner)},
      {"mesh_volume", hulls.meshVolume}};
}

TriangleMesh fullMesh(const SplitForest& forest) {
  return {forest.grid, forest.positions, forest.triangles, forest.attributes};
}

Json makeReport(
    const ImportedMesh& imported,
    const RepairedMesh& repaired,
    const Hulls& hulls,
    const HullSections& hullSections,
    const MapSections& mapSections,
    const BuiltForest& built,
    const WireSections& sections,
    const PrepareOptions& options) {
  const SplitForest& forest = built.forest;
  const auto seamSides =
      std::count_if(repaired.seams.begin(), repaired.seams.end(), [](auto s) { return s != 0; });
  const auto seamCount = static_cast<std::uint64_t>(seamSides) / 2;
  Json json;
  json["asset_format"] = protocol::kAssetFormat;
  json["input"] = {
      {"format", imported.format},
      {"vertices", repaired.inputVertices},
      {"faces", repaired.inputFaces},
      {"components", repaired.inputComponents},
      {"closed", repaired.inputClosed},
      {"repairs", repairsJson(repaired.repairs)}};
  json["mesh"] = {
      {"vertices", forest.vertexCount()},
      {"faces", forest.triangles.size()},
      {"closed", repaired.closed},
      {"colors", !forest.attributes.colors.empty()},
      {"normals", !forest.attributes.normals.empty()},
      {"seams", seamCount}};
  const std::uint32_t baseFaces = built.levels.front().faces;
  json["base"] = {{"faces", baseFaces}, {"asked", options.forest.baseFaces}};
  if (baseFaces > options.forest.baseFaces) {
    const MeshTopology topology = topologyOf(fullMesh(forest));
    json["base"]["pieces"] = topology.pieces;
    json["base"]["holes"] = topology.holes;
    json["base"]["tunnels"] = topology.tunnels;
    json["base"]["note"] = whyBaseIsLarger(baseFaces, options.forest.baseFaces, topology);
  }
  json["quantization_bits"] = options.repair.quantizationBits;
  json["placement"] = forest.placement() == Placement::kVolume ? "volume" : "subset";
  json["levels"] = Json::array();
  for (std::size_t level = 0; level < built.levels.size(); ++level) {
    json["levels"].push_back(
        {{"level", level},
         {"vertices", built.levels[level].vertices},
         {"faces", built.levels[level].faces},
         {"bytes", sections.levelBytes[level]},
         {"error", built.levels[level].rmsError * forest.grid.step}});
  }
  const std::uint64_t features = sections.featureBytes;
  // What colours, normals and seams add is told apart: the rest is geometry and connectivity.
  const std::uint64_t base = wireBytes(sections.base) - features - sections.baseAttributeBytes;
  const std::uint64_t blocks = wireBytes(sections.blocks) - sections.blockAttributeBytes;
  const std::uint64_t splits = wireBytes(sections.packets) - sections.packetAttributeBytes;
  const std::uint64_t attributes =
      sections.baseAttributeBytes + sections.blockAttributeBytes + sections.packetAttributeBytes;
  const std::uint64_t seeds = wireBytes(sections.seeds);
  const std::uint64_t hullOuter = wireBytes(hullSections.outer);
  const std::uint64_t hullInner = wireBytes(hullSections.inner);
  const std::uint64_t maps = wireBytes(mapSections.normals) + wireBytes(mapSections.colors);
  json["bytes"] = {
      {"base", base},
      {"level_blocks", blocks},
      {"splits", splits},
      {"seeds", seeds},
      {"cones", 0},
      {"hull_outer", hullOuter},
      {"hull_inner", hullInner},
      {"maps", maps},
      {"features", features},
      {"attributes", attributes},
      {"total",
       wireBytes(sections.info) + base + features + attributes + blocks + splits + seeds +
           hullOuter + hullInner + maps}};
  json["stream_bits_per_vertex"] =
      8.0 * static_cast<double>(base + blocks + splits) / forest.vertexCount();
  json["hull"] = hullJson(hulls, hullSections, options.hullFaces);
  return json;
}

Json secondsJson(const Stages& stages) {
  const double total = stages.import + stages.repair + stages.hull + stages.simplify +
                       stages.encode + stages.seeds + stages.maps;
  return {
      {"import", stages.import},
      {"repair", stages.repair},
      {"simplify", stages.simplify},
      {"encode", stages.encode},
      {"hull", stages.hull},
      {"seeds", stages.seeds},
      {"cones", 0.0},
      {"maps", stages.maps},
      {"total", total}};
}

std::string noteOf(const Json& report) {
  const auto base = report.find("base");
  return base != report.end() && base->is_object() ? base->value("note", std::string()) : "";
}

// The name, asset and path head a report; the rest is the asset's own.
std::string headed(
    const std::string& name,
    const Sha256Digest& id,
    const std::filesystem::path& input,
    Json report) {
  Json json;
  json["name"] = name;
  json["asset"] = toHex(id);
  for (auto& [key, value] : report.items())
    json[key] = std::move(value);
  Json inputJson = {{"path", input.string()}};
  for (auto& [key, value] : json["input"].items()) {
    if (key != "path") inputJson[key] = value;
  }
  json["input"] = std::move(inputJson);
  return json.dump();
}

// nullopt: not in the store, or damaged and out of the way now.
Result<std::optional<PreparedModel>> reuse(
    const std::filesystem::path& input,
    const std::string& name,
    const Sha256Digest& id,
    AssetStore& store) {
  if (!store.contains(id)) return std::optional<PreparedModel>();
  const auto asset = store.open(id);
  if (!asset) {
    if (asset.error().code != ErrorCode::kCorrupt) return tl::unexpected(asset.error());
    if (auto moved = store.quarantine(id); !moved) return tl::unexpected(moved.error());
    return std::optional<PreparedModel>();
  }
  const auto section = (*asset)->section(sections::kForest);
  if (!section) return tl::unexpected(section.error());
  const auto forest = parseForest(*section);
  if (!forest) return tl::unexpected(forest.error());
  PreparedModel model{name, id, fullMesh(*forest), {}, {}};
  const Json report = Json::parse((*asset)->report(), nullptr, false);
  if (report.is_object()) model.note = noteOf(report);
  model.reportJson = headed(name, id, input, report.is_discarded() ? Json::object() : report);
  return std::optional(std::move(model));
}

Result<void> writeAsset(
    const WireSections& wire,
    const SplitForest& forest,
    const HullSections& hulls,
    const MapSections& maps,
    const Sha256Digest& id,
    const std::string& report,
    AssetStore& store) {
  auto writer = store.create(id);
  if (!writer) return tl::unexpected(writer.error());
  const std::vector<std::uint8_t> forestBytes = serializeForest(forest);
  const std::pair<const char*, std::span<const std::uint8_t>> parts[] = {
      {sections::kInfo, wire.info},
      {sections::kBase, wire.base},
      {sections::kBlocks, wire.blocks},
      {sections::kPackets, wire.packets},
      {sections::kSeeds, wire.seeds},
      {sections::kHullOuter, hulls.outer},
      {sections::kHullInner, hulls.inner},
      {sections::kMapNormals, maps.normals},
      {sections::kMapColors, maps.colors},
      {sections::kForest, forestBytes}};
  for (const auto& [section, bytes] : parts) {
    const bool mayBeAbsent = section == sections::kHullOuter || section == sections::kHullInner ||
                             section == sections::kMapNormals || section == sections::kMapColors;
    if (bytes.empty() && mayBeAbsent) continue;
    if (auto added = (*writer)->addSection(section, bytes); !added) return added;
  }
  return (*writer)->commit(report);
}

}  // namespace

Result<PreparedModel> prepareModel(
    const std::filesystem::path& input,
    const std::string& name,
    const PrepareOptions& options,
    AssetStore& store,
    const Progress& progress) {
  const auto id = contentId(input, options);
  if (!id) return tl::unexpected(id.error());
  const auto named = [&]() {
    return store.setName({name, *id, std::filesystem::absolute(input).string()});
  };
  auto known = reuse(input, name, *id, store);
  if (!known) return tl::unexpected(known.error());
  if (*known) {
    if (auto set = named(); !set) return tl::unexpected(set.error());
    progress("already prepared", 1.0);
    return std::move(**known);
  }

  Stages stages;
  Stopwatch watch;
  progress("import", 0.0);
  auto imported = importMesh(input);
  if (!imported) return tl::unexpected(imported.error());
  stages.import = watch.lap();
  progress("repair", 0.1);
  auto repaired = repairMesh(*imported, options.repair);
  if (!repaired) return tl::unexpected(repaired.error().within(input.filename().string()));
  // Only the counts are needed from here on.
  imported->positions = {};
  imported->corners = {};
  imported->polygonBegin = {};
  stages.repair = watch.lap();

  progress("hull", 0.2);
  const Hulls hulls = buildHulls(repaired->mesh, options.hull, options.forest.threads);
  if (hulls.filledHoles > 0) repaired->repairs["filled_holes"] = hulls.filledHoles;
  stages.hull = watch.lap();

  progress("simplify", 0.5);
  auto built = buildForest(repaired->mesh, options.forest, repaired->seams);
  if (!built) return tl::unexpected(built.error().within(input.filename().string()));
  repaired->mesh.positions = {};
  repaired->mesh.triangles = {};
  stages.simplify = watch.lap();

  progress("seeds", 0.7);
  const TriangleMesh prepared = fullMesh(built->forest);
  const auto seeds = buildSeeds(
      prepared,
      built->forest.parents,
      built->forest.baseVertexCount(),
      {.azimuths = options.seedAzimuths, .elevations = options.seedElevations});
  if (!seeds) return tl::unexpected(seeds.error().within("seeds"));
  stages.seeds = watch.lap();

  progress("encode", 0.85);
  const auto hullSections = encodeHullSections(hulls);
  stages.encode = watch.lap();
  const MapSections mapSections = encodeMapSections(
      prepared,
      *hullSections,
      options.hullFaces,
      {.texelsPerFace = options.hullFaces <= 1000 ? 256 : 128,
       .creaseAngleDegrees = options.forest.creaseAngleDegrees,
       .threads = options.forest.threads});
  stages.maps = watch.lap();
  const WireSections wire = encodeWireSections(
      *built,
      *seeds,
      {*id, repaired->closed, hullSections->info, mapSections.info});
  stages.encode += watch.lap();

  Json report =
      makeReport(*imported, *repaired, hulls, *hullSections, mapSections, *built, wire, options);
  report["seconds"] = secondsJson(stages);
  report["peak_rss_mib"] = peakRssMib();
  if (auto written =
          writeAsset(wire, built->forest, *hullSections, mapSections, *id, report.dump(), store);
      !written) {
    return tl::unexpected(written.error());
  }
  if (auto set = named(); !set) return tl::unexpected(set.error());
  progress("done", 1.0);
  PreparedModel model{name, *id, prepared, noteOf(report), {}};
  model.reportJson = headed(name, *id, input, std::move(report));
  return model;
}

}  // namespace limn
