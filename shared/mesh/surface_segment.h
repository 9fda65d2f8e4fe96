// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cstdint>

namespace limn {

/// A piece of a line that runs over a surface: straight, on one face. Ends with one node are one
/// point, so that pieces make lines.
struct SurfaceSegment {
  struct End {
    std::uint32_t node = 0;  // names the point among those of its kind of line
    glm::vec3 point{0.0F};   // grid units
    float strength = 1.0F;   // how much of a line it is there, 0 … 1
  };

  FaceId face = kNone;
  std::array<End, 2> ends;
};

/// The node of a line that crosses an edge at one place.
[[nodiscard]] inline std::uint32_t edgeNode(const HalfEdgeMesh& mesh, HalfEdgeId h) {
  return std::min(h, mesh.twin(h));  // kNone is larger than any
}

}  // namespace limn
