// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/attribute_codec.h"

#include "shared/codec/attribute_syntax.h"

#include <numeric>

namespace limn {
namespace {

using attribute_syntax::Neighbours;
using split_syntax::Neighbourhood;

Neighbours neighboursOf(const SplitForest& forest, VertexId v) {
  const std::span<const VertexId> ring = forest.ring(v);
  Neighbourhood n;
  n.parent = forest.positions[forest.parent(v)];
  n.size = static_cast<std::uint32_t>(std::min<std::size_t>(ring.size(), split_syntax::kMaxRing));
  for (std::uint32_t i = 0; i < n.size; ++i)
    n.ring[i] = forest.positions[ring[i]] - n.parent;
  const std::uint32_t s = v - forest.baseVertexCount();
  n.isPath = (forest.features[s] & kSplitParentOnBorder) != 0;
  return attribute_syntax::neighboursOf(
      n,
      forest.cuts[s],
      forest.positions[v],
      forest.attributes.at(forest.parent(v)),
      [&](std::uint32_t i) { return forest.attributes.at(ring[i]); });
}

}  // namespace

std::vector<std::uint8_t> encodeAttributes(
    const SplitForest& forest,
    std::span<const VertexId> ids) {
  const std::uint8_t kinds = forest.attributeKinds();
  if (kinds == 0) return {};
  AdaptiveContexts contexts(attribute_syntax::kContexts);
  AdaptiveBinWriter bins(contexts);
  for (const VertexId v : ids) {
    VertexSplit split = forest.split(v);
    attribute_syntax::codeAttributes(bins, neighboursOf(forest, v), kinds, split);
  }
  return bins.finish();
}

std::vector<std::uint8_t>
encodeAttributes(const SplitForest& forest, VertexId begin, VertexId end) {
  std::vector<VertexId> ids(end - begin);
  std::iota(ids.begin(), ids.end(), begin);
  return encodeAttributes(forest, ids);
}

AttributeReader::AttributeReader(std::uint8_t kinds, std::span<const std::uint8_t> bytes)
    : kinds_(kinds),
      isEmpty_(bytes.empty()),
      contexts_(kinds == 0 ? 1 : attribute_syntax::kContexts),
      bins_(contexts_, bytes) {}

void AttributeReader::read(
    const ActiveMesh& mesh,
    std::span<const Slot> ring,
    const Neighbourhood& n,
    const RingCut& cut,
    VertexSplit& split) {
  if (kinds_ == 0) return;
  const auto neighbours = attribute_syntax::neighboursOf(
      n,
      cut,
      split.position,
      mesh.attributes().at(mesh.slotOf(split.parent)),
      [&](std::uint32_t i) { return mesh.attributes().at(ring[i]); });
  attribute_syntax::codeAttributes(bins_, neighbours, kinds_, split);
}

}  // namespace limn
