// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <unordered_map>

namespace limn {

/// Which border vertices are one place, where parts lie against one another without being joined.
/// Refers to the mesh and its positions. Threads: one at a time.
class CrackPlaces {
 public:
  CrackPlaces(const HalfEdgeMesh& mesh, std::span<const glm::ivec3> positions)
      : mesh_(mesh),
        positions_(positions) {}

  /// A border vertex's first one asked for that is as near as a crack is wide; others themselves.
  [[nodiscard]] std::uint32_t placeOf(std::uint32_t vertex);

 private:
  [[nodiscard]] std::uint32_t find(std::uint32_t vertex);

  const HalfEdgeMesh& mesh_;
  std::span<const glm::ivec3> positions_;
  std::unordered_map<std::uint32_t, std::uint32_t> places_;
  std::unordered_map<std::uint64_t, std::uint32_t> firsts_;  // a place's first vertex, by cell
};

}  // namespace limn
