// SPDX-License-Identifier: Apache-2.0
// Based on: Greg Turk, "The PLY Polygon File Format", 1994, and what writers made of it since:
// sized type names (int32, float64), vertex_index for vertex_indices, CRLF and CR headers, triangle
// strips (Cyberware), any element or list before, between and after those that we need.
#include "server/preprocess/import/import_readers.h"
#include "server/preprocess/import/ply_header.h"
#include "server/preprocess/import/text_scanner.h"

#include "shared/core/ids.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <utility>

namespace limn::import {
namespace {

using ply::Element;
using ply::Encoding;
using ply::Header;
using ply::Property;
using ply::Role;
using ply::Type;

tl::unexpected<Error> corrupt(std::string message) {
  return fail(ErrorCode::kCorrupt, std::move(message));
}

/// The value of an integer type that stands for 1 in a colour; 1 for real types.
double fullScale(Type type) {
  switch (type) {
    case Type::kInt8:
    case Type::kUint8:
      return 255.0;
    case Type::kInt16:
    case Type::kUint16:
      return 65535.0;
    case Type::kInt32:
    case Type::kUint32:
      return 4294967295.0;
    default:
      return 1.0;
  }
}

/// Values of a body in either byte order.
template <bool kSwap>
class BinaryValues {
 public:
  explicit BinaryValues(std::string_view bytes)
      : at_(bytes.data()),
        end_(bytes.data() + bytes.size()) {}

  /// The least that an item of this size takes.
  static std::size_t leastBytes(Type type) { return sizeOf(type); }

  [[nodiscard]] std::uint64_t remaining() const { return static_cast<std::uint64_t>(end_ - at_); }

  [[nodiscard]] bool failed() const { return failed_; }

  [[nodiscard]] std::string problem() const {
    return "the PLY file ends before its last element: it was cut or its counts are wrong; get a "
           "whole copy";
  }

  double next(Type type) {
    switch (type) {
      case Type::kInt8:
        return load<std::int8_t, std::uint8_t>();
      case Type::kUint8:
        return load<std::uint8_t, std::uint8_t>();
      case Type::kInt16:
        return load<std::int16_t, std::uint16_t>();
      case Type::kUint16:
        return load<std::uint16_t, std::uint16_t>();
      case Type::kInt32:
        return load<std::int32_t, std::uint32_t>();
      case Type::kUint32:
        return load<std::uint32_t, std::uint32_t>();
      case Type::kFloat:
        return static_cast<double>(load<float, std::uint32_t>());
      case Type::kDouble:
        return load<double, std::uint64_t>();
    }
    return 0.0;
  }

  void skip(Type type, std::uint64_t count) {
    if (count > remaining() / sizeOf(type)) {
      failed_ = true;
    } else {
      at_ += count * sizeOf(type);
    }
  }

 private:
  template <class Value, class Raw>
  Value load() {
    if (remaining() < sizeof(Raw)) {
      failed_ = true;
      return Value{};
    }
    std::array<char, sizeof(Raw)> raw{};
    std::memcpy(raw.data(), at_, sizeof(Raw));
    at_ += sizeof(Raw);
    if constexpr (kSwap) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Value>(raw);
  }

  const char* at_;
  const char* end_;
  bool failed_ = false;
};

class TextValues {
 public:
  explicit TextValues(std::string_view bytes) : scanner_(bytes) {}

  /// A digit and a blank; the file's last blank may be missing, see remaining().
  static std::size_t leastBytes(Type) { return 2; }

  [[nodiscard]] std::uint64_t remaining() const { return scanner_.remaining() + 1; }

  [[nodiscard]] bool failed() const { return !problem_.empty(); }

  [[nodiscard]] std::string problem() const { return problem_; }

