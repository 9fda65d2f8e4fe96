// SPDX-License-Identifier: Apache-2.0
#include "client/apps/interrupt.h"

#include <csignal>

namespace limn {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;

void note(int signal) {
  // Not yet at the second one: timeout(1) sends its signal both to the program and to its group.
  g_interrupted = g_interrupted + 1;
  if (g_interrupted >= 2) std::signal(signal, SIG_DFL);
}

}  // namespace

void watchForInterrupts() {
  // Without SA_RESTART, so that waiting calls return.
  struct sigaction action {};

  action.sa_handler = note;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
  return g_interrupted != 0;
}

}  // namespace limn
