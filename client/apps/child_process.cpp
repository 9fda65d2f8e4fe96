// SPDX-License-Identifier: Apache-2.0
#include "client/apps/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>
#include <system_error>

extern char** environ;

namespace limn {
namespace {

constexpr std::size_t kMaxOutputBytes = 16 * 1024 * 1024;
constexpr int kPollMs = 100;

/// A file descriptor that closes itself.
class Descriptor {
 public:
  Descriptor() = default;
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  ~Descriptor() { reset(); }

  void reset(int fd = -1) {
    if (fd_ >= 0) ::close(fd_);
    fd_ = fd;
  }

  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_ = -1;
};

struct Pipe {
  Descriptor read;
  Descriptor write;

  [[nodiscard]] bool open() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) return false;
    read.reset(ends[0]);
    write.reset(ends[1]);
    return true;
  }
};

/// Takes what the pipe has; closes it at its end.
void drain(Descriptor& from, std::string& into) {
  std::array<char, 16384> buffer{};
  const ssize_t count = ::read(from.get(), buffer.data(), buffer.size());
  if (count > 0) {
    const auto room = kMaxOutputBytes - std::min(kMaxOutputBytes, into.size());
    into.append(buffer.data(), std::min(static_cast<std::size_t>(count), room));
  } else if (count == 0 || (errno != EINTR && errno != EAGAIN)) {
    from.reset();
  }
}

}  // namespace

Result<ChildResult> runChild(
    const std::vector<std::string>& arguments,
    const std::function<bool()>& shouldStop) {
  Pipe out;
  Pipe err;
  if (!out.open() || !err.open()) {
    return fail(ErrorCode::kIo, std::string("cannot make a pipe: ") + std::strerror(errno));
  }
  std::vector<char*> argv;
  std::vector<std::string> copies = arguments;
  argv.reserve(copies.size() + 1);
  for (std::string& argument : copies)
    argv.push_back(argument.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out.write.get(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.write.get(), STDERR_FILENO);
  pid_t child = -1;
  const int started = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (started != 0) {
    return fail(ErrorCode::kIo, "cannot run " + arguments[0] + ": " + std::strerror(started));
  }
  out.write.reset();
  err.write.reset();

  ChildResult result;
  bool stopped = false;
  while (out.read.get() >= 0 || err.read.get() >= 0) {
    std::array<pollfd, 2> waits{{{out.read.get(), POLLIN, 0}, {err.read.get(), POLLIN, 0}}};
    ::poll(waits.data(), waits.size(), kPollMs);
    if (!stopped && shouldStop()) {
      stopped = true;
      ::kill(child, SIGKILL);
    }
    if (waits[0].revents != 0) drain(out.read, result.output);
    if (waits[1].revents != 0) drain(err.read, result.complaint);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    if (!stopped && shouldStop()) {
      stopped = true;
      ::kill(child, SIGKILL);
    }
  }
  if (stopped) return fail(ErrorCode::kCancelled, "stopped on request");
  result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

std::string siblingProgram(const std::string& name) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) {
    const auto sibling = self.parent_path() / name;
    if (std::filesystem::exists(sibling, error)) return sibling.string();
  }
  return name;
}

}  // namespace limn
