// SPDX-License-Identifier: Apache-2.0
#include "client/apps/load_server_usage.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

namespace limn::load {
namespace {

constexpr char kListening[] = "0A";  // state column of /proc/net/tcp

std::set<std::string> listeningSockets(const char* table, int port) {
  std::set<std::string> links;
  std::ifstream stream(table);
  std::string line;
  while (std::getline(stream, line)) {
    // "  sl  local_address rem_address st tx:rx tr:when retrnsmt uid timeout inode"
    std::istringstream fields(line);
    std::string slot, local, remote, state, queues, timer, retransmits, user, timeout, inode;
    fields >> slot >> local >> remote >> state >> queues >> timer >> retransmits >> user >>
        timeout >> inode;
    const auto colon = local.rfind(':');
    if (state != kListening || colon == std::string::npos) continue;
    int found = 0;
    std::from_chars(local.data() + colon + 1, local.data() + local.size(), found, 16);
    if (found == port) links.insert("socket:[" + inode + "]");
  }
  return links;
}

}  // namespace

std::optional<pid_t> findListener(int port) {
  std::set<std::string> links = listeningSockets("/proc/net/tcp", port);
  links.merge(listeningSockets("/proc/net/tcp6", port));
  std::error_code ignored;
  for (const auto& process : std::filesystem::directory_iterator("/proc", ignored)) {
    const std::string name = process.path().filename().string();
    pid_t pid = 0;
    const auto parsed = std::from_chars(name.data(), name.data() + name.size(), pid);
    if (parsed.ec != std::errc() || parsed.ptr != name.data() + name.size()) continue;
    std::error_code denied;
    for (const auto& file : std::filesystem::directory_iterator(process.path() / "fd", denied)) {
      if (links.contains(std::filesystem::read_symlink(file.path(), denied).string())) return pid;
    }
  }
  return std::nullopt;
}

std::optional<double> ServerWatch::rssMib() const {
  std::ifstream stream("/proc/" + std::to_string(pid_) + "/status");
  std::string line;
  while (std::getline(stream, line)) {
    if (line.starts_with("VmRSS:")) {
      std::istringstream fields(line.substr(6));
      double kib = 0.0;
      fields >> kib;
      return kib / 1024.0;
    }
  }
  return std::nullopt;
}

std::optional<double> ServerWatch::cpuSeconds() const {
  std::ifstream stream("/proc/" + std::to_string(pid_) + "/stat");
  std::string text;
  if (!std::getline(stream, text)) return std::nullopt;
  // The program's name is in parentheses and may hold spaces; utime and stime are fields 14 and 15,
  // the 12th and 13th after it.
  const auto parenthesis = text.rfind(')');
  if (parenthesis == std::string::npos) return std::nullopt;
  std::istringstream fields(text.substr(parenthesis + 1));
  std::string skipped;
  for (int i = 0; i < 11; ++i)
    fields >> skipped;
  double userTicks = 0.0;
  double systemTicks = 0.0;
  fields >> userTicks >> systemTicks;
  return (userTicks + systemTicks) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

std::optional<ServerWatch> ServerWatch::start(pid_t pid) {
  ServerWatch watch(pid);
  const auto rss = watch.rssMib();
  const auto cpu = watch.cpuSeconds();
  if (!rss || !cpu) return std::nullopt;
  watch.usage_.rssMibBefore = *rss;
  watch.usage_.rssMibPeak = *rss;
  watch.cpuBefore_ = *cpu;
  return watch;
}

bool ServerWatch::sample() {
  const auto rss = rssMib();
  const auto cpu = cpuSeconds();
  if (!rss || !cpu) return false;
  usage_.rssMibPeak = std::max(usage_.rssMibPeak, *rss);
  usage_.cpuSeconds = *cpu - cpuBefore_;
  return true;
}

}  // namespace limn::load
