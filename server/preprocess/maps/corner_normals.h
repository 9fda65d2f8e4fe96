// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/triangle_mesh.h"

#include <glm/glm.hpp>

#include <vector>

namespace limn {

/// Three unit normals a face: at each corner the mean, by angle, of the normals of those faces
/// around it that are within creaseAngleDegrees of this one's, so that creases stay sharp. A face
/// without area has its corners' means, or +z.
/// Cost: O(faces · valence).
[[nodiscard]] std::vector<glm::vec3> cornerNormals(
    const TriangleMesh& mesh,
    double creaseAngleDegrees);

}  // namespace limn
