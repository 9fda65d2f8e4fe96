// SPDX-License-Identifier: Apache-2.0
#include "client/apps/token.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

namespace limn {
namespace {

constexpr std::size_t kMaxTokenBytes = 3072;  // as servers take them
constexpr char kVariable[] = "LIMN_TOKEN";

}  // namespace

Result<std::string> readToken(const std::filesystem::path& file) {
  std::string token;
  std::string where = std::string("the environment variable ") + kVariable;
  if (!file.empty()) {
    where = "token file " + file.string();
    std::ifstream in(file, std::ios::binary);
    if (!in) return fail(ErrorCode::kNotFound, "cannot open " + where);
    token.resize(kMaxTokenBytes + 1);
    in.read(token.data(), static_cast<std::streamsize>(token.size()));
    token.resize(static_cast<std::size_t>(in.gcount()));
  } else if (const char* value = std::getenv(kVariable); value != nullptr && *value != '\0') {
    token = value;
  } else {
    return token;
  }
  while (!token.empty() && (token.back() == '\n' || token.back() == '\r' || token.back() == ' '))
    token.pop_back();
  const bool odd = std::ranges::any_of(token, [](char c) {
    return static_cast<unsigned char>(c) <= ' ' || static_cast<unsigned char>(c) >= 0x7F;
  });
  if (token.empty() || token.size() > kMaxTokenBytes || odd) {
    return fail(
        ErrorCode::kInvalidArgument,
        where + " does not hold one token of printable characters");
  }
  return token;
}

}  // namespace limn
