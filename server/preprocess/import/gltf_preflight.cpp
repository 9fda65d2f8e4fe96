// SPDX-License-Identifier: Apache-2.0
// Based on: Khronos Group, "glTF 2.0 Specification", sections 3.2 (JSON), 3.12 (extensions), 4
// (GLB).
#include "server/preprocess/import/gltf_preflight.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>

namespace limn::import {

namespace {

using nlohmann::json;

constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;
/// Geometry needs five levels; extras may nest more, parsers' stacks end somewhere.
constexpr int kMaxDepth = 64;
/// Parsed JSON takes up to 25 times its text: hundreds of thousands of nodes are enough.
constexpr std::size_t kMaxValues = 4'000'000;

struct Chunks {
  std::string_view text;
  std::string_view binary;
};

tl::unexpected<Error> corrupt(std::string_view what) {
  return fail(
      ErrorCode::kCorrupt,
      std::string(what) + ": the glTF file is damaged or cut; export it again");
}

std::uint32_t wordAt(std::string_view bytes, std::size_t offset) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

Result<Chunks> splitContainer(std::string_view bytes) {
  if (!bytes.starts_with("glTF")) return Chunks{bytes, {}};
  if (bytes.size() < 20) return corrupt("too short for a GLB header");
  if (wordAt(bytes, 4) != 2) {
    return fail(
        ErrorCode::kUnsupported,
        "GLB version " + std::to_string(wordAt(bytes, 4)) +
            ": export it as glTF 2.0, or the file is damaged");
  }
  const std::size_t length = wordAt(bytes, 8);
  if (length > bytes.size() || length < 20) {
    return corrupt(
        "the GLB header promises " + std::to_string(length) + " bytes, the file has " +
        std::to_string(bytes.size()));
  }
  Chunks chunks;
  for (std::size_t at = 12; at + 8 <= length;) {
    const std::size_t size = wordAt(bytes, at);
    const std::uint32_t type = wordAt(bytes, at + 4);
    if (size > length - at - 8) return corrupt("a GLB chunk is longer than the file");
    const std::string_view body = bytes.substr(at + 8, size);
    if (at == 12 && type != kJsonChunk) return corrupt("the first GLB chunk is not JSON");
    if (at == 12) chunks.text = body;
    if (type == kBinaryChunk && chunks.binary.empty()) chunks.binary = body;
    at += 8 + (size + 3) / 4 * 4;
  }
  return chunks;
}

/// What only looks and motion need, and what anybody may add.
bool isIrrelevant(const std::string& key) {
  static constexpr std::array<std::string_view, 12> kKeys{
      "extras",
      "extensions",
      "images",
      "textures",
      "samplers",
      "animations",
      "skins",
      "cameras",
      "targets",
      "name",
      "skin",
      "camera"};
  return std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end();
}

Result<void> checkExtension(const std::string& name) {
  if (name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression") {
    return fail(
        ErrorCode::kUnsupported,
        "the geometry is compressed with " + name + ": export it without compression");
  }
  const bool harmless = name == "KHR_mesh_quantization" || name.starts_with("KHR_materials_") ||
                        name.starts_with("KHR_texture_") || name.starts_with("EXT_texture_") ||
                        name == "KHR_lights_punctual";
  if (harmless) return {};
  return fail(
      ErrorCode::kUnsupported,
      "the file requires the glTF extension \"" + name.substr(0, 64) +
          "\", which Limn does not have: export it without");
}

Result<void> checkRequired(const json& document) {
  const auto required = document.find("extensionsRequired");
  if (required == document.end()) return {};
  if (!required->is_array()) return corrupt("\"extensionsRequired\" is not a list");
  for (const json& name : *required) {
    if (!name.is_string()) return corrupt("\"extensionsRequired\" names no extension");
    if (auto fine = checkExtension(name.get<std::string>()); !fine) return fine;
  }
  return {};
}

/// Every buffer is in this file.
Result<void> checkBuffers(const json& document) {
  const auto buffers = document.find("buffers");
  if (buffers == document.end() || !buffers->is_array()) return {};
  for (const json& buffer : *buffers) {
    if (!buffer.is_object()) return corrupt("a buffer is not an object");
    const auto uri = buffer.find("uri");
    if (uri == buffer.end()) continue;
    if (!uri->is_string()) return corrupt("a buffer's address is not text");
    if (uri->get_ref<const std::string&>().starts_with("data:")) continue;
    return fail(
        ErrorCode::kUnsupported,
        "a buffer is in another file (\"" + uri->get<std::string>().substr(0, 64) +
            "\"): export as one GLB file, or as glTF with embedded buffers");
  }
  return {};
}

/// Of materials only the plain colour is kept.
void reduceMaterials(json& document) {
  const auto materials = document.find("materials");
  if (materials == document.end()) return;
  json reduced = json::array();
  if (materials->is_array()) {
    for (const json& material : *materials) {
      json factor = json::array();
      if (material.is_object() && material.contains("pbrMetallicRoughness") &&
          material["pbrMetallicRoughness"].is_object()) {
        factor = material["pbrMetallicRoughness"].value("baseColorFactor", json::array());
      }
      const bool isColor =
          factor.is_array() && factor.size() == 4 &&
          std::all_of(factor.begin(), factor.end(), [](const json& x) { return x.is_number(); });
      json entry = json::object();
      if (isColor) entry["pbrMetallicRoughness"] = {{"baseColorFactor", factor}};
      reduced.push_back(std::move(entry));
    }
  }
  *materials = std::move(reduced);
}

std::string makeGlb(const std::string& text, std::string_view binary) {
  const auto padded = [](std::size_t size) { return (size + 3) / 4 * 4; };
  std::string glb;
  const auto word = [&](std::size_t value) {
    const auto word32 = static_cast<std::uint32_t>(value);
    glb.append(reinterpret_cast<const char*>(&word32), sizeof word32);
  };
  const std::size_t total =
      12 + 8 + padded(text.size()) + (binary.empty() ? 0 : 8 + padded(binary.size()));
  if (total > std::numeric_limits<std::uint32_t>::max()) return {};
  glb.reserve(total);
  glb += "glTF";
  word(2);
  word(total);
  word(padded(text.size()));
  word(kJsonChunk);
  glb += text;
  glb.append(padded(text.size()) - text.size(), ' ');
  if (!binary.empty()) {
    word(padded(binary.size()));
    word(kBinaryChunk);
    glb += binary;
    glb.append(padded(binary.size()) - binary.size(), '\0');
  }
  return glb;
}

}  // namespace

Result<std::string> preflightGltf(std::string_view bytes) {
  const auto chunks = splitContainer(bytes);
  if (!chunks) return tl::unexpected(chunks.error());
  bool tooDeep = false;
  std::size_t values = 0;
  const auto keep = [&](int depth, json::parse_event_t event, json& parsed) {
    tooDeep = tooDeep || depth > kMaxDepth;
    if (tooDeep || ++values > kMaxValues) return false;
    return event != json::parse_event_t::key || !isIrrelevant(parsed.get_ref<const std::string&>());
  };
  json document = json::parse(chunks->text.begin(), chunks->text.end(), keep, false);
  if (tooDeep) return corrupt("the JSON is nested without end");
  if (values > kMaxValues) {
    return fail(
        ErrorCode::kLimitExceeded,
        "more than 4 million JSON values: keep geometry in binary buffers, or split the model");
  }
  if (document.is_discarded() || !document.is_object()) return corrupt("the JSON cannot be parsed");
  if (auto fine = checkRequired(document); !fine) return tl::unexpected(fine.error());
  if (auto fine = checkBuffers(document); !fine) return tl::unexpected(fine.error());
  reduceMaterials(document);
  const std::string text = document.dump(-1, ' ', false, json::error_handler_t::replace);
  std::string glb = makeGlb(text, chunks->binary);
  if (glb.empty())
    return fail(ErrorCode::kLimitExceeded, "larger than GLB can be (4 GiB): split the model");
  return glb;
}

}  // namespace limn::import
