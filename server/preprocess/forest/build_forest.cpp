// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/forest/build_forest.h"

#include "server/preprocess/forest/collapse_mesh.h"
#include "server/preprocess/forest/level_simplifier.h"

#include "shared/codec/draco_codec.h"
#include "shared/core/assert.h"
#include "shared/mesh/feature_edges.h"

#include <algorithm>
#include <span>

namespace limn {
namespace {

// The base mesh, its vertices renumbered in the order of `present`.
TriangleMesh extractBase(const LevelSimplifier& builder, const TriangleMesh& full) {
  const CollapseMesh& mesh = builder.mesh();
  std::vector<std::uint32_t> number(mesh.positions().size(), kNone);
  TriangleMesh base;
  base.grid = full.grid;
  const AttributeArrays& attributes = full.attributes;
  for (const std::uint32_t v : builder.present()) {
    number[v] = static_cast<std::uint32_t>(base.positions.size());
    base.positions.push_back(mesh.positions()[v]);
    if (!attributes.colors.empty()) base.attributes.colors.push_back(attributes.colors[v]);
    if (!attributes.normals.empty()) base.attributes.normals.push_back(attributes.normals[v]);
  }
  for (const glm::uvec3& t : mesh.mesh().triangles()) {
    base.triangles.emplace_back(number[t.x], number[t.y], number[t.z]);
  }
  return base;
}

// Gives every vertex its permanent id: base in Draco's order, then level by level, coarse to fine,
// by the parent's id within a level, so that both run upwards together.
std::vector<VertexId> numberVertices(
    const LevelSimplifier& builder,
    std::span<const std::uint32_t> baseOrder,
    SplitForest& forest) {
  std::vector<VertexId> id(builder.mesh().positions().size(), kNone);
  VertexId next = 0;
  for (const std::uint32_t b : baseOrder)
    id[builder.present()[b]] = next++;
  forest.levelBegin = {0, next};
  for (auto level = builder.levels().rbegin(); level != builder.levels().rend(); ++level) {
    std::vector<std::pair<VertexId, std::uint32_t>> byParent;
    for (const HalfEdgeCollapse& c : level->collapses)
      byParent.emplace_back(id[c.kept], c.removed);
    std::sort(byParent.begin(), byParent.end());
    for (const auto& [parent, v] : byParent)
      id[v] = next++;
    forest.levelBegin.push_back(next);
  }
  return id;
}

void recordSplits(
    const LevelSimplifier& builder,
    std::span<const VertexId> id,
    SplitForest& forest) {
  const std::uint32_t base = forest.baseVertexCount();
  const std::uint32_t splits = forest.splitCount();
  forest.parents.resize(splits);
  forest.cuts.resize(splits);
  forest.features.resize(splits);
  forest.bounds.resize(splits);
  forest.ringBegin.assign(1, 0);

  struct Source {
    const CollapseLevel* level;
    std::uint32_t index;
  };

  std::vector<Source> sources(splits);
  for (const CollapseLevel& level : builder.levels()) {
    for (std::uint32_t i = 0; i < level.collapses.size(); ++i) {
      sources[id[level.collapses[i].removed] - base] = {&level, i};
    }
  }
  for (std::uint32_t s = 0; s < splits; ++s) {
    const auto& [level, i] = sources[s];
    const HalfEdgeCollapse& collapse = level->collapses[i];
    const auto ringStart = static_cast<std::ptrdiff_t>(forest.rings.size());
    for (std::uint32_t r = level->ringBegin[i]; r < level->ringBegin[i + 1]; ++r) {
      forest.rings.push_back(id[level->rings[r]]);
    }
    const auto ringFirst = forest.rings.begin() + ringStart;
    if (!level->isPath[i])
      std::rotate(ringFirst, std::min_element(ringFirst, forest.rings.end()), forest.rings.end());
    const auto indexOf = [&](std::uint32_t side) {
      if (side == kNone) return RingCut::kNoCut;
      const auto found = std::find(forest.rings.begin() + ringStart, forest.rings.end(), id[side]);
      LIMN_ASSERT(found != forest.rings.end());
      return static_cast<std::uint8_t>(found - (forest.rings.begin() + ringStart));
    };
    forest.cuts[s] = {indexOf(collapse.left), indexOf(collapse.right)};
    forest.parents[s] = id[collapse.kept];
    if (collapse.seams != 0) forest.seams[s] = collapse.seams;
    forest.features[s] = collapse.features | (level->isPath[i] ? kSplitParentOnBorder : 0);
    forest.bounds[s] = level->bounds[i];
    if (!forest.moves.by.empty()) forest.moves.by[s] = level->moves[i];
    forest.ringBegin.push_back(static_cast<std::uint32_t>(forest.rings.size()));
  }
}

// Features of the decoded base mesh's half-edges, looked up in the simplified one.
std::vector<std::uint8_t> baseFeatures(
    const LevelSimplifier& builder,
    std::span<const VertexId> id,
    const TriangleMesh& base) {
  const CollapseMesh& mesh = builder.mesh();
  std::vector<std::uint32_t> original(base.positions.size());
  for (const std::uint32_t v : builder.present())
    original[id[v]] = v;
  std::vector<std::uint8_t> features;
  for (const glm::uvec3& t : base.triangles) {
    for (int k = 0; k < 3; ++k) {
      const HalfEdgeId h = mesh.mesh().find(original[t[k]], original[t[(k + 1) % 3]]);
      features.push_back(h == kNone ? 0 : mesh.features()[h]);
    }
  }
  return features;
}

}  // namespace

Result<BuiltForest> buildForest(
    const TriangleMesh& mesh,
    const ForestOptions& options,
    std::span<const std::uint8_t> seams) {
  auto full =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  if (!full) return tl::unexpected(full.error());
  std::vector<std::uint8_t> features =
      findCreases(*full, mesh.positions, options.creaseAngleDegrees);
  bool hasSeams = false;
  for (std::size_t h = 0; h < seams.size(); ++h) {
    features[h] |= seams[h];
    hasSeams = hasSeams || seams[h] != 0;
  }
  auto collapsible = CollapseMesh::build(mesh, std::move(features));
  if (!collapsible) return tl::unexpected(collapsible.error());

  LevelSimplifier builder(std::move(*collapsible), options);
  builder.run();

  BuiltForest result;
  SplitForest& forest = result.forest;
  const TriangleMesh base = extractBase(builder, mesh);
  auto draco = encodeDraco(base);
  if (!draco) return tl::unexpected(draco.error().within("base mesh"));
  auto decoded = decodeDraco(
      draco->bytes,
      static_cast<std::uint32_t>(base.positions.size()),
      static_cast<std::uint32_t>(base.triangles.size()));
  if (!decoded) return tl::unexpected(decoded.error().within("base mesh"));

  forest.grid = mesh.grid;
  const std::vector<VertexId> id = numberVertices(builder, draco->order, forest);
  forest.positions.resize(mesh.positions.size());
  forest.attributes.colors.resize(mesh.attributes.colors.size());
  forest.attributes.normals.resize(mesh.attributes.normals.size());
  for (std::size_t v = 0; v < id.size(); ++v) {
    forest.positions[id[v]] = mesh.positions[v];
    if (!mesh.attributes.colors.empty())
      forest.attributes.colors[id[v]] = mesh.attributes.colors[v];
    if (!mesh.attributes.normals.empty())
      forest.attributes.normals[id[v]] = mesh.attributes.normals[v];
  }
  forest.baseTriangles = std::move(decoded->triangles);
  forest.baseFeatures =
      baseFeatures(builder, id, {mesh.grid, decoded->positions, forest.baseTriangles, {}});
  forest.triangles.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles)
    forest.triangles.emplace_back(id[t.x], id[t.y], id[t.z]);
  if (hasSeams) forest.seams.assign(forest.splitCount(), 0);
  if (options.placement == Placement::kVolume)
    forest.moves.by.assign(forest.splitCount(), glm::ivec3(0));
  recordSplits(builder, id, forest);
  forest.deriveMoves();

  if (mesh.attributes.kinds() != 0) {
    const auto bare = encodeDraco({base.grid, base.positions, base.triangles, {}});
    if (bare && bare->bytes.size() < draco->bytes.size())
      result.baseAttributeBytes = draco->bytes.size() - bare->bytes.size();
  }
  result.baseDraco = std::move(draco->bytes);
  result.levels.push_back(builder.base());
  for (auto level = builder.levels().rbegin(); level != builder.levels().rend(); ++level) {
    result.levels.push_back(level->finer);
  }
  return result;
}

}  // namespace limn
