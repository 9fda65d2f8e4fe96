// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"
#include "client/view/orbit_controls.h"

#include <glm/glm.hpp>

#include <optional>

namespace limn {

/// Where a ray (model coordinates) first meets the mesh. Cost: O(faces), about 10 ms a million:
/// for one double click, less than building a search structure.
[[nodiscard]] std::optional<glm::dvec3> pick(const MeshSnapshot& snapshot, const PixelRay& ray);

}  // namespace limn
