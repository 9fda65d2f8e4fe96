// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// What a half-edge without a twin is to look at.
enum class Crack : std::uint8_t {
  kNot,        // a border, or no border at all
  kInvisible,  // across it the surface goes on; or another border marks the same crease
  kCrease,     // across it the surface goes on at an angle
};

/// A part of an invisible crack: two borders along one another. Shares of their half-edges, from
/// origin to target; `begin` below `end`.
struct CrackPart {
  HalfEdgeId here = kNone;
  HalfEdgeId there = kNone;
  float begin = 0.0F;
  float end = 1.0F;
  float beginThere = 1.0F;  // the same places on the other side
  float endThere = 0.0F;
};

struct Cracks {
  std::vector<Crack> kinds;    // one entry a half-edge
  std::vector<FaceId> across;  // of a crease: the face on the other side, at its middle; else kNone
  /// Where the surface goes on smoothly, each part from either side.
  std::vector<CrackPart> parts;
};

struct CrackOptions {
  double widest = 2.0;  // grid units between the two sides
  /// From this difference of the two sides' normals on a crack is a crease.
  double sharpDegrees = 40.0;
};

/// Finds borders that are none to look at: the surface goes on across them, on faces that were not
/// joined (a corner on the middle of another's edge, places a rounding apart), as machine parts
/// often come. A crack is one over its whole length. Two sheets back to back
/// have borders. Where several meet along a crease, `across` is of one of them.
/// Cost: O(faces) to find the borders, then O(borders) unless very many lie in one place.
/// Threads: reentrant.
[[nodiscard]] Cracks findCracks(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    const CrackOptions& options = {});

}  // namespace limn
