// SPDX-License-Identifier: Apache-2.0
// Based on: Greg Turk, "The PLY Polygon File Format", 1994, and what writers made of it since:
// sized type names (int32, float64), vertex_index for vertex_indices, CRLF and CR headers, triangle
// strips (Cyberware), any element or list before, between and after those that we need.
#include "server/preprocess/import/ply_header.h"

#include "server/preprocess/import/text_scanner.h"

#include <array>
#include <charconv>
#include <system_error>
#include <utility>

namespace limn::import::ply {
namespace {

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

}  // namespace

std::size_t sizeOf(Type type) {
  static constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
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

}  // namespace limn::import::ply
