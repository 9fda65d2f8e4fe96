// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/hulls/hull_mesh.h"

#include "shared/core/linear_program.h"
#include "shared/core/rng.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace limn {

/// Where a collapse may put its vertex.
struct PlacementRules {
  /// Cosine of the largest angle that a face may turn by; −1: any.
  double minNormalDot = 0.2;
  /// Neighbours that the vertex may have afterwards; what a ring may have on the wire.
  std::uint32_t maxValence = 48;
};

/// Places the vertex of an edge collapse so that the mesh grows, by as little as possible
/// [Sander00]: outside of (or on) the plane of every face around the edge. The result is a grid
/// position that satisfies every constraint exactly. README.md, "Hulls", says why that encloses.
class HullPlacement {
 public:
  struct Place {
    glm::ivec3 position{0};
    double volume6 = 0.0;  // six times the volume gained, ≥ 0; exact up to 2^53
  };

  /// nullopt where no grid position satisfies the constraints and the rules, or the link condition
  /// forbids the collapse. Cost: some 2 µs.
  [[nodiscard]] std::optional<Place>
  place(const HullMesh& mesh, HalfEdgeId h, const PlacementRules& rules);

 private:
  struct Face {
    glm::i64vec3 normal{0};  // area normal
    double length = 0.0;     // of `normal`
    glm::ivec3 point{0};     // a corner
    glm::ivec3 second{0};    // the two corners that stay when the third is moved, in order; the
    glm::ivec3 third{0};     // first two faces, which the collapse removes, have none
  };

  void gather(const HullMesh& mesh, HalfEdgeId h);
  [[nodiscard]] std::optional<glm::dvec3> solve(double margin);
  void addCandidate(const glm::ivec3& p);
  [[nodiscard]] bool turnsTooFar(const glm::ivec3& p, double minNormalDot) const;

  std::vector<FaceId> around_;
  std::vector<Face> faces_;  // around the edge
  std::vector<HalfSpace> constraints_;
  std::vector<Place> candidates_;
  glm::dvec3 center_{0.0};  // of the edge
  double scale_ = 1.0;      // about the size of the neighbourhood
  Rng order_{1};
};

}  // namespace limn
