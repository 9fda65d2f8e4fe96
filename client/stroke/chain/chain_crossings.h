// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/core/vector_code.h"
#include "shared/silhouette/field.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// How SilhouetteChainer joins the segments of smooth silhouettes. Internal to client/stroke.
namespace limn::chaining {

/// How many places before and after its own a segment's successor is looked for before the table.
inline constexpr std::size_t kNear = 16;

/// A segment's two names: what leads into it, and what it leads to.
struct alignas(16) Passage {
  std::uint64_t from;
  std::uint64_t to;
};

/// Of the names of edges that a smooth silhouette crosses: front vertex above, back vertex below.
[[nodiscard]] inline std::uint64_t crossingName(std::uint32_t front, std::uint32_t back) {
  return std::uint64_t{front} << 32 | back;
}

[[nodiscard]] inline std::uint64_t hashOf(std::uint64_t name) {
  return name * 0x9E3779B97F4A7C15ULL;
}

/// The half of a hash that names are compared by at first.
[[nodiscard]] inline std::uint32_t keyOf(std::uint64_t name) {
  return static_cast<std::uint32_t>(hashOf(name) >> 32);
}

/// One entry a crossed face; those marked so with kNear more before, and kNear + 1 after.
struct Crossings {
  std::vector<Passage> passages;    // with the margin, which has no face's names
  std::vector<std::uint32_t> keys;  // of what leads in; with the margin
  std::vector<glm::vec4> ends;      // where the silhouette leaves the face, SmoothWalk::exitPoint
};

/// Fills `out` for faces that the silhouette crosses. code: instructions that the machine has; the
/// result is the same. Cost: O(faces).
void nameCrossings(
    const SilhouetteField& field,
    const glm::vec4& eye,
    std::span<const FaceId> faces,
    VectorCode code,
    Crossings& out);

/// Segments joined to one that was found a few places from them.
struct NearJoins {
  std::vector<std::uint32_t> next;        // by segment: the one that goes on from it, or kNone
  std::vector<std::uint8_t> isContinued;  // by segment, with the margin: one leads to it
  std::vector<std::uint32_t> unjoined;    // segments without a next
};

/// Fills `next` and `unjoined`, marks `isContinued` (all 0 before, of the right sizes).
void joinNear(const Crossings& crossings, VectorCode code, NearJoins& joins);

}  // namespace limn::chaining
