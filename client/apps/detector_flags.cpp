// SPDX-License-Identifier: Apache-2.0
#include "client/apps/detector_flags.h"

#include "client/apps/flag_values.h"

#include <CLI/CLI.hpp>

namespace limn {

void DetectorFlags::addTo(CLI::App& app) {
  app.add_option("--silhouette", silhouette_, "smooth|edges");
  app.add_option("--light", light_, "X,Y,Z: silhouettes as a light there sees them");
  constexpr char kGroup[] = "Detector parameters";
  const auto number = [&](const char* flag, auto& target, auto low, auto high, const char* help) {
    app.add_option(flag, target, help)->check(CLI::Range(low, high))->group(kGroup);
  };
  const auto choice = [&](const char* flag, bool& target, const char* help) {
    app.add_flag(flag, target, help)->group(kGroup);
  };
  RandomSeedOptions& random = options_.random;
  number("--random-share", random.fraction, 0.0, 1.0, "random: share of the faces tried (0.1)");
  choice("--random-sharp", random.sortByDihedral, "random: faces with sharp edges more often");
  number("--random-walk", random.searchSteps, 0, 1000, "random: steps towards edge-on (0)");
  number("--random-seed", random.seed, 0, 1'000'000'000, "random: seed of the generator (1)");
  CoherenceOptions& coherence = options_.coherence;
  number("--rings", coherence.rings, 0, 100, "coherence-a: how far around to look (1)");
  choice("--follow-motion", coherence.followMotion, "coherence-a: look where the camera moves");
  number("--history", coherence.longestHistory, 1, 255, "coherence-b: frames remembered (8)");
  number("--reseed-every", coherence.reseedEvery, 0, 1'000'000, "coherence: frames (30; 0: once)");
  number("--reseed-below", coherence.reseedBelow, 0.0, 1.0, "coherence: or under this share (0)");
  app.add_option("--reseed-with", reseedWith_, "coherence: brute|random (brute)")->group(kGroup);
  number("--seed-viewpoints", options_.seedViewpoints, 1, 1000, "precomputed: nearest ones (5)");
  number("--seed-walk", options_.seedSearchSteps, 1, 1000, "precomputed: steps from a seed (24)");
  number("--seed-motion", options_.seedMotionRings, 0, 100, "precomputed: faces on (1)");
  number("--image-rings", options_.imageRings, 0, 100, "image: how far around to look (1)");
}

Result<DetectorChoice> DetectorFlags::parse() const {
  DetectorChoice choice;
  const auto silhouette = parseSilhouette(silhouette_);
  if (!silhouette) return tl::unexpected(silhouette.error());
  choice.silhouette = *silhouette;
  if (!light_.empty()) {
    const auto light = parseLight(light_);
    if (!light) return tl::unexpected(light.error());
    choice.light = *light;
  }
  choice.parameters = options_;
  const auto reseedWith = detectorFromName(reseedWith_);
  if (reseedWith != DetectorMethod::kBrute && reseedWith != DetectorMethod::kRandom) {
    return wrong("--reseed-with " + reseedWith_ + " is unknown: write brute or random");
  }
  choice.parameters.coherence.reseedWith = *reseedWith;
  return choice;
}

}  // namespace limn
