// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace limn::import {

/// A number as a file has it. "nan" and "inf" in their usual spellings are kOk and non-finite;
/// what underflows a double is 0; what overflows one is kTooLarge.
struct Number {
  enum class Status { kOk, kMalformed, kTooLarge };
  double value = 0.0;
  Status status = Status::kMalformed;
};

/// The whole of `token` as a decimal number, whatever the locale.
[[nodiscard]] Number parseNumber(std::string_view token);

[[nodiscard]] bool equalsIgnoringCase(std::string_view a, std::string_view b);

/// Splits text into blank-separated tokens and counts lines. Lines end in LF, CRLF or CR. Views the
/// text, which must outlive it; never allocates.
class TextScanner {
 public:
  struct Syntax {
    bool hashComments = false;           // '#' starts a comment that ends with the line
    bool backslashContinuation = false;  // a backslash at the end of a line joins the next one
  };

  explicit TextScanner(std::string_view text) : TextScanner(text, Syntax{}) {}

  TextScanner(std::string_view text, Syntax syntax) : text_(text), syntax_(syntax) {}

  /// The next token on this line; empty at its end.
  [[nodiscard]] std::string_view tokenOnLine();
  /// The next token on this line or a later one; empty at the end of the text.
  [[nodiscard]] std::string_view token();
  /// Skips the rest of the line. False at the end of the text.
  bool nextLine();

  [[nodiscard]] bool atEnd() const { return position_ >= text_.size(); }

  /// Counted from 1.
  [[nodiscard]] std::size_t line() const { return line_; }

  [[nodiscard]] std::size_t position() const { return position_; }

  [[nodiscard]] std::size_t remaining() const { return text_.size() - position_; }

 private:
  void skipBlanks();
  void skipNewline();

  std::string_view text_;
  Syntax syntax_;
  std::size_t position_ = 0;
  std::size_t line_ = 1;
};

}  // namespace limn::import
