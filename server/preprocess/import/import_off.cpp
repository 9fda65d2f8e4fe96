// SPDX-License-Identifier: Apache-2.0
// Based on: Geomview manual, "OFF Files": [ST][C][N][4][n]OFF [BINARY]. The keyword may be missing.
#include "server/preprocess/import/import_readers.h"
#include "server/preprocess/import/text_scanner.h"

#include "shared/core/ids.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>

namespace limn::import {

namespace {

struct Variant {
  bool textureCoordinates = false;
  bool colors = false;
  bool normals = false;
  bool homogeneous = false;
  bool anyDimension = false;
};

std::optional<Variant> parseKeyword(std::string_view word) {
  Variant variant;
  const auto take = [&](std::string_view prefix) {
    if (!word.starts_with(prefix)) return false;
    word.remove_prefix(prefix.size());
    return true;
  };
  variant.textureCoordinates = take("ST");
  variant.colors = take("C");
  variant.normals = take("N");
  variant.homogeneous = take("4");
  variant.anyDimension = take("n");
  if (word != "OFF") return std::nullopt;
  return variant;
}

tl::unexpected<Error> cut() {
  return fail(
      ErrorCode::kCorrupt,
      "the OFF file ends before its last vertex or face: it was cut or its counts are wrong; get a "
      "whole copy");
}

/// Checks what an OFF header claims against the bytes that are left.
Result<void> checkCounts(
    double vertices,
    double faces,
    double vertexBytes,
    double faceBytes,
    std::size_t remaining) {
  if (!(vertices >= 0.0) || !(faces >= 0.0)) {
    return fail(
        ErrorCode::kCorrupt,
        "negative counts in the OFF header: the file is damaged; export it again");
  }
  if (vertices * vertexBytes + faces * faceBytes > static_cast<double>(remaining) + 1.0 ||
      vertices >= kNone) {
    return fail(
        ErrorCode::kCorrupt,
        "the OFF header promises " + std::to_string(vertices).substr(0, 18) + " vertices and " +
            std::to_string(faces).substr(0, 18) +
            " faces, more than the file can hold: it was cut or the header is wrong; get a whole "
            "copy");
  }
  if (vertices == 0.0 || faces == 0.0) {
    return fail(
        ErrorCode::kUnsupported,
        "the OFF file has no vertex or no face: export the surface again");
  }
  return {};
}

/// OFF as text, behind its keyword.
class TextReader {
 public:
  TextReader(TextScanner& scanner, const Variant& variant) : scanner_(scanner), variant_(variant) {}

  Result<ImportedMesh> read(std::string_view firstCount) {
    const Number vertices = parseNumber(firstCount);
    const Number faces = parseNumber(scanner_.token());
    if (vertices.status != Number::Status::kOk || faces.status != Number::Status::kOk) {
      return broken("the OFF header needs the numbers of vertices and faces");
    }
    scanner_.nextLine();  // number of edges, unused by everybody
    const double vertexBytes = variant_.homogeneous ? 8.0 : 6.0;
    const auto sane =
        checkCounts(vertices.value, faces.value, vertexBytes, 2.0, scanner_.remaining());
    if (!sane) return tl::unexpected(sane.error());
    mesh_.format = "off";
    const auto vertexCount = static_cast<std::size_t>(vertices.value);
    mesh_.positions.reserve(vertexCount);
    for (std::size_t v = 0; v < vertexCount; ++v) {
      if (auto done = readVertex(); !done) return tl::unexpected(done.error());
    }
    const auto faceCount = static_cast<std::size_t>(faces.value);
    for (std::size_t f = 0; f < faceCount; ++f) {
      if (auto done = readFace(); !done) return tl::unexpected(done.error());
    }
    linearizeColors();
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> broken(std::string_view what) const {
    return fail(
        ErrorCode::kCorrupt,
        atLine(scanner_.line(), what) + ": the OFF file is damaged; export it again");
  }

  Result<void> readVertex() {
    std::array<double, 4> position{0.0, 0.0, 0.0, 1.0};
    for (std::size_t k = 0; k < (variant_.homogeneous ? 4U : 3U); ++k) {
      const std::string_view token = k == 0 ? scanner_.token() : scanner_.tokenOnLine();
      if (token.empty() && scanner_.atEnd()) return cut();
      const Number number = parseNumber(token);
      if (number.status == Number::Status::kTooLarge) {
        return broken("a coordinate is beyond the range of a double");
      }
      if (number.status == Number::Status::kMalformed) {
        return broken("a vertex needs three numbers");
      }
      position[k] = number.value;
    }
    const double w = position[3];
    mesh_.positions.emplace_back(position[0] / w, position[1] / w, position[2] / w);
    if (variant_.normals) mesh_.normals.push_back(readThree());
    if (variant_.colors) mesh_.colors.push_back(readThree());
    scanner_.nextLine();
    return {};
  }

  glm::vec3 readThree() {
    glm::vec3 value(0.0F);
    for (int k = 0; k < 3; ++k) {
      value[k] = static_cast<float>(parseNumber(scanner_.tokenOnLine()).value);
    }
    return value;
  }

  Result<void> readFace() {
    const std::string_view token = scanner_.token();
    if (token.empty()) return cut();
    const Number count = parseNumber(token);
    if (count.status != Number::Status::kOk || !(count.value >= 0.0)) {
      return broken("a face needs its number of corners");
    }
    if (count.value > static_cast<double>(scanner_.remaining())) return cut();
    const auto corners = static_cast<std::size_t>(count.value);
    for (std::size_t k = 0; k < corners; ++k) {
      const std::string_view corner = scanner_.token();
      if (corner.empty()) return cut();
      const Number index = parseNumber(corner);
      if (index.status == Number::Status::kMalformed) {
        return broken("a face's corner is not a number");
      }
      mesh_.corners.push_back(vertexIndex(index.value));
    }
    endPolygon(mesh_);
    scanner_.nextLine();  // its colour, if any
    return {};
  }

  /// Colours are 0 … 255 or 0 … 1, and only the numbers tell which.
  void linearizeColors() {
    const double scale =
        std::any_of(
            mesh_.colors.begin(),
            mesh_.colors.end(),
            [](const glm::vec3& c) { return c.r > 1.0F || c.g > 1.0F || c.b > 1.0F; })
            ? 255.0
            : 1.0;
    for (glm::vec3& color : mesh_.colors) {
      for (int k = 0; k < 3; ++k)
        color[k] = linearFromSrgb(static_cast<double>(color[k]) / scale);
    }
  }

  TextScanner& scanner_;
  Variant variant_;
  ImportedMesh mesh_;
};

/// Big-endian 32-bit words, as OFF BINARY has them.
class Words {
 public:
  explicit Words(std::string_view bytes) : bytes_(bytes) {}

