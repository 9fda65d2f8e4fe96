// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What a PLY file says of itself before its body. Internal to server/preprocess/import.
namespace limn::import::ply {

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

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

struct Property {
  Type type = Type::kFloat;
  std::optional<Type> countType;  // set for a list
  Role role = Role::kNothing;
};

/// In the order of the header, which is the order of the body.
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
  std::size_t bodyBegin = 0;  // bytes
};

/// Parses the header of a whole file. Total over any bytes. Errors: kCorrupt, kUnsupported,
/// kLimitExceeded.
[[nodiscard]] Result<Header> parseHeader(std::string_view bytes);

[[nodiscard]] std::size_t sizeOf(Type type);

}  // namespace limn::import::ply
