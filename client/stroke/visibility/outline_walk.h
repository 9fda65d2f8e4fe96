// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/line_scene.h"
#include "client/stroke/scene_faces.h"

#include <glm/glm.hpp>

#include <cstdint>

namespace limn {

/// Whether the surface that ends at an outline lies before a place beside that outline, as a ray
/// would find it: on the mesh itself, whatever a depth image can show. One camera.
class OutlineWalk {
 public:
  explicit OutlineWalk(const LineScene& scene);

  enum class Answer : std::uint8_t {
    kCovers,
    kLiesBehind,
    kUnknown,  // the surface turns, ends or is too finely divided on the way
  };

  /// place: near the outline on its surface's side, grid units; face: where to start, at the
  /// outline; own, ownOther: what the place lies on, which does not cover it (kNone: nothing).
  /// Cost: O(faces between).
  [[nodiscard]] Answer covers(FaceId face, const glm::dvec3& place, FaceId own, FaceId ownOther)
      const;

 private:
  const HalfEdgeMesh& mesh_;
  SceneFaces faces_;
};

}  // namespace limn
