// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/pose/recorded_path.h"

#include "shared/core/result.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace limn::load {

/// How a light client behaves. All but kNormal stress the server; of those, kFlood and kMalformed
/// break its rules, so being thrown out does not count against it.
enum class Behaviour : std::uint8_t {
  kNormal,      // poses at rate_hz, every payload acknowledged at once
  kIdle,        // one pose, then silence
  kSlowReader,  // reads at link_kbps (32 unless given), acknowledges what it has read
  kChurn,       // leaves without a word after 1 to 3 s and comes back
  kFlood,       // a thousand messages a second
  kMalformed,   // sends bytes that are no message, comes back after being thrown out
};

/// A group of equal clients. Times in seconds, angles in degrees.
struct Phase {
  std::uint32_t clients = 1;
  double rampSeconds = 0.0;   // the clients start evenly spread over it
  double holdSeconds = 10.0;  // from the end of the ramp
  double delaySeconds = 0.0;  // before the ramp
  std::string model;
  std::vector<std::string> also;  // more models, opened beside it on the same connection
  std::string path = "orbit";     // "orbit", or the file that `recorded` came from
  RecordedPath recorded;          // empty: orbit; otherwise played in a loop
  double speedDegreesPerSecond = 15.0;
  double elevationDegrees = 20.0;
  double distanceRadii = 3.0;
  double fovDegrees = 40.0;
  double rateHz = 10.0;
  double linkKbps = 0.0;  // kilobits a second that a client reads; 0: unlimited
  double errorPx = 1.0;
  std::uint16_t width = 1024;
  std::uint16_t height = 1024;
  Behaviour behaviour = Behaviour::kNormal;
  /// Starts together with the phase before instead of after it: mixes behaviours.
  bool withPrevious = false;
  /// Its poses' latencies count. Not so of clients that are slow or hostile, or only a crowd.
  bool measured = true;
  /// Whoever loses the line comes back; those who decode go on from what they hold.
  bool returns = false;
};

/// What a run does (commands.md, limn-load) and what it must reach.
struct Script {
  std::vector<Phase> phases;
  double decode = 0.01;  // fraction of the clients that decode every byte into a mesh
  std::map<std::string, double> thresholds;  // names: thresholdNames()
};

/// Thresholds a script may name: each is an upper bound on a number of the report.
[[nodiscard]] const std::vector<std::string>& thresholdNames();

/// Reads a script. `folder` is where relative camera files are looked for. Errors: kInvalidArgument
/// with the line and what to write instead; kNotFound, kCorrupt for camera files.
[[nodiscard]] Result<Script> parseScript(
    std::string_view toml,
    const std::filesystem::path& folder);
[[nodiscard]] Result<Script> readScript(const std::filesystem::path& file);

}  // namespace limn::load
