// SPDX-License-Identifier: Apache-2.0
// Based on: Greg Turk, "The PLY Polygon File Format", 1994, and what writers made of it since:
// sized type names (int32, float64), vertex_index for vertex_indices, CRLF and CR headers, triangle
// strips (Cyberware), any element or list before, between and after those that we need.
#include "server/preprocess/import/import_readers.h"
#include "server/preprocess/import/text_scanner.h"

#include "shared/core/ids.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <vector>

namespace limn::import {

namespace {

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

std::size_t sizeOf(Type type) {
  static constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

std::optional<Type> typeNamed(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, Type>, 16> kNames{{
      {"char", Type::kInt8},
      {"int8", Type::kInt8},
      {"uchar", Type::kUint8},
      {"uint8", Type::kUint8},
      {"short", Type::kInt16},
      {"int16", Type::kInt16},
      {"ushort", Type::kUint16},
      {"uint16", Type::kUint16},
      {"int", Type::kInt32},
      {"int32", Type::kInt32},
      {"uint", Type::kUint32},
      {"uint32", Type::kUint32},
      {"float", Type::kFloat},
      {"float32", Type::kFloat},
      {"double", Type::kDouble},
      {"float64", Type::kDouble},
  }};
  for (const auto& [candidate, type] : kNames) {
    if (candidate == name) return type;
  }
  return std::nullopt;
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

/// What a property means to us.
enum class Role {
  kNothing,
  kX,
  kY,
  kZ,
  kRed,
  kGreen,
  kBlue,
  kNormalX,
  kNormalY,
  kNormalZ,
  kIndices
};

Role roleOf(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, Role>, 14> kRoles{{
      {"x", Role::kX},
      {"y", Role::kY},
      {"z", Role::kZ},
      {"red", Role::kRed},
      {"green", Role::kGreen},
      {"blue", Role::kBlue},
      {"diffuse_red", Role::kRed},
      {"diffuse_green", Role::kGreen},
      {"diffuse_blue", Role::kBlue},
      {"nx", Role::kNormalX},
      {"ny", Role::kNormalY},
      {"nz", Role::kNormalZ},
      {"vertex_indices", Role::kIndices},
      {"vertex_index", Role::kIndices},
  }};
  for (const auto& [candidate, role] : kRoles) {
    if (candidate == name) return role;
  }
  return Role::kNothing;
}

struct Property {
  Type type = Type::kFloat;
  std::optional<Type> countType;  // set for a list
  Role role = Role::kNothing;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  [[nodiscard]] bool has(Role role) const {
    return std::any_of(properties.begin(), properties.end(), [&](const Property& p) {
      return p.role == role;
    });
  }
};

enum class Encoding { kText, kLittleEndian, kBigEndian };

struct Header {
  Encoding encoding = Encoding::kText;
  std::vector<Element> elements;
  std::size_t bodyBegin = 0;
};

tl::unexpected<Error> corrupt(std::string message) {
  return fail(ErrorCode::kCorrupt, std::move(message));
}

/// Splits the header into lines. The first line's ending is every line's: in a binary file the byte
/// after "end_header" and its ending is data, whatever it looks like.
class HeaderLines {
 public:
  explicit HeaderLines(std::string_view bytes) : bytes_(bytes) {
    const std::size_t end = bytes.find_first_of("\r\n");
    if (end == bytes.npos) return;
    ending_ = bytes.substr(end, bytes.substr(end, 2) == "\r\n" ? 2 : 1);
  }

  /// The next line without its ending, or nothing where the file ends first.
  std::optional<std::string_view> next() {
    if (ending_.empty()) return std::nullopt;
    const std::size_t end = bytes_.find(ending_, position_);
    if (end == bytes_.npos) return std::nullopt;
    const std::string_view line = bytes_.substr(position_, end - position_);
    position_ = end + ending_.size();
    return line;
  }

  [[nodiscard]] std::size_t position() const { return position_; }

 private:
  std::string_view bytes_;
  std::string_view ending_;
  std::size_t position_ = 0;
};

Result<Property> parseProperty(TextScanner& words) {
  Property property;
  std::string_view type = words.tokenOnLine();
  if (type == "list") {
    const std::string_view countType = words.tokenOnLine();
    property.countType = typeNamed(countType);
    if (!property.countType || *property.countType == Type::kFloat ||
        *property.countType == Type::kDouble) {
      return fail(
          ErrorCode::kUnsupported,
          "a list's length has the type \"" + std::string(countType) +
              "\"; PLY has char … uint: export it again");
    }
    type = words.tokenOnLine();
  }
  const auto named = typeNamed(type);
  if (!named) {
    return fail(
        ErrorCode::kUnsupported,
        "a property has the type \"" + std::string(type.substr(0, 32)) +
            "\", which PLY does not have: the file is damaged, or export it with float and int");
  }
  property.type = *named;
  const std::string_view name = words.tokenOnLine();
  if (name.empty())
    return corrupt("a property without a name in the PLY header: the file is damaged");
  property.role = roleOf(name);
  if (property.countType.has_value() != (property.role == Role::kIndices))
    property.role = Role::kNothing;
  return property;
}

Result<Encoding> parseEncoding(std::string_view name) {
  if (name == "ascii") return Encoding::kText;
  if (name == "binary_little_endian") return Encoding::kLittleEndian;
  if (name == "binary_big_endian") return Encoding::kBigEndian;
  return fail(
      ErrorCode::kUnsupported,
      "unknown PLY format \"" + std::string(name.substr(0, 32)) +
          "\": export as ascii, binary_little_endian or binary_big_endian");
}

Result<Element> parseElement(TextScanner& words) {
  Element element;
  element.name = words.tokenOnLine();
  const std::string_view count = words.tokenOnLine();
  const auto [stop, error] =
      std::from_chars(count.data(), count.data() + count.size(), element.count);
  if (error == std::errc{} && stop == count.data() + count.size()) return element;
  return corrupt(
      "the PLY header promises \"" + std::string(count.substr(0, 32)) + "\" of element \"" +
      element.name.substr(0, 32) + "\", which is no count: the file is damaged; export it again");
}

Result<Header> parseHeader(std::string_view bytes) {
  constexpr std::size_t kMaxElements = 256;
  constexpr std::size_t kMaxProperties = 4096;
  Header header;
  HeaderLines lines(bytes);
  bool formatKnown = false;
  std::size_t properties = 0;
  (void)lines.next();  // "ply"
  for (;;) {
    const auto line = lines.next();
    if (!line)
      return corrupt(
          "the PLY header has no \"end_header\": the file was cut or is damaged; get a whole copy");
    TextScanner words(*line);
    const std::string_view keyword = words.tokenOnLine();
    if (keyword == "end_header") break;
    if (keyword.empty() || keyword == "comment" || keyword == "obj_info") continue;
    if (keyword == "format") {
      const auto encoding = parseEncoding(words.tokenOnLine());
      if (!encoding) return tl::unexpected(encoding.error());
      header.encoding = *encoding;
      formatKnown = true;
    } else if (keyword == "element") {
      auto element = parseElement(words);
      if (!element) return tl::unexpected(element.error());
      if (header.elements.size() == kMaxElements) {
        return fail(
            ErrorCode::kLimitExceeded,
            "the PLY header has more than 256 elements: the file is damaged");
      }
      header.elements.push_back(std::move(*element));
    } else if (keyword == "property") {
      if (header.elements.empty())
        return corrupt("a property before any element in the PLY header: the file is damaged");
      if (++properties > kMaxProperties) {
        return fail(
            ErrorCode::kLimitExceeded,
            "the PLY header has more than 4096 properties: the file is damaged");
      }
      auto property = parseProperty(words);
      if (!property) return tl::unexpected(property.error());
      header.elements.back().properties.push_back(*property);
    } else {
      return corrupt(
          "the PLY header has a line that PLY does not know (\"" +
          std::string(keyword.substr(0, 32)) + "\"): the file is damaged; export it again");
    }
  }
  if (!formatKnown)
    return corrupt("the PLY header has no \"format\" line: the file is damaged; export it again");
  header.bodyBegin = lines.position();
  return header;
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
  const auto header = parseHeader(bytes);
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
