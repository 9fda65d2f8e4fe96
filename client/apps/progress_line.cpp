// SPDX-License-Identifier: Apache-2.0
#include "client/apps/progress_line.h"

#include <unistd.h>

#include <cstdio>

namespace limn {

ProgressLine::ProgressLine() : terminal_(::isatty(STDERR_FILENO) != 0) {}

void ProgressLine::show(const ClientSession::Progress& progress) {
  if (!progress.notice.empty() && progress.notice != notice_) {
    clear();
    std::fprintf(stderr, "limn-client: %s\n", progress.notice.c_str());
  }
  notice_ = progress.notice;
  if (!terminal_ || progress.splitsTotal == 0) return;
  constexpr int kCells = 30;
  const double share = static_cast<double>(progress.splitsHeld) / progress.splitsTotal;
  std::string bar;
  for (int i = 0; i < kCells; ++i)
    bar += i < share * kCells ? '#' : '.';
  std::fprintf(
      stderr,
      "\r[%s] %u of %u splits, %.1f KB",
      bar.c_str(),
      progress.splitsHeld,
      progress.splitsTotal,
      static_cast<double>(progress.bytes.received) / 1000.0);
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressLine::clear() {
  if (!drawn_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace limn
