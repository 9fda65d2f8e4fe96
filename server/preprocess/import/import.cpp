// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/import/import.h"

#include "server/preprocess/import/import_readers.h"
#include "server/preprocess/import/text_scanner.h"

#include "shared/core/ids.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <system_error>

namespace limn {

namespace import {

void endPolygon(ImportedMesh& mesh) {
  const std::uint32_t begin = mesh.polygonBegin.back();
  if (mesh.corners.size() - begin < 3) {
    mesh.corners.resize(begin);
    ++mesh.droppedFaces;
    return;
  }
  mesh.polygonBegin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
}

void endMaterial(ImportedMesh& mesh, std::uint32_t material) {
  mesh.materials.resize(mesh.polygonBegin.size() - 1, material);
}

std::uint32_t vertexIndex(double value) {
  return value >= 0.0 && value < kNone && value == std::floor(value)
             ? static_cast<std::uint32_t>(value)
             : kNone;
}

float linearFromSrgb(double value) {
  if (!(value > 0.0)) return 0.0F;
  if (value >= 1.0) return 1.0F;
  return static_cast<float>(
      value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
}

std::string atLine(std::size_t line, std::string_view what) {
  return "line " + std::to_string(line) + ": " + std::string(what);
}

namespace {

/// Files that people give by mistake, known by their first bytes.
struct KnownMagic {
  std::string_view magic;
  std::string_view message;
};

constexpr std::array kForeign{
    KnownMagic{"\x89PNG", "this is a PNG picture, not a mesh"},
    KnownMagic{"\xFF\xD8\xFF", "this is a JPEG picture, not a mesh"},
    KnownMagic{"GIF8", "this is a GIF picture, not a mesh"},
    KnownMagic{"%PDF", "this is a PDF document, not a mesh"},
    KnownMagic{
        "\x7F"
        "ELF",
        "this is a program, not a mesh"},
    KnownMagic{"\x1F\x8B", "this is a gzip archive: unpack it first (gunzip)"},
    KnownMagic{"BZh", "this is a bzip2 archive: unpack it first (bunzip2)"},
    KnownMagic{
        "\xFD"
        "7zXZ",
        "this is an xz archive: unpack it first (unxz)"},
    KnownMagic{"\x28\xB5\x2F\xFD", "this is a zstd archive: unpack it first (unzstd)"},
    KnownMagic{
        "PK\x03\x04",
        "this is a zip archive (or 3MF): unpack it first, or export PLY, OBJ, STL, OFF or GLB"},
    KnownMagic{"Kaydara FBX", "FBX is not read: export PLY, OBJ, STL, OFF or GLB"},
    KnownMagic{"DRACO", "bare Draco files are not read: export PLY, OBJ, STL, OFF or GLB"},
    KnownMagic{"<?xml", "XML (COLLADA, X3D, AMF …) is not read: export PLY, OBJ, STL, OFF or GLB"},
};

constexpr std::string_view kFormats = "Limn reads PLY, OBJ, STL, OFF, GLB and glTF";

bool isUtf16(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) return true;
  // Without a mark: every other byte of ASCII text is zero.
  if (bytes.size() < 16) return false;
  const auto zerosFrom = [&](std::size_t first) {
    for (std::size_t i = first; i < 16; i += 2) {
      if (bytes[i] != '\0' || bytes[i ^ 1] == '\0') return false;
    }
    return true;
  };
  return zerosFrom(0) || zerosFrom(1);
}

bool looksLikeText(std::string_view bytes) {
  return bytes.substr(0, 4096).find('\0') == bytes.npos;
}

/// An STL whose facet count and length agree to the byte (a short tail aside): not by chance.
bool isBinaryStl(std::string_view bytes) {
  if (bytes.size() < 84 + 50) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count > 0 && bytes.size() == 84 + std::size_t{50} * count;
}

bool isOff(std::string_view bytes) {
  TextScanner scanner(
      bytes.substr(0, 4096),
      {.hashComments = true, .backslashContinuation = false});
  const std::string_view word = scanner.token();
  return word.size() <= 8 && word.ends_with("OFF") &&
         word.find_first_not_of("STCN4n") == word.size() - 3;
}

bool isTextStl(std::string_view bytes) {
  TextScanner scanner(bytes);
  if (!equalsIgnoringCase(scanner.token(), "solid")) return false;
  scanner.nextLine();
  const std::string_view word = scanner.token();
  return word.empty() || equalsIgnoringCase(word, "facet") || equalsIgnoringCase(word, "endsolid");
}

bool isObj(std::string_view bytes) {
  TextScanner scanner(
      bytes.substr(0, 1 << 16),
      {.hashComments = true, .backslashContinuation = true});
  do {
    const std::string_view word = scanner.tokenOnLine();
    if (word == "v") return true;
  } while (scanner.nextLine());
  return false;
}

Result<ImportedMesh> readUnchecked(std::string_view bytes, const std::string& extension) {
  for (const KnownMagic& foreign : kForeign) {
    if (bytes.starts_with(foreign.magic)) {
      return fail(
          ErrorCode::kUnsupported,
          std::string(foreign.message) + "; " + std::string(kFormats));
    }
  }
  if (bytes.starts_with("glTF")) return readGltf(bytes);
  if (bytes.starts_with("ply") && bytes.size() > 3 &&
      std::isspace(static_cast<unsigned char>(bytes[3])) != 0) {
    return readPly(bytes);
  }
  if (isBinaryStl(bytes)) return readStlBinary(bytes);
  if (isUtf16(bytes)) return fail(ErrorCode::kUnsupported, "the text is UTF-16: save it as UTF-8");
  const std::string_view text = bytes.starts_with("\xEF\xBB\xBF") ? bytes.substr(3) : bytes;
  if (isOff(text)) return readOff(text);
  if (looksLikeText(text)) {
    if (isTextStl(text)) return readStlText(text);
    if (text.find_first_not_of(" \t\r\n") != text.npos &&
        text[text.find_first_not_of(" \t\r\n")] == '{') {
      return readGltf(text);
    }
    if (extension == ".off") return readOff(text);
    if (extension == ".obj" || isObj(text)) return readObj(text);
  }
  if (extension == ".stl") return readStlBinary(bytes);
  if (extension == ".ply")
    return fail(
        ErrorCode::kCorrupt,
        "does not begin with \"ply\": this is not a PLY file; check where it came from");
  if (extension == ".obj" || extension == ".off" || extension == ".gltf") {
    return fail(
        ErrorCode::kCorrupt,
        "binary data where text is expected: this is not an " + extension.substr(1) +
            " file; check where it came from");
  }
  if (extension == ".glb")
    return fail(
        ErrorCode::kCorrupt,
        "does not begin with \"glTF\": this is not a GLB file; check where it came from");
  return fail(
      ErrorCode::kUnsupported,
      "neither content nor name is that of a mesh file; " + std::string(kFormats));
}

/// Leaves out polygons that name vertices the file does not have.
Result<void> dropInvalidFaces(ImportedMesh& mesh) {
  const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
  std::uint32_t kept = 0;
  std::uint32_t out = 0;
  const auto polygons = static_cast<std::uint32_t>(mesh.polygonBegin.size() - 1);
  std::uint32_t begin = 0;
  for (std::uint32_t p = 0; p < polygons; ++p) {
    const std::uint32_t end = mesh.polygonBegin[p + 1];
    bool valid = true;
    for (std::uint32_t c = begin; c < end; ++c)
      valid = valid && mesh.corners[c] < vertices;
    if (valid) {
      for (std::uint32_t c = begin; c < end; ++c)
        mesh.corners[out++] = mesh.corners[c];
      if (!mesh.materials.empty()) mesh.materials[kept] = mesh.materials[p];
      mesh.polygonBegin[++kept] = out;
    }
    begin = end;
  }
  mesh.corners.resize(out);
  mesh.polygonBegin.resize(kept + 1);
  if (!mesh.materials.empty()) mesh.materials.resize(kept);
  const std::uint64_t dropped = std::uint64_t{mesh.droppedFaces} + (polygons - kept);
  mesh.droppedFaces = static_cast<std::uint32_t>(std::min<std::uint64_t>(dropped, kNone));
  // A stray bad face is an exporter's slip; mostly bad faces are no mesh at all.
  if (kept < dropped || kept == 0) {
    return fail(
        ErrorCode::kCorrupt,
        std::to_string(dropped) + " of " + std::to_string(dropped + kept) +
            " faces have too few corners or name vertices that the file does not have: "
            "it is damaged; export it again");
  }
  return {};
}

}  // namespace

}  // namespace import

Result<ImportedMesh> importMesh(std::string_view bytes, std::string_view extension) {
  if (bytes.empty()) return fail(ErrorCode::kCorrupt, "the file is empty: get a whole copy");
  std::string lower(extension);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  try {
    auto mesh = import::readUnchecked(bytes, lower);
    if (!mesh) return mesh;
    if (auto checked = import::dropInvalidFaces(*mesh); !checked) {
      return tl::unexpected(checked.error());
    }
    return mesh;
  } catch (const std::bad_alloc&) {
    return fail(
        ErrorCode::kLimitExceeded,
        "not enough memory to read the model: simplify or split it");
  }
}

Result<ImportedMesh> importMesh(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) {
    return fail(ErrorCode::kNotFound, file.string() + ": no such file; check the path");
  }
  if (!std::filesystem::is_regular_file(status)) {
    return fail(ErrorCode::kIo, file.string() + ": not a regular file; name a mesh file");
  }
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) return fail(ErrorCode::kIo, file.string() + ": " + error.message());
  if (size > kMaxImportBytes) {
    return fail(
        ErrorCode::kLimitExceeded,
        file.string() + ": larger than 4 GiB; simplify or split the model");
  }
  // Read, not mapped: a file that somebody shortens meanwhile must be an error, not a SIGBUS.
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(
      std::fopen(file.c_str(), "rb"),
      &std::fclose);
  if (!stream)
    return fail(ErrorCode::kIo, file.string() + ": cannot be opened; check its permissions");
  const std::unique_ptr<char[]> bytes(new (std::nothrow) char[std::max<std::size_t>(size, 1)]);
  if (!bytes)
    return fail(ErrorCode::kLimitExceeded, file.string() + ": not enough memory to read it");
  const std::size_t got = std::fread(bytes.get(), 1, size, stream.get());
  if (got != size)
    return fail(ErrorCode::kIo, file.string() + ": cannot be read; is it being written?");
  auto mesh = importMesh(std::string_view(bytes.get(), got), file.extension().string());
  if (!mesh) return tl::unexpected(mesh.error().within(name));
  return mesh;
}

}  // namespace limn
