// SPDX-License-Identifier: Apache-2.0
#include "server/apps/prepare_process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

extern char** environ;

namespace limn {
namespace {

constexpr std::size_t kMaxOutputBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxLineBytes = 1000;
constexpr int kNiceness = 10;  // streaming goes first

/// Appends what can be read now. False at the end of the pipe.
template <class Sink>
bool drainPipe(int fd, Sink sink) {
  std::array<char, 4096> buffer{};
  while (true) {
    const ssize_t count = ::read(fd, buffer.data(), buffer.size());
    if (count > 0) {
      sink(std::string_view(buffer.data(), static_cast<std::size_t>(count)));
    } else if (count == 0) {
      return false;
    } else if (errno != EINTR) {
      return true;
    }
  }
}

void closeFd(int& fd) {
  if (fd >= 0) ::close(fd);
  fd = -1;
}

void limit(pid_t pid, __rlimit_resource what, std::uint64_t most) {
  if (most == 0) return;
  const rlimit value{most, most};
  static_cast<void>(::prlimit(pid, what, &value, nullptr));
}

/// The number before the last '%' of a line, as 0 to 1.
std::optional<double> percentOf(std::string_view line) {
  const std::size_t sign = line.rfind('%');
  if (sign == std::string_view::npos || sign + 1 != line.size()) return std::nullopt;
  std::size_t begin = sign;
  while (begin > 0 && line[begin - 1] >= '0' && line[begin - 1] <= '9')
    --begin;
  int percent = 0;
  const auto [end, error] = std::from_chars(line.data() + begin, line.data() + sign, percent);
  if (error != std::errc() || begin == sign) return std::nullopt;
  return std::clamp(percent / 100.0, 0.0, 1.0);
}

}  // namespace

Result<PrepareProcess> PrepareProcess::start(
    const std::vector<std::string>& arguments,
    const PrepareLimits& limits) {
  PrepareProcess process;
  int out[2] = {-1, -1};
  int err[2] = {-1, -1};
  if (::pipe2(out, O_CLOEXEC) != 0 || ::pipe2(err, O_CLOEXEC) != 0) {
    closeFd(out[0]);
    closeFd(out[1]);
    return fail(ErrorCode::kIo, std::string("cannot make a pipe: ") + std::strerror(errno));
  }
  process.out_ = out[0];
  process.err_ = err[0];
  static_cast<void>(::fcntl(out[0], F_SETFL, O_NONBLOCK));
  static_cast<void>(::fcntl(err[0], F_SETFL, O_NONBLOCK));

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err[1], STDERR_FILENO);
  // Signals that the server handles or blocks go back to normal.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigset_t defaults;
  sigemptyset(&none);
  sigemptyset(&defaults);
  for (const int signal : {SIGTERM, SIGINT, SIGPIPE})
    sigaddset(&defaults, signal);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);

  std::vector<char*> argv;
  for (const std::string& argument : arguments)
    argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t pid = -1;
  const int error =
      ::posix_spawn(&pid, arguments.front().c_str(), &actions, &attributes, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  closeFd(out[1]);
  closeFd(err[1]);
  if (error != 0) {
    return fail(ErrorCode::kIo, "cannot start " + arguments.front() + ": " + std::strerror(error));
  }
  process.pid_ = pid;
  // posix_spawn() cannot; they hold for what it asks for from now on.
  limit(pid, RLIMIT_AS, limits.memoryBytes);
  limit(pid, RLIMIT_CPU, limits.cpuSeconds);
  static_cast<void>(::setpriority(PRIO_PROCESS, static_cast<id_t>(pid), kNiceness));
  return process;
}

PrepareProcess::PrepareProcess(PrepareProcess&& other) noexcept {
  *this = std::move(other);
}

PrepareProcess& PrepareProcess::operator=(PrepareProcess&& other) noexcept {
  std::swap(pid_, other.pid_);
  std::swap(out_, other.out_);
  std::swap(err_, other.err_);
  std::swap(output_, other.output_);
  std::swap(line_, other.line_);
  std::swap(lastLine_, other.lastLine_);
  std::swap(progress_, other.progress_);
  return *this;
}

PrepareProcess::~PrepareProcess() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    static_cast<void>(::waitpid(pid_, nullptr, 0));
  }
  closeFd(out_);
  closeFd(err_);
}

void PrepareProcess::stop() {
  if (pid_ > 0) ::kill(pid_, SIGTERM);
}

void PrepareProcess::readErrors() {
  const bool open = drainPipe(err_, [this](std::string_view text) {
    for (const char c : text) {
      if (c == '\n' || c == '\r') {
        if (const auto percent = percentOf(line_)) {
          progress_ = *percent;
        } else if (!line_.empty()) {
          lastLine_ = line_;
        }
        line_.clear();
      } else if (line_.size() < kMaxLineBytes) {
        line_ += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
      }
    }
  });
  if (!open) closeFd(err_);
}

std::optional<PrepareProcess::Outcome> PrepareProcess::poll() {
  const auto readAll = [this] {
    if (out_ >= 0) {
      const bool open = drainPipe(out_, [this](std::string_view text) {
        output_ += text.substr(0, kMaxOutputBytes - std::min(kMaxOutputBytes, output_.size()));
      });
      if (!open) closeFd(out_);
    }
    if (err_ >= 0) readErrors();
  };
  readAll();
  int status = 0;
  if (::waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
  pid_ = -1;
  readAll();
  if (!line_.empty()) lastLine_ = line_;
  Outcome outcome;
  outcome.succeeded = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  outcome.report = std::move(output_);
  if (!outcome.succeeded) {
    outcome.reason = lastLine_;
    constexpr std::string_view kPrefix = "limn-prepare: ";
    if (outcome.reason.starts_with(kPrefix)) outcome.reason.erase(0, kPrefix.size());
    if (WIFSIGNALED(status)) {
      outcome.reason = std::string("limn-prepare was ended by signal ") +
                       std::to_string(WTERMSIG(status)) +
                       (WTERMSIG(status) == SIGKILL   ? " (out of memory or time?)"
                        : WTERMSIG(status) == SIGXCPU ? " (it took too long)"
                                                      : "");
    } else if (outcome.reason.empty()) {
      outcome.reason = "limn-prepare failed without saying why";
    }
  }
  return outcome;
}

}  // namespace limn
