// SPDX-License-Identifier: Apache-2.0
#include "client/load/script.h"

#include "shared/core/toml_errors.h"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

namespace limn::load {
namespace {

struct BehaviourName {
  std::string_view name;
  Behaviour behaviour;
};

constexpr std::array<BehaviourName, 6> kBehaviours{{
    {"normal", Behaviour::kNormal},
    {"idle", Behaviour::kIdle},
    {"slow-reader", Behaviour::kSlowReader},
    {"churn", Behaviour::kChurn},
    {"flood", Behaviour::kFlood},
    {"malformed", Behaviour::kMalformed},
}};

std::size_t lineOf(const toml::node& node) {
  return node.source().begin.line;
}

/// Reads the keys of one table; remembers the first complaint, so that callers read on in a line.
class TableReader {
 public:
  explicit TableReader(const toml::table& table) : table_(table) {}

  void number(std::string_view key, double low, double high, double& value) {
    known_.push_back(key);
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    const std::optional<double> found =
        node->is_number() ? node->value<double>() : std::optional<double>();
    if (!found || !(*found >= low && *found <= high)) {
      complain(wrongTomlValue(lineOf(*node), key, tomlNumberFrom(low, high)));
      return;
    }
    value = *found;
  }

  template <class Integer>
  void integer(std::string_view key, Integer low, Integer high, Integer& value) {
    double wide = value;
    number(key, low, high, wide);
    if (wide != std::floor(wide)) {
      complain(wrongTomlValue(lineOf(*table_.get(key)), key, "a whole number"));
      return;
    }
    value = static_cast<Integer>(wide);
  }

  void texts(std::string_view key, std::vector<std::string>& values) {
    known_.push_back(key);
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    const toml::array* array = node->as_array();
    if (array == nullptr || array->size() > 15) {
      return complain(wrongTomlValue(lineOf(*node), key, "a list of at most 15 texts"));
    }
    for (const toml::node& entry : *array) {
      const auto value = entry.value<std::string>();
      if (!value) return complain(wrongTomlValue(lineOf(entry), key, "a list of texts"));
      values.push_back(*value);
    }
  }

  void text(std::string_view key, std::string& value) {
    known_.push_back(key);
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    const std::optional<std::string> found = node->value<std::string>();
    if (!node->is_string() || !found || found->empty()) {
      complain(wrongTomlValue(lineOf(*node), key, "a text in quotes"));
      return;
    }
    value = *found;
  }

  void flag(std::string_view key, bool& value) {
    known_.push_back(key);
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    if (!node->is_boolean()) {
      complain(wrongTomlValue(lineOf(*node), key, "true or false"));
      return;
    }
    value = *node->value<bool>();
  }

  void complain(std::string message) {
    if (!complaint_) complaint_ = std::move(message);
  }

  /// The first complaint; an unknown key is one.
  [[nodiscard]] std::optional<std::string> complaint() const {
    if (complaint_) return complaint_;
    for (const auto& [key, node] : table_) {
      if (std::find(known_.begin(), known_.end(), key.str()) == known_.end()) {
        return unknownTomlKey(lineOf(node), key.str(), known_);
      }
    }
    return std::nullopt;
  }