  double next(Type) {
    const std::string_view token = scanner_.token();
    if (token.empty()) {
      problem_ =
          "the PLY file ends before its last element: it was cut or its counts are wrong; get a "
          "whole copy";
      return 0.0;
    }
    const Number number = parseNumber(token);
    if (number.status != Number::Status::kOk) {
      const bool tooLarge = number.status == Number::Status::kTooLarge;
      problem_ =
          "body " + atLine(
                        scanner_.line(),
                        tooLarge ? "a number is beyond the range of a double: rescale the model"
                                 : "not a number: the file is damaged; export it again");
    }
    return number.value;
  }

  void skip(Type type, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count && !failed(); ++i)
      (void)next(type);
  }

 private:
  TextScanner scanner_;
  std::string problem_;
};

template <class Values>
class BodyReader {
 public:
  explicit BodyReader(std::string_view body) : values_(body) { mesh_.format = "ply"; }

  Result<ImportedMesh> read(const Header& header) {
    for (const Element& element : header.elements) {
      std::uint64_t least = 0;
      for (const Property& p : element.properties)
        least += Values::leastBytes(p.countType.value_or(p.type));
      if (least == 0) continue;
      const std::uint64_t fits = values_.remaining() / least;
      if (element.count > fits) {
        return corrupt(
            "the PLY header promises " + std::to_string(element.count) + " of element \"" +
            element.name.substr(0, 32) + "\", but the file has room for " + std::to_string(fits) +
            " at most: it was cut or the header is wrong; get a whole copy");
      }
      if (element.name == "vertex" && element.count >= kNone) {
        return fail(ErrorCode::kLimitExceeded, "more than 4294967294 vertices: split the model");
      }
      if (element.name == "vertex") mesh_.positions.reserve(mesh_.positions.size() + element.count);
      if (element.name == "face")
        mesh_.polygonBegin.reserve(mesh_.polygonBegin.size() + element.count);
      for (std::uint64_t i = 0; i < element.count; ++i) {
        if (element.name == "vertex") {
          readVertex(element);
        } else {
          readOther(element);
        }
        if (!listProblem_.empty()) return corrupt(listProblem_);
        if (values_.failed()) return corrupt(values_.problem());
        if (mesh_.corners.size() >= kNone - 3) {
          return fail(
              ErrorCode::kLimitExceeded,
              "more than 4294967291 face corners: split the model");
        }
      }
    }
    return std::move(mesh_);
  }

 private:
  /// The length of a list; past what is left of the file the reader has failed.
  std::uint64_t listLength(const Property& property) {
    const double length = values_.next(*property.countType);
    const std::uint64_t fits = values_.remaining() / Values::leastBytes(property.type) + 1;
    if (length >= 0.0 && length <= static_cast<double>(fits) && length == std::floor(length)) {
      return static_cast<std::uint64_t>(length);
    }
    listProblem_ = "a list in the PLY file claims " +
                   std::to_string(static_cast<std::int64_t>(length)) +
                   " items, more than the file has: it is damaged; export it again";
    return 0;
  }

  void skipProperty(const Property& property) {
    const std::uint64_t count = property.countType ? listLength(property) : 1;
    values_.skip(property.type, count);
  }

  void readVertex(const Element& element) {
    glm::dvec3 position(0.0);
    glm::vec3 color(0.0F);
    glm::vec3 normal(0.0F);
    bool hasColor = false;
    bool hasNormal = false;
    for (const Property& property : element.properties) {
      if (property.countType || property.role == Role::kNothing ||
          property.role == Role::kIndices) {
        skipProperty(property);
        continue;
      }
      const double value = values_.next(property.type);
      const int role = static_cast<int>(property.role);
      if (property.role <= Role::kZ) {
        position[role - static_cast<int>(Role::kX)] = value;
      } else if (property.role <= Role::kBlue) {
        color[role - static_cast<int>(Role::kRed)] = linearColor(property.type, value);
        hasColor = true;
      } else {
        normal[role - static_cast<int>(Role::kNormalX)] = static_cast<float>(value);
        hasNormal = true;
      }
    }
    mesh_.positions.push_back(position);
    if (hasColor) mesh_.colors.push_back(color);
    if (hasNormal) mesh_.normals.push_back(normal);
  }

