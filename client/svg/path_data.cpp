// SPDX-License-Identifier: Apache-2.0
#include "client/svg/path_data.h"

#include <cmath>

namespace limn {
namespace {

using Hundredths = glm::i64vec2;

Hundredths rounded(const glm::dvec2& p) {
  return {std::llround(100.0 * p.x), std::llround(100.0 * p.y)};
}

class Writer {
 public:
  void command(char letter) {
    // Coordinates after a moveto or a command of the same letter need no letter again.
    if (letter != last_) text_ += letter;
    hasNumber_ = hasNumber_ && letter == last_;
    last_ = letter;
  }

  void point(const Hundredths& p) {
    number(p.x);
    number(p.y);
  }

  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  void number(std::int64_t hundredths) {
    const std::int64_t size = std::abs(hundredths);
    std::string digits;
    if (size >= 100 || size == 0) digits = std::to_string(size / 100);
    if (size % 100 != 0) {
      digits += '.';
      digits += static_cast<char>('0' + size % 100 / 10);
      if (size % 10 != 0) digits += static_cast<char>('0' + size % 10);
    }
    // A sign, or a second point, ends the number before it.
    const bool isApart = hundredths < 0 || (digits.front() == '.' && hasPoint_);
    if (hasNumber_ && !isApart) text_ += ' ';
    if (hundredths < 0) text_ += '-';
    text_ += digits;
    hasNumber_ = true;
    hasPoint_ = digits.find('.') != std::string::npos;
  }

  std::string text_;
  char last_ = 0;
  bool hasNumber_ = false;
  bool hasPoint_ = false;
};

}  // namespace

std::string pathData(const FittedPath& path, PathEnds ends) {
  Writer writer;
  Hundredths at = rounded(path.start);
  writer.command('M');
  writer.point(at);
  for (std::size_t i = 0; i < path.steps.size(); ++i) {
    const PathStep& step = path.steps[i];
    const Hundredths to = rounded(step.to);
    // `z` draws the last line of a loop.
    const bool isClosing = ends == PathEnds::kClosed && i + 1 == path.steps.size();
    if (step.isCurve) {
      writer.command('c');
      writer.point(rounded(step.control1) - at);
      writer.point(rounded(step.control2) - at);
      writer.point(to - at);
    } else if (!isClosing) {
      writer.command('l');
      writer.point(to - at);
    }
    at = to;
  }
  if (ends == PathEnds::kClosed) writer.command('z');
  return writer.take();
}

}  // namespace limn
