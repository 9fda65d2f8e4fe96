// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/visibility_truth.h"

namespace limn {

std::unique_ptr<VisibilityTruth> VisibilityTruth::create(
    const HalfEdgeMesh&,
    std::span<const glm::ivec3>) {
  return nullptr;
}

}  // namespace limn
