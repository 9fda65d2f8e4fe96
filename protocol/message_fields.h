// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol/messages.h"

#include "shared/core/result.h"
#include "shared/core/sha256.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

/// Single fields of messages, and what is said of wrong ones: for what reads and writes messages,
/// nobody else.
namespace limn::protocol {

inline tl::unexpected<Error> bad(std::string_view what) {
  return fail(ErrorCode::kProtocol, "malformed message: " + std::string(what));
}

/// Over a limit of limits.h.
inline tl::unexpected<Error> tooLarge(std::string_view what) {
  return fail(
      ErrorCode::kLimitExceeded,
      "message over a limit of the protocol: " + std::string(what));
}

/// Of a type that this side does not read: the other side's, or unknown. The verifier lets types
/// pass that it does not know, for newer schemas; this version refuses.
inline tl::unexpected<Error> refuse(wire::Body type) {
  if (type == wire::Body::NONE || type > wire::Body::MAX) return bad("unknown type of message");
  return fail(
      ErrorCode::kProtocol,
      std::string(wire::EnumNameBody(type)) + " came from the wrong side of the connection");
}

// The schema's union numbers types in the order of the variant; typeOf() relies on it.
static_assert(std::variant_size_v<Body> == static_cast<std::size_t>(wire::Body::MAX));

inline wire::Body typeOf(const Body& body) {
  return static_cast<wire::Body>(body.index() + 1);
}

/// Absent: empty.
inline Bytes view(const flatbuffers::Vector<std::uint8_t>* vector) {
  return vector == nullptr ? Bytes{} : Bytes{vector->data(), vector->size()};
}

inline std::string_view view(const flatbuffers::String* text) {
  return text == nullptr ? std::string_view{} : std::string_view{text->c_str(), text->size()};
}

inline glm::dvec3 toGlm(const wire::Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

inline wire::Vec3 fromGlm(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

inline bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// nullopt: not 32 bytes.
inline std::optional<Sha256Digest> digest(Bytes bytes) {
  Sha256Digest result{};
  if (bytes.size() != result.size()) return std::nullopt;
  std::copy(bytes.begin(), bytes.end(), result.begin());
  return result;
}

/// Absent, or whole.
inline bool isHash(Bytes bytes) {
  return bytes.empty() || toSectionHash(bytes).has_value();
}

}  // namespace limn::protocol
