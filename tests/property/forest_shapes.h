// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/property/decorated.h"

#include "shared/mesh/primitives.h"
#include "shared/progressive/vertex_split.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <tuple>
#include <vector>

namespace limn {

/// Meshes that laws about forests are tested with; the first is its own base.
struct ForestShape {
  const char* name;
  TriangleMesh mesh;
};

inline std::vector<ForestShape> forestShapes() {
  return {
      {"tetrahedron", primitives::tetrahedron()},
      {"cube", primitives::cube()},
      {"icosphere", primitives::icosphere(4)},
      {"torus", primitives::torus(60, 24)},
      {"knot", primitives::torusKnot(2, 3, 240, 12)},
      {"grid", primitives::openGrid(40, 30)},
      {"bumpy", primitives::bumpySphere(4, 3)},
      {"painted", decorated(primitives::torusKnot(2, 3, 160, 10), kAllAttributeKinds)}};
}

/// One of forestShapes(), and how it is collapsed.
using ForestCase = std::tuple<std::size_t, Placement>;

/// From the shape `first` on.
inline auto forestCases(std::size_t first) {
  return testing::Combine(
      testing::Range(first, forestShapes().size()),
      testing::Values(Placement::kSubset, Placement::kVolume));
}

inline std::string nameOfForestCase(const testing::TestParamInfo<ForestCase>& info) {
  const bool moves = std::get<1>(info.param) == Placement::kVolume;
  return forestShapes()[std::get<0>(info.param)].name + std::string(moves ? "Volume" : "");
}

}  // namespace limn
