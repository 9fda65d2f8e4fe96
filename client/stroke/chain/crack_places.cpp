// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain/crack_places.h"

namespace limn {
namespace {

/// Vertices that lie within this of one another are one place, grid units.
constexpr double kSamePlace = 2.0;
constexpr int kCell = 4;

std::uint64_t nameOf(const glm::ivec3& cell) {
  const glm::i64vec3 c(cell);
  return static_cast<std::uint64_t>(
      (c.x & 0x1FFFFF) << 42 | (c.y & 0x1FFFFF) << 21 | (c.z & 0x1FFFFF));
}

}  // namespace

std::uint32_t CrackPlaces::placeOf(std::uint32_t vertex) {
  if (!mesh_.isBorderVertex(vertex)) return vertex;
  const auto [known, isNew] = places_.try_emplace(vertex, vertex);
  if (isNew) known->second = find(vertex);
  return known->second;
}

std::uint32_t CrackPlaces::find(std::uint32_t vertex) {
  const glm::ivec3 cell(glm::floor(glm::dvec3(positions_[vertex]) / double{kCell}));
  for (int k = 0; k < 27; ++k) {
    const auto there = firsts_.find(nameOf(cell + glm::ivec3(k % 3, k / 3 % 3, k / 9) - 1));
    if (there == firsts_.end()) continue;
    const glm::dvec3 apart(positions_[there->second] - positions_[vertex]);
    if (glm::dot(apart, apart) <= kSamePlace * kSamePlace) return there->second;
  }
  firsts_.try_emplace(nameOf(cell), vertex);
  return vertex;
}

}  // namespace limn
