// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace limn::load {

/// Latencies in milliseconds. All are kept, so that percentiles are exact: 4 bytes a sample.
class Latencies {
 public:
  void add(double milliseconds) { samples_.push_back(static_cast<float>(milliseconds)); }

  [[nodiscard]] bool empty() const { return samples_.empty(); }

  [[nodiscard]] std::size_t count() const { return samples_.size(); }

  /// Nearest rank, `fraction` in (0, 1]; nullopt without samples. Cost: O(samples).
  [[nodiscard]] std::optional<double> percentile(double fraction) const;

 private:
  std::vector<float> samples_;
};

/// What the clients of a run count, all together. One thread.
struct Counters {
  std::uint64_t asked = 0;       // clients that the script starts
  std::uint64_t connected = 0;   // of those, reached the base mesh
  std::uint64_t failed = 0;      // never did, for whatever reason
  std::uint64_t dropped = 0;     // were thrown out or lost afterwards
  std::uint64_t reconnects = 0;  // clients coming back
  std::uint64_t resumed = 0;     // of those, went on from what they held
  std::uint64_t bytesReceived = 0;
  std::uint64_t messages = 0;
  std::uint64_t posesSent = 0;
  std::uint64_t splitsDecoded = 0;  // by the clients that decode
  std::uint64_t decodeErrors = 0;
  Latencies connect;  // from the planned start to Welcome
  Latencies base;     // from the planned start to the base mesh
  Latencies
      poseToPacket;  // from a pose's planned time to the first Packet or Settled that names it
  /// Payload bytes that came after a pose was sent and before the first answer that names it: what
  /// was on its way, and so how soon a new pose takes effect on a slow link.
  Latencies poseToPacketBytes;
  Latencies settled;  // from a pose's planned time to its Settled
  /// What went wrong and how often. The texts are few: peers' own words are cut and counted.
  std::map<std::string, std::uint64_t> errors;

  void note(const std::string& error);
};

/// The server process, when it runs on this machine.
struct ServerUsage {
  double rssMibBefore = 0.0;
  double rssMibPeak = 0.0;
  double cpuSeconds = 0.0;
};

/// Checks thresholds: one text for each that is missed. A bound on something that was never
/// measured is missed.
[[nodiscard]] std::vector<std::string> missedThresholds(
    const std::map<std::string, double>& thresholds,
    const Counters& counters,
    const std::optional<ServerUsage>& server);

/// What became of a script that was played.
struct Run {
  Counters counters;
  std::optional<ServerUsage> server;
  double seconds = 0.0;
  double ownCpuSeconds = 0.0;  // of this process: near `seconds`, it measures itself
};

/// The report (commands.md, limn-load) as JSON text. `missed` decides "passed".
[[nodiscard]] std::string reportJson(const Run& run, const std::vector<std::string>& missed);

}  // namespace limn::load
