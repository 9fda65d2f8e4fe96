// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <vector>

namespace limn::bench {

/// What every simplifier gets and gives: positions in grid units, triangles counter-clockwise from
/// outside. Vertices that no triangle uses are allowed.
struct PlainMesh {
  std::vector<glm::dvec3> positions;
  std::vector<glm::uvec3> triangles;
};

}  // namespace limn::bench
