// SPDX-License-Identifier: Apache-2.0
#include "client/net/asset_files.h"

#include "protocol/framing.h"
#include "protocol/messages.h"

#include "shared/core/sha256.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>
#include <utility>

namespace limn {
namespace {

using nlohmann::json;

constexpr int kFormat = 1;
constexpr std::uintmax_t kMaxManifestBytes = 1024 * 1024;
constexpr std::uintmax_t kMaxSectionBytes = 4ULL * 1024 * 1024 * 1024;

tl::unexpected<Error> damaged(const std::filesystem::path& path, const std::string& what) {
  return fail(
      ErrorCode::kCorrupt,
      path.string() + ": " + what + "; prepare the model again with limn-prepare");
}

Result<std::vector<std::uint8_t>> readFile(
    const std::filesystem::path& path,
    std::uintmax_t maxBytes) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return fail(ErrorCode::kIo, "cannot read " + path.string() + ": " + error.message());
  if (size > maxBytes) {
    return fail(ErrorCode::kLimitExceeded, path.string() + " is larger than any asset's file");
  }
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  std::ifstream in(path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()))) {
    return fail(ErrorCode::kIo, "cannot read " + path.string());
  }
  return bytes;
}

struct SectionEntry {
  std::string file;
  std::uint64_t bytes = 0;
  std::string sha256;
};

/// The manifest's text, its checksum verified.
Result<json> readManifest(const std::filesystem::path& directory) {
  const auto path = directory / "manifest.json";
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return fail(
        ErrorCode::kNotFound,
        directory.string() +
            " is no prepared asset: it has no manifest.json (assets lie in "
            "STORE/assets/ID)");
  }
  const auto bytes = readFile(path, kMaxManifestBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto sum = readFile(directory / "manifest.sha256", 256);
  if (!sum) return damaged(directory, "manifest.sha256 is missing");
  if (!std::ranges::equal(*sum, toHex(sha256(*bytes)) + "\n"))
    return damaged(path, "does not match its checksum");
  json manifest = json::parse(bytes->begin(), bytes->end(), nullptr, false);
  if (!manifest.is_object()) return damaged(path, "is not JSON");
  const auto format = manifest.find("format");
  if (format == manifest.end() || !format->is_number_integer())
    return damaged(path, "has no format");
  if (format->get<std::int64_t>() != kFormat) {
    return fail(
        ErrorCode::kUnsupported,
        path.string() + " has format " + format->dump() + ", this program reads format 1");
  }
  return manifest;
}

Result<SectionEntry>
findSection(const json& manifest, const std::filesystem::path& path, const std::string& name) {
  const auto sections = manifest.find("sections");
  if (sections == manifest.end() || !sections->is_array()) return damaged(path, "has no sections");
  for (const json& entry : *sections) {
    if (!entry.is_object() || entry.value("name", json()) != json(name)) continue;
    const json file = entry.value("file", json());
    const json bytes = entry.value("bytes", json());
    const json sum = entry.value("sha256", json());
    // The file lies in this directory and nowhere else.
    if (!file.is_string() || file.get<std::string>() != name + ".bin" ||
        !bytes.is_number_unsigned() || !sum.is_string()) {
      return damaged(path, "describes section " + name + " wrongly");
    }
    return SectionEntry{
        file.get<std::string>(),
        bytes.get<std::uint64_t>(),
        sum.get<std::string>()};
  }
  return fail(ErrorCode::kNotFound, "no section " + name);
}

/// The messages of one section, its length and checksum verified.
Result<std::vector<std::vector<std::uint8_t>>>
readSection(const json& manifest, const std::filesystem::path& directory, const std::string& name) {
  const auto entry = findSection(manifest, directory / "manifest.json", name);
  if (!entry) return tl::unexpected(entry.error());
  const auto path = directory / entry->file;
  const auto bytes = readFile(path, kMaxSectionBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  if (bytes->size() != entry->bytes || toHex(sha256(*bytes)) != entry->sha256) {
    return damaged(path, "does not match its checksum");
  }
  std::vector<std::vector<std::uint8_t>> messages;
  protocol::FrameReader frames(*bytes);
  while (true) {
    const auto frame = frames.next();
    if (!frame) return damaged(path, frame.error().message);
    if (!*frame) return messages;
    messages.emplace_back((*frame)->begin(), (*frame)->end());
  }
}

/// Whether this program reads what the sections hold.
Result<void> checkAssetFormat(const json& manifest, const std::filesystem::path& directory) {
  const json report = manifest.value("report", json());
  const json written = report.is_object() ? report.value("asset_format", json()) : json();
  const bool isNumber = written.is_number_integer();
  const std::int64_t format = isNumber ? written.get<std::int64_t>() : 0;
  if (format == protocol::kAssetFormat) return {};
  return fail(
      ErrorCode::kUnsupported,
      directory.string() + " was prepared by " +
          (format < protocol::kAssetFormat ? "an older" : "a newer") + " Limn (asset format " +
          (isNumber ? std::to_string(format) : "before 7") + ", this program reads " +
          std::to_string(protocol::kAssetFormat) +
          "): prepare the model again with this version's limn-prepare");
}

/// What the preparation called the model; informative.
std::string nameIn(const json& manifest) {
  const auto report = manifest.find("report");
  if (report != manifest.end() && report->is_object()) {
    const json name = report->value("name", json());
    if (name.is_string() && protocol::isValidModelName(name.get<std::string>())) {
      return name.get<std::string>();
    }
  }
  return "asset";
}

}  // namespace

Result<AssetFiles> readAssetFiles(const std::filesystem::path& directory) {
  const auto manifest = readManifest(directory);
  if (!manifest) return tl::unexpected(manifest.error());
  if (auto readable = checkAssetFormat(*manifest, directory); !readable)
    return tl::unexpected(readable.error());
  AssetFiles files;
  auto info = readSection(*manifest, directory, "info");
  if (!info) return tl::unexpected(info.error());
  if (info->size() != 1) return damaged(directory, "section info does not hold one message");
  files.info = std::move(info->front());
  const auto message = protocol::decodeMessage(files.info, protocol::Sender::kServer);
  if (!message) return damaged(directory, message.error().message);
  const auto* model = message->as<protocol::ModelInfo>();
  if (model == nullptr) return damaged(directory, "section info holds no model description");
  if (manifest->value("id", json()) != json(toHex(model->asset))) {
    return damaged(directory, "is described as another asset than it holds");
  }
  files.name = nameIn(*manifest);
  constexpr std::array kOptional = {"blocks", "seeds", "packets"};
  auto base = readSection(*manifest, directory, "base");
  if (!base) return tl::unexpected(base.error());
  std::move(base->begin(), base->end(), std::back_inserter(files.payload));
  for (const char* name : kOptional) {
    auto section = readSection(*manifest, directory, name);
    if (!section && section.error().code == ErrorCode::kNotFound) continue;
    if (!section) return tl::unexpected(section.error());
    std::move(section->begin(), section->end(), std::back_inserter(files.payload));
  }
  const auto readOptional = [&](const char* name, auto& messages) -> Result<void> {
    auto section = readSection(*manifest, directory, name);
    if (section)
      messages = std::move(*section);
    else if (section.error().code != ErrorCode::kNotFound)
      return tl::unexpected(section.error());
    return {};
  };
  auto read = readOptional("hull-outer", files.hulls[0]);
  if (read) read = readOptional("hull-inner", files.hulls[1]);
  if (read) read = readOptional("map-normals", files.maps[0]);
  if (read) read = readOptional("map-colors", files.maps[1]);
  if (!read) return tl::unexpected(read.error());
  return files;
}

}  // namespace limn
