// SPDX-License-Identifier: Apache-2.0
#include "client/apps/interrupt.h"

#include <csignal>

namespace limn {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;

void note(int signal) {
  g_interrupted = 1;
  std::signal(signal, SIG_DFL);
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
