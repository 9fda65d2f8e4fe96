// SPDX-License-Identifier: Apache-2.0
// Based on: Geomview manual, "OFF Files": [ST][C][N][4][n]OFF [BINARY]. The keyword may be missing.
#include "server/preprocess/import_readers.h"
#include "server/preprocess/text_scanner.h"

#include "shared/core/ids.h"

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

Result<ImportedMesh>
readText(TextScanner& scanner, const Variant& variant, std::string_view firstCount) {
  const auto broken = [&](std::string_view what) {
    return fail(
        ErrorCode::kCorrupt,
        atLine(scanner.line(), what) + ": the OFF file is damaged; export it again");
  };
  const Number vertices = parseNumber(firstCount);
  const Number faces = parseNumber(scanner.token());
  if (vertices.status != Number::Status::kOk || faces.status != Number::Status::kOk) {
    return broken("the OFF header needs the numbers of vertices and faces");
  }
  scanner.nextLine();  // number of edges, unused by everybody
  const double coordinates = variant.homogeneous ? 4.0 : 3.0;
  if (auto sane =
          checkCounts(vertices.value, faces.value, 2.0 * coordinates, 2.0, scanner.remaining());
      !sane) {
    return tl::unexpected(sane.error());
  }
  ImportedMesh mesh;
  mesh.format = "off";
  mesh.positions.reserve(static_cast<std::size_t>(vertices.value));
  for (double v = 0; v < vertices.value; ++v) {
    std::array<double, 4> position{0.0, 0.0, 0.0, 1.0};
    for (int k = 0; k < (variant.homogeneous ? 4 : 3); ++k) {
      const std::string_view token = k == 0 ? scanner.token() : scanner.tokenOnLine();
      if (token.empty() && scanner.atEnd()) return cut();
      const Number number = parseNumber(token);
      if (number.status == Number::Status::kTooLarge)
        return broken("a coordinate is beyond the range of a double");
      if (number.status == Number::Status::kMalformed)
        return broken("a vertex needs three numbers");
      position[static_cast<std::size_t>(k)] = number.value;
    }
    mesh.positions.emplace_back(
        position[0] / position[3],
        position[1] / position[3],
        position[2] / position[3]);
    const auto readThree = [&](double scale) {
      glm::vec3 value(0.0F);
      for (int k = 0; k < 3; ++k)
        value[k] = static_cast<float>(parseNumber(scanner.tokenOnLine()).value * scale);
      return value;
    };
    if (variant.normals) mesh.normals.push_back(readThree(1.0));
    if (variant.colors) mesh.colors.push_back(readThree(1.0));
    scanner.nextLine();
  }
  for (double f = 0; f < faces.value; ++f) {
    const std::string_view token = scanner.token();
    if (token.empty()) return cut();
    const Number count = parseNumber(token);
    if (count.status != Number::Status::kOk || !(count.value >= 0.0))
      return broken("a face needs its number of corners");
    if (count.value > static_cast<double>(scanner.remaining())) return cut();
    for (double k = 0; k < count.value; ++k) {
      const std::string_view corner = scanner.token();
      if (corner.empty()) return cut();
      const Number index = parseNumber(corner);
      if (index.status == Number::Status::kMalformed)
        return broken("a face's corner is not a number");
      mesh.corners.push_back(vertexIndex(index.value));
    }
    endPolygon(mesh);
    scanner.nextLine();  // its colour, if any
  }
  // Colours are 0 … 255 or 0 … 1, and only the numbers tell which.
  bool bytes = false;
  for (const glm::vec3& color : mesh.colors)
    bytes = bytes || color.r > 1.0F || color.g > 1.0F || color.b > 1.0F;
  for (glm::vec3& color : mesh.colors) {
    for (int k = 0; k < 3; ++k)
      color[k] = linearFromSrgb(bytes ? color[k] / 255.0 : static_cast<double>(color[k]));
  }
  return mesh;
}

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
  for (std::int32_t v = 0; v < vertices; ++v) {
    glm::dvec3 position;
    for (int k = 0; k < 3; ++k)
      position[k] = static_cast<double>(words.nextFloat());
    if (variant.homogeneous) position /= static_cast<double>(words.nextFloat());
    mesh.positions.push_back(position);
    glm::vec3 three;
    if (variant.normals) {
      for (int k = 0; k < 3; ++k)
        three[k] = words.nextFloat();
      mesh.normals.push_back(three);
    }
    if (variant.colors) {
      for (int k = 0; k < 3; ++k)
        three[k] = linearFromSrgb(static_cast<double>(words.nextFloat()));
      (void)words.nextFloat();
      mesh.colors.push_back(three);
    }
    for (int k = 0; k < (variant.textureCoordinates ? 2 : 0); ++k)
      (void)words.nextFloat();
  }
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
  return readText(scanner, variant, word);
}

}  // namespace limn::import
