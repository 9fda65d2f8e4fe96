// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/import/text_scanner.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>

namespace limn::import {

namespace {

bool isNewline(char c) {
  return c == '\n' || c == '\r';
}

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

}  // namespace

bool equalsIgnoringCase(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) ==
           std::tolower(static_cast<unsigned char>(y));
  });
}

Number parseNumber(std::string_view token) {
  using enum Number::Status;
  if (!token.empty() && token.front() == '+') token.remove_prefix(1);
  Number number;
  const char* const end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, number.value);
  if (error == std::errc::result_out_of_range) {
    // Past 300 characters nobody means the number, and the exponent no longer tells which way it is
    // out.
    if (stop != end || token.size() > 300) return {0.0, kMalformed};
    const bool underflow = token.find("e-") != token.npos || token.find("E-") != token.npos;
    return underflow ? Number{0.0, kOk} : Number{0.0, kTooLarge};
  }
  if (error == std::errc{} && stop == end) {
    number.status = kOk;
    return number;
  }
  // What old Windows run-time libraries print: 1.#QNAN, 1.#INF, -1.#IND.
  if (error == std::errc{} && stop + 1 < end && stop[0] == '#') {
    return {std::numeric_limits<double>::quiet_NaN(), kOk};
  }
  return {0.0, kMalformed};
}

void TextScanner::skipNewline() {
  if (atEnd()) return;
  const char first = text_[position_++];
  if (first == '\r' && !atEnd() && text_[position_] == '\n') ++position_;
  ++line_;
}

void TextScanner::skipBlanks() {
  while (!atEnd()) {
    const char c = text_[position_];
    if (isBlank(c)) {
      ++position_;
    } else if (syntax_.backslashContinuation && c == '\\') {
      std::size_t ahead = position_ + 1;
      while (ahead < text_.size() && isBlank(text_[ahead]))
        ++ahead;
      if (ahead < text_.size() && !isNewline(text_[ahead])) return;
      position_ = ahead;
      skipNewline();
    } else if (syntax_.hashComments && c == '#') {
      while (!atEnd() && !isNewline(text_[position_]))
        ++position_;
    } else {
      return;
    }
  }
}

std::string_view TextScanner::tokenOnLine() {
  skipBlanks();
  const std::size_t begin = position_;
  while (!atEnd()) {
    const char c = text_[position_];
    if (isBlank(c) || isNewline(c) || (syntax_.hashComments && c == '#')) break;
    if (syntax_.backslashContinuation && c == '\\' && position_ > begin) {
      const std::size_t ahead = position_ + 1;
      if (ahead >= text_.size() || isNewline(text_[ahead])) break;
    }
    ++position_;
  }
  return text_.substr(begin, position_ - begin);
}

std::string_view TextScanner::token() {
  for (;;) {
    const std::string_view found = tokenOnLine();
    if (!found.empty() || atEnd()) return found;
    skipNewline();
  }
}

bool TextScanner::nextLine() {
  while (!atEnd()) {
    skipBlanks();
    if (atEnd()) break;
    if (isNewline(text_[position_])) {
      skipNewline();
      break;
    }
    ++position_;
  }
  return !atEnd();
}

}  // namespace limn::import
