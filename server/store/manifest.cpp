// SPDX-License-Identifier: Apache-2.0
#include "server/store/manifest.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace limn {
namespace {

using nlohmann::json;

std::string dump(const json& value, int indent) {
  return value.dump(indent, ' ', false, json::error_handler_t::replace);
}

std::optional<std::string> stringField(const json& object, const char* key) {
  const auto field = object.find(key);
  if (field == object.end() || !field->is_string()) return std::nullopt;
  return field->get<std::string>();
}

std::optional<std::uint64_t> countField(const json& object, const char* key) {
  const auto field = object.find(key);
  if (field == object.end() || !field->is_number_unsigned()) return std::nullopt;
  return field->get<std::uint64_t>();
}

std::optional<Sha256Digest> digestField(const json& object, const char* key) {
  const auto text = stringField(object, key);
  return text ? digestFromHex(*text) : std::nullopt;
}

json parse(std::span<const std::uint8_t> text) {
  return json::parse(text.begin(), text.end(), nullptr, false);
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

Sha256Digest
nameChecksum(const std::string& name, const Sha256Digest& asset, const std::string& source) {
  const std::string text = name + '\n' + toHex(asset) + '\n' + source;
  return sha256({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace

int assetFormatOf(const std::string& reportJson) {
  const auto report = nlohmann::json::parse(reportJson, nullptr, false);
  if (!report.is_object()) return 0;
  const auto format = report.find("asset_format");
  return format != report.end() && format->is_number_integer() ? format->get<int>() : 0;
}

bool isSectionName(std::string_view name) {
  return !name.empty() && name.size() <= 64 && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  });
}

bool isModelName(std::string_view name) {
  if (name.empty() || name.size() > kMaxStoreNameBytes) return false;
  for (const char c : name) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) return false;
  }
  // The JSON parser accepts exactly well-formed UTF-8, and escaping leaves it as it is.
  const std::string quoted =
      json(std::string(name)).dump(-1, ' ', false, json::error_handler_t::ignore);
  const json back = json::parse(quoted, nullptr, false);
  return back.is_string() && back.get_ref<const std::string&>() == name;
}

std::optional<Sha256Digest> digestFromHex(std::string_view hex) {
  Sha256Digest digest{};
  if (hex.size() != 2 * digest.size()) return std::nullopt;
  for (std::size_t i = 0; i < digest.size(); ++i) {
    const int high = hexDigit(hex[2 * i]);
    const int low = hexDigit(hex[2 * i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    digest[i] = static_cast<std::uint8_t>(high * 16 + low);
  }
  return digest;
}

Result<std::string> serializeManifest(const Manifest& manifest) {
  const json report = json::parse(manifest.report, nullptr, false);
  if (!report.is_object()) {
    return fail(ErrorCode::kInvalidArgument, "an asset's report must be a JSON object");
  }
  json list = json::array();
  for (const Manifest::Section& section : manifest.sections) {
    list.push_back(
        {{"name", section.name},
         {"file", section.file},
         {"bytes", section.bytes},
         {"sha256", toHex(section.sha256)}});
  }
  const json root = {
      {"format", kStoreFormat},
      {"id", toHex(manifest.id)},
      {"sections", list},
      {"report", report}};
  return dump(root, 1) + '\n';
}

Result<Manifest> parseManifest(std::span<const std::uint8_t> text) {
  const auto corrupt = [](const char* what) {
    return fail(ErrorCode::kCorrupt, std::string("manifest.json: ") + what);
  };
  const json root = parse(text);
  if (!root.is_object()) return corrupt("not a JSON object");
  const auto format = countField(root, "format");
  if (!format) return corrupt("no format version");
  if (*format != kStoreFormat) {
    return fail(
        ErrorCode::kUnsupported,
        "manifest.json: format " + std::to_string(*format) + ", this build reads format " +
            std::to_string(kStoreFormat) + "; prepare the model again");
  }
  Manifest manifest;
  const auto id = digestField(root, "id");
  if (!id) return corrupt("no id");
  manifest.id = *id;
  const auto list = root.find("sections");
  if (list == root.end() || !list->is_array()) return corrupt("no list of sections");
  for (const json& entry : *list) {
    if (!entry.is_object()) return corrupt("a section is not an object");
    const auto name = stringField(entry, "name");
    const auto file = stringField(entry, "file");
    const auto bytes = countField(entry, "bytes");
    const auto sha = digestField(entry, "sha256");
    if (!name || !file || !bytes || !sha) return corrupt("a section lacks a field");
    // The file name must not lead out of the asset's directory.
    if (!isSectionName(*name) || *file != *name + ".bin") return corrupt("a section's name is odd");
    for (const Manifest::Section& before : manifest.sections) {
      if (before.name == *name) return corrupt("a section is there twice");
    }
    manifest.sections.push_back({*name, *file, *bytes, *sha});
  }
  const auto report = root.find("report");
  if (report == root.end() || !report->is_object()) return corrupt("no report");
  manifest.report = dump(*report, -1);
  return manifest;
}

std::string serializeNameRecord(const NameRecord& record) {
  // An odd source path is stored as far as it is UTF-8; the checksum covers what is stored.
  const json cleaned = json::parse(dump(json(record.source), -1), nullptr, false);
  const std::string source = cleaned.is_string() ? cleaned.get<std::string>() : std::string();
  const json root = {
      {"format", kStoreFormat},
      {"name", record.name},
      {"asset", toHex(record.asset)},
      {"source", source},
      {"sha256", toHex(nameChecksum(record.name, record.asset, source))}};
  return dump(root, 1) + '\n';
}

Result<NameRecord> parseNameRecord(std::span<const std::uint8_t> text) {
  const json root = parse(text);
  const auto corrupt = [] { return fail(ErrorCode::kCorrupt, "the name's record is damaged"); };
  if (!root.is_object() || countField(root, "format") != kStoreFormat) return corrupt();
  const auto name = stringField(root, "name");
  const auto asset = digestField(root, "asset");
  const auto source = stringField(root, "source");
  const auto sha = digestField(root, "sha256");
  if (!name || !asset || !source || !sha) return corrupt();
  if (*sha != nameChecksum(*name, *asset, *source) || !isModelName(*name)) return corrupt();
  NameRecord record{*name, *asset, *source};
  // The text must be the one canonical form, so that no flipped byte passes unnoticed.
  const std::string canonical = serializeNameRecord(record);
  if (!std::ranges::equal(canonical, text, {}, [](char c) {
        return static_cast<std::uint8_t>(c);
      })) {
    return corrupt();
  }
  return record;
}

std::string nameFile(std::string_view name) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  constexpr std::size_t kLongest = 240;  // with ".json" below the 255 bytes of common file systems
  std::string file;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '_' || (c == '.' && !file.empty());
    if (plain) {
      file += c;
    } else {
      file += '%';
      file += kDigits[byte >> 4];
      file += kDigits[byte & 15];
    }
  }
  if (file.size() > kLongest) {
    file = "%sha256-" +
           toHex(sha256({reinterpret_cast<const std::uint8_t*>(name.data()), name.size()}));
  }
  return file + ".json";
}

}  // namespace limn
