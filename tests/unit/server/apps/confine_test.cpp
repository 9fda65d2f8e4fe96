// SPDX-License-Identifier: Apache-2.0
#include "server/apps/confine.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <thread>

namespace limn {
namespace {

// In a process of its own: there is no way back.
TEST(ConfineProcessDeathTest, LeavesFilesAndThreadsButNoSocketsOrPrograms) {
  EXPECT_EXIT(
      {
        if (!confineProcess()) std::_Exit(1);
        if (::socket(AF_INET, SOCK_STREAM, 0) != -1 || errno != EPERM) std::_Exit(2);
        int pair[2];
        if (::socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != -1) std::_Exit(3);
        char* const arguments[] = {nullptr};
        if (::execve("/bin/true", arguments, arguments) != -1 || errno != EPERM) std::_Exit(4);
        int answer = 0;
        std::thread([&] { answer = 42; }).join();
        std::FILE* file = std::tmpfile();
        if (answer != 42 || file == nullptr) std::_Exit(5);
        std::_Exit(0);
      },
      testing::ExitedWithCode(0),
      "");
}

}  // namespace
}  // namespace limn
