// SPDX-License-Identifier: Apache-2.0
#include "server/transport/tokens.h"

#include "shared/core/hmac.h"

#include <nlohmann/json.hpp>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace limn {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxModels = 1000;
constexpr std::size_t kMaxIdBytes = 64;
constexpr std::size_t kLeastSecretBytes = 32;
constexpr std::size_t kMostSecretBytes = 512;
constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

/// base64url without padding [RFC 4648, 5].
std::string encodeBase64(std::string_view bytes) {
  std::string text;
  unsigned bits = 0;
  unsigned buffer = 0;
  for (const char c : bytes) {
    buffer = (buffer << 8 | static_cast<unsigned char>(c)) & 0xFFFF;
    for (bits += 8; bits >= 6; bits -= 6)
      text += kDigits[buffer >> (bits - 6) & 63];
  }
  if (bits > 0) text += kDigits[buffer << (6 - bits) & 63];
  return text;
}

/// Only what encodeBase64() makes: one text for each value.
std::optional<std::string> decodeBase64(std::string_view text) {
  if (text.size() % 4 == 1) return std::nullopt;
  std::string bytes;
  unsigned bits = 0;
  unsigned buffer = 0;
  for (const char c : text) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) return std::nullopt;
    buffer = (buffer << 6 | static_cast<unsigned>(digit)) & 0xFFFF;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes += static_cast<char>(buffer >> bits & 0xFF);
    }
  }
  if ((buffer & ((1U << bits) - 1)) != 0) return std::nullopt;
  return bytes;
}

std::string_view textOf(const Sha256Digest& digest) {
  return {reinterpret_cast<const char*>(digest.data()), digest.size()};
}

std::optional<json> decodeObject(std::string_view part) {
  const auto text = decodeBase64(part);
  if (!text) return std::nullopt;
  json object = json::parse(*text, nullptr, false);
  if (!object.is_object()) return std::nullopt;
  return object;
}

/// A claim that must be a text, if it is there.
std::optional<std::string> textClaim(const json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end()) return std::string();
  if (!found->is_string()) return std::nullopt;
  return found->get<std::string>();
}

std::optional<std::int64_t> timeClaim(const json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  if (!(value >= 0.0 && value < 1e15)) return std::nullopt;
  return static_cast<std::int64_t>(value);
}

tl::unexpected<Error> malformed(const char* what) {
  return fail(ErrorCode::kInvalidArgument, std::string("the token is malformed: ") + what);
}

bool isVisible(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return c > ' ' && c < 0x7F; });
}

Result<Grant> readClaims(const json& claims, std::int64_t nowS) {
  const auto expires = timeClaim(claims, "exp");
  if (!expires) return malformed("it has no exp, the second at which it expires");
  if (nowS >= *expires) return fail(ErrorCode::kProtocol, "the token has expired; ask for another");
  if (claims.contains("nbf")) {
    const auto from = timeClaim(claims, "nbf");
    if (!from) return malformed("nbf is no time");
    if (nowS < *from) return fail(ErrorCode::kProtocol, "the token is not valid yet");
  }
  const auto models = claims.find("models");
  if (models == claims.end() || !models->is_array() || models->size() > kMaxModels) {
    return malformed("models is no list of names");
  }
  Grant grant;
  for (const json& name : *models) {
    if (!name.is_string()) return malformed("models is no list of names");
    grant.models.push_back(name.get<std::string>());
  }
  auto subject = textClaim(claims, "sub");
  if (!subject) return malformed("sub is no text");
  grant.subject = std::move(*subject);
  return grant;
}

}  // namespace

Result<std::vector<TokenKey>> parseTokenKeys(std::string_view text) {
  std::vector<TokenKey> keys;
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view entry = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (entry.ends_with('\r')) entry.remove_suffix(1);
    if (entry.empty() || entry.starts_with('#')) continue;
    const std::size_t blank = std::min(entry.find(' '), entry.size());
    const std::string_view id = entry.substr(0, blank);
    const std::string_view secret = entry.substr(std::min(blank + 1, entry.size()));
    if (id.empty() || id.size() > kMaxIdBytes || !isVisible(id) || !isVisible(secret) ||
        secret.size() < kLeastSecretBytes || secret.size() > kMostSecretBytes) {
      return fail(
          ErrorCode::kInvalidArgument,
          "line " + std::to_string(line) +
              ": write a name, a blank, and a secret of 32 to 512 visible ASCII characters");
    }
    if (std::ranges::any_of(keys, [&](const TokenKey& key) { return key.id == id; })) {
      return fail(
          ErrorCode::kInvalidArgument,
          "line " + std::to_string(line) + ": there is another key of that name");
    }
    keys.push_back({std::string(id), std::string(secret)});
  }
  if (keys.empty()) return fail(ErrorCode::kInvalidArgument, "there is no key in it");
  return keys;
}

Result<std::string> makeTokenKey(std::string_view id) {
  if (id.empty() || id.size() > kMaxIdBytes || !isVisible(id) || id.starts_with('#')) {
    return fail(
        ErrorCode::kInvalidArgument,
        "a key's name has 1 to 64 visible ASCII characters and does not begin with #");
  }
  std::array<char, 32> random{};
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) {
    return fail(ErrorCode::kUnavailable, "the system gives no random numbers");
  }
  return std::string(id) + " " + encodeBase64({random.data(), random.size()});
}

std::string signToken(const TokenClaims& claims, const TokenKey& key) {
  const json header = {{"alg", "HS256"}, {"typ", "JWT"}, {"kid", key.id}};
  json body = {{"exp", claims.expiresS}, {"models", claims.grant.models}};
  if (!claims.grant.subject.empty()) body["sub"] = claims.grant.subject;
  constexpr auto kReplace = json::error_handler_t::replace;
  const std::string text = encodeBase64(header.dump(-1, ' ', false, kReplace)) + "." +
                           encodeBase64(body.dump(-1, ' ', false, kReplace));
  return text + "." + encodeBase64(textOf(hmacSha256(key.secret, text)));
}

Result<Grant>
verifyToken(std::string_view token, const std::vector<TokenKey>& keys, std::int64_t nowS) {
  if (token.size() > kMaxTokenBytes) return malformed("it is too long");
  const std::size_t first = token.find('.');
  const std::size_t last = token.rfind('.');
  if (first == last || token.find('.', first + 1) != last) {
    return malformed("it does not have three parts");
  }
  const auto header = decodeObject(token.substr(0, first));
  const auto signature = decodeBase64(token.substr(last + 1));
  if (!header || !signature || signature->size() != Sha256Digest{}.size()) {
    return malformed("it is not HS256 in base64url");
  }
  // The token does not choose how it is checked.
  if (textClaim(*header, "alg") != "HS256") return malformed("its alg is not HS256");
  if (header->contains("crit")) return malformed("it has extensions");
  const auto id = textClaim(*header, "kid");
  if (!id) return malformed("its kid is no text");
  Sha256Digest given{};
  std::ranges::copy(*signature, reinterpret_cast<char*>(given.data()));
  const bool isSigned = std::ranges::any_of(keys, [&](const TokenKey& key) {
    if (!id->empty() && key.id != *id) return false;
    return sameSecret(given, hmacSha256(key.secret, token.substr(0, last)));
  });
  if (!isSigned) {
    return fail(ErrorCode::kProtocol, "the token is not signed with a key of this server");
  }
  const auto claims = decodeObject(token.substr(first + 1, last - first - 1));
  if (!claims) return malformed("its claims are no JSON object");
  return readClaims(*claims, nowS);
}

}  // namespace limn
