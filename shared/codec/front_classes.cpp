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
  const auto held = std::ranges::count_if(ids, [count](VertexId v) { return v < count; });
  if (static_cast<VertexId>(held) != count) {
    return fail(ErrorCode::kCorrupt, "a level run came before all of the levels that it stands on");
  }
  // Putting vertices of this level and finer back where they came from leaves the faces of the mesh
  // before it, and degenerate ones.
  std::vector<VertexId> ancestors(ids.begin(), ids.end());  // by slot
  for (VertexId& v : ancestors) {
    while (v >= count)
      v = mesh.parentOf(v);
  }
  const auto triangles = mesh.mesh().triangles();
  std::vector<glm::uvec3> faces;
  faces.reserve(triangles.size());
  for (const glm::uvec3& t : triangles) {
    const glm::uvec3 face(ancestors[t.x], ancestors[t.y], ancestors[t.z]);
    if (face.x != face.y && face.y != face.z && face.z != face.x) faces.push_back(face);
  }
  std::vector<Wide> positions(count);
  for (std::size_t slot = 0; slot < ids.size(); ++slot) {
    if (ids[slot] < count) positions[ids[slot]] = Wide(mesh.positions()[slot]);
  }

  struct Star {
    std::int64_t area = 0;
    std::int32_t faces = 0;
    std::int32_t around = 0;  // log8 of the areas around, each face's two other corners
  };

  std::vector<Star> stars(count);
  for (const glm::uvec3& t : faces) {
    const Wide& a = positions[t.x];
    const std::int64_t area = sumNorm(cross(positions[t.y] - a, positions[t.z] - a));
    for (int k = 0; k < 3; ++k)
      stars[t[k]].area += area;
  }
  std::vector<std::int32_t> areas(count);
  for (VertexId v = 0; v < count; ++v)
    areas[v] = log8(static_cast<std::uint64_t>(stars[v].area));
  for (const glm::uvec3& t : faces) {
    const std::int32_t sum = areas[t.x] + areas[t.y] + areas[t.z];
    for (int k = 0; k < 3; ++k) {
      ++stars[t[k]].faces;
      stars[t[k]].around += sum - areas[t[k]];
    }
  }
  std::vector<std::uint8_t> classes;
  classes.reserve(count);
  std::uint32_t own = 0;  // the vertex's level
  for (VertexId v = 0; v < count; ++v) {
    while (v >= begin[own + 1])
      ++own;
    const Star& star = stars[v];
    const std::int32_t around = star.faces == 0 ? 0 : star.around / (2 * star.faces);
    classes.push_back(classOf(
        static_cast<std::size_t>(star.faces),
        areas[v] - around,
        own == 0 ? 7 : level - own));
  }
  return classes;
}

LevelFronts frontsOf(const SplitForest& forest) {
  TriangleMesh base{forest.grid, {}, forest.baseTriangles};
  base.positions.assign(
      forest.positions.begin(),
      forest.positions.begin() + forest.baseVertexCount());
  auto mesh = ActiveMesh::fromBase(forest.levelBegin, base, forest.baseFeatures);
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