 private:
  const toml::table& table_;
  std::vector<std::string_view> known_;
  std::optional<std::string> complaint_;
};

Result<std::string> readFile(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    return fail(ErrorCode::kNotFound, file.string() + ": cannot be read; check the path");
  }
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

Result<Phase> parsePhase(const toml::table& table, const std::filesystem::path& folder) {
  Phase phase;
  std::string behaviour = "normal";
  TableReader reader(table);
  reader.integer<std::uint32_t>("clients", 1, 100'000, phase.clients);
  reader.number("ramp_s", 0.0, 86'400.0, phase.rampSeconds);
  reader.number("hold_s", 0.0, 86'400.0, phase.holdSeconds);
  reader.number("delay_s", 0.0, 86'400.0, phase.delaySeconds);
  reader.text("model", phase.model);
  reader.texts("also", phase.also);
  reader.text("path", phase.path);
  reader.number("speed_deg_s", -3'600.0, 3'600.0, phase.speedDegreesPerSecond);
  reader.number("elevation_deg", -90.0, 90.0, phase.elevationDegrees);
  reader.number("distance", 0.01, 1'000.0, phase.distanceRadii);
  reader.number("fov", 1.0, 170.0, phase.fovDegrees);
  reader.number("rate_hz", 0.01, 1'000.0, phase.rateHz);
  reader.number("link_kbps", 0.0, 1e9, phase.linkKbps);
  reader.number("error_px", 0.1, 64.0, phase.errorPx);
  reader.integer<std::uint16_t>("width", 1, 16'384, phase.width);
  reader.integer<std::uint16_t>("height", 1, 16'384, phase.height);
  reader.text("behaviour", behaviour);
  reader.flag("with_previous", phase.withPrevious);
  reader.flag("measured", phase.measured);
  reader.flag("returns", phase.returns);
  const auto* found = std::find_if(kBehaviours.begin(), kBehaviours.end(), [&](const auto& entry) {
    return entry.name == behaviour;
  });
  if (found == kBehaviours.end()) {
    std::string names = "one of";
    for (const BehaviourName& entry : kBehaviours)
      names += " " + std::string(entry.name);
    reader.complain(wrongTomlValue(lineOf(*table.get("behaviour")), "behaviour", names));
  } else {
    phase.behaviour = found->behaviour;
  }
  if (phase.model.empty())
    reader.complain(tomlError(lineOf(table), "the phase names no model: write model = \"NAME\""));
  if (const auto complaint = reader.complaint()) {
    return fail(ErrorCode::kInvalidArgument, *complaint);
  }
  if (phase.behaviour == Behaviour::kSlowReader && phase.linkKbps == 0.0) phase.linkKbps = 32.0;
  if (phase.path != "orbit") {
    auto recorded = readRecordedPath(folder / phase.path);
    if (!recorded) return tl::unexpected(recorded.error());
    phase.recorded = std::move(*recorded);
  }
  return phase;
}

}  // namespace

const std::vector<std::string>& thresholdNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{
        "failed",
        "dropped",
        "decode_errors",
        "server_rss_growth_mib",
        "server_cpu_seconds"};
    for (const char* latency : {"connect", "base", "pose_to_packet", "settled"}) {
      for (const char* statistic : {"p50", "p95", "p99", "max"}) {
        all.push_back(std::string(latency) + "_" + statistic + "_ms");
      }
    }
    return all;
  }();
  return names;
}

Result<Script> parseScript(std::string_view text, const std::filesystem::path& folder) {
  toml::table root;
  // Debian's library is built with exceptions, so they are caught here.
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    return fail(
        ErrorCode::kInvalidArgument,
        tomlError(error.source().begin.line, error.description()));
  }
  Script script;
  for (const auto& [key, node] : root) {
    if (key.str() == "phase" && node.is_array_of_tables()) continue;
    if (key.str() == "thresholds" && node.is_table()) continue;
    if (key.str() == "decode" && node.is_number()) {
      script.decode = *node.value<double>();
      if (script.decode >= 0.0 && script.decode <= 1.0) continue;
      return fail(
          ErrorCode::kInvalidArgument,
          wrongTomlValue(lineOf(node), "decode", tomlNumberFrom(0.0, 1.0)));
    }
    return fail(
        ErrorCode::kInvalidArgument,
        tomlError(
            lineOf(node),
            "'" + std::string(key.str()) +
                "' is not part of a script; it has [[phase]], decode = FRACTION and "
                "[thresholds]"));
  }
  if (const toml::array* phases = root.get_as<toml::array>("phase")) {
    for (const toml::node& node : *phases) {
      auto phase = parsePhase(*node.as_table(), folder);
      if (!phase) return tl::unexpected(phase.error());
      script.phases.push_back(std::move(*phase));
    }
  }
  if (script.phases.empty()) {
    return fail(
        ErrorCode::kInvalidArgument,
        "the script has no [[phase]], so there is nothing to do");
  }
  if (const toml::table* thresholds = root.get_as<toml::table>("thresholds")) {
    TableReader reader(*thresholds);
    for (const std::string& name : thresholdNames()) {
      double bound = std::numeric_limits<double>::quiet_NaN();
      reader.number(name, 0.0, 1e12, bound);
      if (!std::isnan(bound)) script.thresholds[name] = bound;
    }
    if (const auto complaint = reader.complaint()) {
      return fail(ErrorCode::kInvalidArgument, *complaint);
    }
  }
  return script;
}

Result<Script> readScript(const std::filesystem::path& file) {
  const auto text = readFile(file);
  if (!text) return tl::unexpected(text.error());
  auto script = parseScript(*text, file.parent_path());
  if (!script) return tl::unexpected(script.error().within(file.string()));
  return script;
}

}  // namespace limn::load
