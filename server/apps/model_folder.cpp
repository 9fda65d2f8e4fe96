// SPDX-License-Identifier: Apache-2.0
#include "server/apps/model_folder.h"

#include "protocol/messages.h"

#include "shared/core/toml_errors.h"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <system_error>

namespace limn {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 6> kExtensions =
    {".ply", ".obj", ".stl", ".off", ".glb", ".gltf"};
constexpr std::array<std::string_view, 8> kKeys = {
    "quantization",
    "base-faces",
    "cost",
    "placement",
    "crease-angle",
    "viewpoints",
    "hull-faces",
    "threads"};

bool isMeshFile(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return std::ranges::find(kExtensions, extension) != kExtensions.end();
}

Result<std::map<std::string, std::string>> readKeys(const toml::table& table) {
  std::map<std::string, std::string> values;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (name == "models") continue;
    if (std::ranges::find(kKeys, name) == kKeys.end()) {
      return fail(
          ErrorCode::kInvalidArgument,
          unknownTomlKey(node.source().begin.line, name, kKeys));
    }
    if (const auto* text = node.as_string()) {
      values[name] = text->get();
    } else if (const auto* integer = node.as_integer()) {
      values[name] = std::to_string(integer->get());
    } else if (const auto* number = node.as_floating_point()) {
      values[name] = std::to_string(number->get());
    } else {
      return fail(
          ErrorCode::kInvalidArgument,
          wrongTomlValue(node.source().begin.line, name, "a number or a text in quotes"));
    }
  }
  return values;
}

tl::unexpected<Error> wrongModels(const toml::node& node) {
  return fail(
      ErrorCode::kInvalidArgument,
      tomlError(node.source().begin.line, "write [models.NAME] for one model's options"));
}

}  // namespace

Result<PrepareSettings> PrepareSettings::parse(std::string_view text) {
  auto settings = read(text);
  if (!settings) return tl::unexpected(settings.error().within("limn.toml"));
  return settings;
}

Result<PrepareSettings> PrepareSettings::read(std::string_view text) {
  toml::table root;
  // The one parser here that throws.
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    return fail(
        ErrorCode::kInvalidArgument,
        tomlError(error.source().begin.line, error.description()));
  }
  PrepareSettings settings;
  auto common = readKeys(root);
  if (!common) return tl::unexpected(common.error());
  settings.common_ = std::move(*common);
  if (const auto models = root["models"]; models && !models.is_table())
    return wrongModels(*models.node());
  if (const toml::table* models = root["models"].as_table()) {
    for (const auto& [name, node] : *models) {
      const toml::table* table = node.as_table();
      if (table == nullptr) return wrongModels(node);
      auto values = readKeys(*table);
      if (!values) return tl::unexpected(values.error());
      settings.models_[std::string(name.str())] = std::move(*values);
    }
  }
  return settings;
}

PrepareFlags PrepareSettings::flagsFor(const std::string& model) const {
  std::map<std::string, std::string> values = common_;
  if (const auto own = models_.find(model); own != models_.end()) {
    for (const auto& [key, value] : own->second)
      values[key] = value;
  }
  PrepareFlags flags;
  for (const auto& [key, value] : values) {
    flags.push_back("--" + key);
    flags.push_back(value);
  }
  return flags;
}

Result<FolderScan> scanModelFolder(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (isMeshFile(entry->path())) files.push_back(entry->path());
  }
  if (error) {
    return fail(
        ErrorCode::kIo,
        "cannot list the models in " + folder.string() + ": " + error.message());
  }
  PrepareSettings settings;
  if (fs::exists(folder / "limn.toml", error)) {
    std::ifstream in(folder / "limn.toml", std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    auto parsed = PrepareSettings::parse(text);
    if (!parsed) return tl::unexpected(parsed.error());
    settings = std::move(*parsed);
  }
  std::ranges::sort(files);
  FolderScan scan;
  for (const fs::path& path : files) {
    std::string name = path.stem().string();
    if (scan.models.contains(name)) name = path.filename().string();
    if (!protocol::isValidModelName(name)) {
      ++scan.refusedFiles;
      continue;
    }
    ModelFile file;
    file.path = path;
    file.bytes = fs::file_size(path, error);
    if (error) continue;  // gone meanwhile, or no regular file
    const auto modified = fs::last_write_time(path, error);
    if (error) continue;
    file.modified = modified.time_since_epoch().count();
    file.flags = settings.flagsFor(name);
    scan.models[name] = std::move(file);
  }
  return scan;
}

}  // namespace limn