  [[nodiscard]] std::size_t remaining() const { return bytes_.size() / 4; }

  [[nodiscard]] bool failed() const { return failed_; }

  std::int32_t nextInt() { return std::bit_cast<std::int32_t>(next()); }

  float nextFloat() { return std::bit_cast<float>(next()); }

 private:
  std::uint32_t next() {
    if (bytes_.size() < 4) {
      failed_ = true;
      return 0;
    }
    std::uint32_t word = 0;
    for (int k = 0; k < 4; ++k)
      word = word << 8 | static_cast<unsigned char>(bytes_[static_cast<std::size_t>(k)]);
    bytes_.remove_prefix(4);
    return word;
  }

  std::string_view bytes_;
  bool failed_ = false;
};

void readBinaryVertex(Words& words, const Variant& variant, ImportedMesh& mesh) {
  const auto readThree = [&] {
    glm::vec3 three(0.0F);
    for (int k = 0; k < 3; ++k)
      three[k] = words.nextFloat();
    return three;
  };
  glm::dvec3 position(readThree());
  if (variant.homogeneous) position /= static_cast<double>(words.nextFloat());
  mesh.positions.push_back(position);
  if (variant.normals) mesh.normals.push_back(readThree());
  if (variant.colors) {
    glm::vec3 color = readThree();
    for (int k = 0; k < 3; ++k)
      color[k] = linearFromSrgb(static_cast<double>(color[k]));
    mesh.colors.push_back(color);
    (void)words.nextFloat();  // alpha
  }
  if (variant.textureCoordinates) {
    (void)words.nextFloat();
    (void)words.nextFloat();
  }
}

Result<ImportedMesh> readBinary(std::string_view body, const Variant& variant) {
  Words words(body);
  const std::int32_t vertices = words.nextInt();
  const std::int32_t faces = words.nextInt();
  (void)words.nextInt();  // edges
  if (words.failed()) return cut();
  const int vertexWords = (variant.homogeneous ? 4 : 3) + (variant.normals ? 3 : 0) +
                          (variant.colors ? 4 : 0) + (variant.textureCoordinates ? 2 : 0);
  if (auto sane = checkCounts(vertices, faces, vertexWords, 2.0, words.remaining()); !sane) {
    return tl::unexpected(sane.error());
  }
  ImportedMesh mesh;
  mesh.format = "off";
  mesh.positions.reserve(static_cast<std::size_t>(vertices));
  for (std::int32_t v = 0; v < vertices; ++v)
    readBinaryVertex(words, variant, mesh);
  for (std::int32_t f = 0; f < faces; ++f) {
    const std::int32_t count = words.nextInt();
    if (count < 0 || static_cast<std::size_t>(count) > words.remaining()) return cut();
    for (std::int32_t k = 0; k < count; ++k)
      mesh.corners.push_back(vertexIndex(words.nextInt()));
    endPolygon(mesh);
    const std::int32_t colorWords = words.nextInt();
    if (colorWords < 0 || static_cast<std::size_t>(colorWords) > words.remaining()) return cut();
    for (std::int32_t k = 0; k < colorWords; ++k)
      (void)words.nextFloat();
  }
  if (words.failed()) return cut();
  return mesh;
}

}  // namespace

Result<ImportedMesh> readOff(std::string_view bytes) {
  TextScanner scanner(bytes, {.hashComments = true, .backslashContinuation = false});
  std::string_view word = scanner.token();
  Variant variant;
  if (const auto parsed = parseKeyword(word)) {
    variant = *parsed;
    if (variant.anyDimension) {
      return fail(
          ErrorCode::kUnsupported,
          "an nOFF file has points of any dimension: export it with three coordinates (OFF)");
    }
    word = scanner.token();
    if (word == "BINARY") {
      const std::size_t newline = bytes.find('\n', scanner.position());
      if (newline == bytes.npos) return cut();
      return readBinary(bytes.substr(newline + 1), variant);
    }
  }
  return TextReader(scanner, variant).read(word);
}

}  // namespace limn::import
