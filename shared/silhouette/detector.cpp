// SPDX-License-Identifier: Apache-2.0
#include "shared/silhouette/detector.h"

#include "shared/core/assert.h"
#include "shared/silhouette/brute_force.h"
#include "shared/silhouette/coherence.h"
#include "shared/silhouette/cones.h"
#include "shared/silhouette/image_seeds.h"
#include "shared/silhouette/precomputed.h"
#include "shared/silhouette/random_seeds.h"

#include <algorithm>
#include <array>
#include <utility>

namespace limn {
namespace {

constexpr std::array<DetectorMethod, 8> kMethods = {
    DetectorMethod::kBrute,
    DetectorMethod::kCones,
    DetectorMethod::kExact,
    DetectorMethod::kRandom,
    DetectorMethod::kCoherenceA,
    DetectorMethod::kCoherenceB,
    DetectorMethod::kImage,
    DetectorMethod::kPrecomputed,
};

constexpr std::array<std::pair<DetectorMethod, std::string_view>, kMethods.size()> kNames = {{
    {DetectorMethod::kBrute, "brute"},
    {DetectorMethod::kCones, "cones"},
    {DetectorMethod::kExact, "exact"},
    {DetectorMethod::kRandom, "random"},
    {DetectorMethod::kCoherenceA, "coherence-a"},
    {DetectorMethod::kCoherenceB, "coherence-b"},
    {DetectorMethod::kImage, "image"},
    {DetectorMethod::kPrecomputed, "precomputed"},
}};

// How many of `wanted` are in `given`; both are sets.
std::size_t countCommon(std::vector<std::uint32_t> given, std::vector<std::uint32_t> wanted) {
  std::sort(given.begin(), given.end());
  std::sort(wanted.begin(), wanted.end());
  std::vector<std::uint32_t> common;
  std::set_intersection(
      given.begin(),
      given.end(),
      wanted.begin(),
      wanted.end(),
      std::back_inserter(common));
  return common.size();
}

}  // namespace

std::span<const DetectorMethod> allDetectors() {
  return kMethods;
}

std::string_view detectorName(DetectorMethod method) {
  for (const auto& [value, name] : kNames) {
    if (value == method) return name;
  }
  return "unknown";
}

std::optional<DetectorMethod> detectorFromName(std::string_view name) {
  for (const auto& [value, known] : kNames) {
    if (known == name) return value;
  }
  return std::nullopt;
}

std::unique_ptr<SilhouetteDetector>
makeDetector(DetectorMethod method, const SilhouetteField& field, const DetectorOptions& options) {
  switch (method) {
    case DetectorMethod::kBrute:
      return std::make_unique<BruteForceDetector>(field, options);
    case DetectorMethod::kCones:
      return std::make_unique<ConesDetector>(field, options, ConesDetector::Order::kTree);
    case DetectorMethod::kExact:
      return std::make_unique<ConesDetector>(field, options, ConesDetector::Order::kLastFrameFirst);
    case DetectorMethod::kRandom:
      return std::make_unique<RandomDetector>(field, options.random);
    case DetectorMethod::kCoherenceA:
      return std::make_unique<CoherenceADetector>(field, options);
    case DetectorMethod::kCoherenceB:
      return std::make_unique<CoherenceBDetector>(field, options);
    case DetectorMethod::kImage:
      return std::make_unique<ImageDetector>(field, options);
    case DetectorMethod::kPrecomputed:
      return std::make_unique<PrecomputedDetector>(field, options);
  }
  LIMN_ASSERT(false);
  return nullptr;
}

double recall(const SilhouetteResult& found, const SilhouetteResult& truth) {
  const std::size_t wanted = truth.edges.size() + truth.faces.size();
  if (wanted == 0) return 1.0;
  const std::size_t common =
      countCommon(found.edges, truth.edges) + countCommon(found.faces, truth.faces);
  return static_cast<double>(common) / static_cast<double>(wanted);
}

}  // namespace limn
