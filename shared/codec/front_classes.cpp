// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/front_classes.h"

#include "shared/codec/neighbourhood.h"
#include "shared/core/assert.h"

#include <algorithm>
#include <array>

namespace limn {
namespace {

using split_syntax::cross;
using split_syntax::log8;
using split_syntax::sumNorm;
using split_syntax::Wide;

// Binary logarithms of odds, in 16ths, fitted once like the factors of cut_odds.h.
constexpr std::array<std::int16_t, 16> kValence =
    {0, 0, -110, -91, -61, -34, -11, 13, 34, 57, 69, 78, 80, 80, 80, 80};
// By log8 of the area beside the neighbours' mean: a quarter of an octave a step.
constexpr std::array<std::int16_t, 32> kArea = {
    -30, -36, -46, -46, -30, -25, -25, -11, -8,  -6,  -5,  -4,  -5,  -7,  -7,  -8,
    -11, -8,  -10, -12, -23, -31, -45, -57, -60, -65, -70, -74, -80, -80, -80, -80};
// By levels since the vertex came, 7 or more, or of the base.
constexpr std::array<std::int16_t, 8> kAge = {0, -25, -7, -4, -3, -4, -1, 1};

std::uint8_t classOf(std::size_t valence, std::int32_t areaBeside, std::uint32_t levelsSince) {
  const std::int32_t score =
      kValence[std::min<std::size_t>(valence, 15)] +
      kArea[static_cast<std::size_t>(std::clamp((areaBeside + 32) / 2, 0, 31))] +
      kAge[std::min(levelsSince, 7U)];
  return static_cast<std::uint8_t>(std::clamp((score + 160) / 8, 0, 31));
}

}  // namespace

Result<std::vector<std::uint8_t>> frontClasses(const ActiveMesh& mesh, std::uint32_t level) {
  const auto begin = mesh.levelBegin();
  const VertexId count = begin[level];
  const auto ids = mesh.ids();
  auto positions = mesh.positions();
  std::vector<glm::ivec3> standing;  // where they stand at this level, if they move
  if (mesh.hasMoves()) {
    standing.assign(positions.begin(), positions.end());
    for (Slot slot = 0; slot < standing.size(); ++slot) {
      if (ids[slot] < count) standing[slot] = mesh.positionIn(count, slot);
    }
    positions = standing;
  }
  // By slot: where a vertex of this level or finer came from. Putting those back leaves the faces
  // of the mesh before this level, and degenerate ones.
  std::vector<Slot> origins(ids.size());
  VertexId held = 0;
  for (Slot slot = 0; slot < origins.size(); ++slot) {
    Slot origin = slot;
    while (ids[origin] >= count)
      origin = mesh.slotOf(mesh.parentOf(ids[origin]));
    origins[slot] = origin;
    held += origin == slot ? 1 : 0;
  }
  if (held != count) {
    return fail(ErrorCode::kCorrupt, "a level run came before all of the levels that it stands on");
  }
  const auto faces = mesh.mesh().triangles();
  const bool isWhole = held == ids.size();  // the usual case: nothing to put back
  const auto forEachFace = [&](const auto& take) {
    for (const glm::uvec3& t : faces) {
      const glm::uvec3 face = isWhole ? t : glm::uvec3(origins[t.x], origins[t.y], origins[t.z]);
      if (face.x != face.y && face.y != face.z && face.z != face.x) take(face);
    }
  };

  struct Star {
    std::int64_t area = 0;
    std::int32_t faces = 0;
    std::int32_t around = 0;  // log8 of the areas around, each face's two other corners
  };

  std::vector<Star> stars(origins.size());
  forEachFace([&](const glm::uvec3& t) {
    const glm::ivec3& a = positions[t.x];
    const std::int64_t area = sumNorm(cross(Wide(positions[t.y] - a), Wide(positions[t.z] - a)));
    for (int k = 0; k < 3; ++k)
      stars[t[k]].area += area;
  });
  std::vector<std::int32_t> areas(origins.size());
  for (Slot slot = 0; slot < areas.size(); ++slot)
    areas[slot] = log8(static_cast<std::uint64_t>(stars[slot].area));
  forEachFace([&](const glm::uvec3& t) {
    const std::int32_t sum = areas[t.x] + areas[t.y] + areas[t.z];
    for (int k = 0; k < 3; ++k) {
      ++stars[t[k]].faces;
      stars[t[k]].around += sum - areas[t[k]];
    }
  });
  std::vector<std::uint8_t> classes(count);
  std::uint32_t own = 0;  // level of the vertex; slots come level by level, mostly
  for (Slot slot = 0; slot < origins.size(); ++slot) {
    if (origins[slot] != slot) continue;
    if (ids[slot] < begin[own] || ids[slot] >= begin[own + 1]) own = mesh.levelOf(ids[slot]);
    const Star& star = stars[slot];
    const std::int32_t around = star.faces == 0 ? 0 : star.around / (2 * star.faces);
    classes[ids[slot]] = classOf(
        static_cast<std::size_t>(star.faces),
        areas[slot] - around,
        own == 0 ? 7 : level - own);
  }
  return classes;
}

LevelFronts frontsOf(const SplitForest& forest) {
  auto mesh = ActiveMesh::fromBase(forest.levelBegin, forest.baseMesh(), forest.baseFeatures);
  LIMN_ASSERT(mesh);
  LevelFronts fronts(1);
  for (std::uint32_t level = 1; level < forest.levelCount(); ++level) {
    auto front = frontClasses(*mesh, level);
    LIMN_ASSERT(front);
    fronts.push_back(std::move(*front));
    for (VertexId v = forest.levelBegin[level]; v < forest.levelBegin[level + 1]; ++v) {
      const auto applied = mesh->apply(forest.split(v));
      LIMN_ASSERT(applied);
      static_cast<void>(applied);
    }
  }
  return fronts;
}

}  // namespace limn
