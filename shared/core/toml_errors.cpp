// SPDX-License-Identifier: Apache-2.0
#include "shared/core/toml_errors.h"

namespace limn {
namespace {

std::string shortNumber(double value) {
  std::string digits = std::to_string(value);
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.back() == '.') digits.pop_back();
  return digits;
}

}  // namespace

std::string tomlError(std::size_t line, std::string_view what) {
  return "line " + std::to_string(line) + ": " + std::string(what);
}

std::string wrongTomlValue(std::size_t line, std::string_view key, std::string_view wanted) {
  return tomlError(line, std::string(key) + " must be " + std::string(wanted));
}

std::string
unknownTomlKey(std::size_t line, std::string_view key, std::span<const std::string_view> known) {
  std::string what = "there is no key '" + std::string(key) + "'; write one of";
  for (const std::string_view name : known)
    what += " " + std::string(name);
  return tomlError(line, what);
}

std::string tomlNumberFrom(double low, double high) {
  return "a number from " + shortNumber(low) + " to " + shortNumber(high);
}

}  // namespace limn