  void readOther(const Element& element) {
    const bool face = element.name == "face";
    glm::vec3 color(0.0F);
    bool hasColor = false;
    for (const Property& property : element.properties) {
      if (face && !property.countType && property.role >= Role::kRed &&
          property.role <= Role::kBlue) {
        color[static_cast<int>(property.role) - static_cast<int>(Role::kRed)] =
            linearColor(property.type, values_.next(property.type));
        hasColor = true;
        continue;
      }
      if (property.role != Role::kIndices || (!face && element.name != "tristrips")) {
        skipProperty(property);
        continue;
      }
      const std::uint64_t count = listLength(property);
      if (face) {
        for (std::uint64_t k = 0; k < count && !values_.failed(); ++k) {
          mesh_.corners.push_back(vertexIndex(values_.next(property.type)));
        }
        endPolygon(mesh_);
      } else {
        readStrips(property.type, count);
      }
    }
    if (hasColor) endMaterial(mesh_, materialOf(color));
  }

  static float linearColor(Type type, double value) {
    const double scale = fullScale(type);
    return scale == 1.0 ? static_cast<float>(value) : linearFromSrgb(value / scale);
  }

  /// A face colour is a material.
  std::uint32_t materialOf(const glm::vec3& color) {
    const auto next = static_cast<std::uint32_t>(mesh_.materialColors.size());
    const auto [found, isNew] = materials_.try_emplace({color.x, color.y, color.z}, next);
    if (isNew) mesh_.materialColors.push_back(color);
    return found->second;
  }

  /// Triangle strips, -1 between them.
  void readStrips(Type type, std::uint64_t count) {
    std::uint32_t before = kNone;
    std::uint32_t last = kNone;
    std::uint64_t length = 0;
    for (std::uint64_t k = 0; k < count && !values_.failed(); ++k) {
      const double value = values_.next(type);
      if (value == -1.0) {
        length = 0;
        continue;
      }
      const std::uint32_t index = vertexIndex(value);
      if (++length >= 3) {
        const bool odd = length % 2 == 0;
        for (const std::uint32_t corner : {odd ? last : before, odd ? before : last, index}) {
          mesh_.corners.push_back(corner);
        }
        endPolygon(mesh_);
      }
      before = last;
      last = index;
    }
  }

  Values values_;
  ImportedMesh mesh_;
  std::map<std::array<float, 3>, std::uint32_t> materials_;  // by face colour
  std::string listProblem_;
};

}  // namespace

Result<ImportedMesh> readPly(std::string_view bytes) {
  const auto header = ply::parseHeader(bytes);
  if (!header) return tl::unexpected(header.error());
  bool vertices = false;
  bool faces = false;
  for (const Element& element : header->elements) {
    if (element.name == "vertex") {
      if (vertices) return corrupt("two vertex elements in the PLY header: export it again");
      if (!element.has(Role::kX) || !element.has(Role::kY) || !element.has(Role::kZ)) {
        return fail(
            ErrorCode::kUnsupported,
            "the PLY file's vertices have no x, y, z: export positions");
      }
      vertices = element.count > 0;
    } else if (element.name == "face" || element.name == "tristrips") {
      faces = faces || (element.count > 0 && element.has(Role::kIndices));
    }
  }
  if (!vertices)
    return fail(ErrorCode::kUnsupported, "the PLY file has no vertex: export the mesh again");
  if (!faces) {
    return fail(
        ErrorCode::kUnsupported,
        "the PLY file has vertices but no face: export the surface, not a point cloud");
  }
  const std::string_view body = bytes.substr(header->bodyBegin);
  switch (header->encoding) {
    case Encoding::kText:
      return BodyReader<TextValues>(body).read(*header);
    case Encoding::kLittleEndian:
      return BodyReader<BinaryValues<false>>(body).read(*header);
    case Encoding::kBigEndian:
      return BodyReader<BinaryValues<true>>(body).read(*header);
  }
  return corrupt("unknown PLY encoding");
}

}  // namespace limn::import
