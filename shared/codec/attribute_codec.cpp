// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/attribute_codec.h"

#include "shared/codec/attribute_syntax.h"

#include <cmath>
#include <numeric>

namespace limn {
namespace {

using attribute_syntax::Neighbours;
using split_syntax::Neighbourhood;

Neighbours neighboursOf(const SplitForest& forest, VertexId v) {
  const std::span<const VertexId> ring = forest.ring(v);
  return attribute_syntax::neighboursOf(
      split_syntax::neighbourhoodOf(forest, v),
      forest.cuts[v - forest.baseVertexCount()],
      forest.positionIn(v + 1, v),
      forest.attributes.at(forest.parent(v)),
      [&](std::uint32_t i) { return forest.attributes.at(ring[i]); });
}

template <class Bins>
void codeAll(Bins& bins, const SplitForest& forest, std::span<const VertexId> ids) {
  const std::uint8_t kinds = forest.attributeKinds();
  for (const VertexId v : ids) {
    VertexSplit split = forest.split(v);
    attribute_syntax::codeAttributes(bins, neighboursOf(forest, v), kinds, split);
  }
}

/// An end of the syntax that counts what the coder would spend.
class AttributeMeter {
 public:
  bool code(std::uint32_t context, bool bit) {
    // Raw bits belong to the number that a context began.
    if (context != 0) kind_ = kindOf(context);
    const double zero = contexts_.zero(context) / 256.0;
    bits_.*kind_ -= std::log2(bit ? 1.0 - zero : zero);
    contexts_.update(context, bit);
    return bit;
  }

  [[nodiscard]] const AttributeBits& bits() const { return bits_; }

 private:
  static double AttributeBits::*kindOf(std::uint32_t context) {
    if (context < attribute_syntax::kFirstNormal) return &AttributeBits::colors;
    return context < attribute_syntax::kAnySeam ? &AttributeBits::normals : &AttributeBits::seams;
  }

  AdaptiveContexts contexts_{attribute_syntax::kContexts};
  AttributeBits bits_;
  double AttributeBits::*kind_ = &AttributeBits::colors;
};

std::vector<VertexId> idsFrom(VertexId begin, VertexId end) {
  std::vector<VertexId> ids(end - begin);
  std::iota(ids.begin(), ids.end(), begin);
  return ids;
}

}  // namespace

std::vector<std::uint8_t> encodeAttributes(
    const SplitForest& forest,
    std::span<const VertexId> ids) {
  if (forest.attributeKinds() == 0) return {};
  AdaptiveContexts contexts(attribute_syntax::kContexts);
  AdaptiveBinWriter bins(contexts);
  codeAll(bins, forest, ids);
  return bins.finish();
}

std::vector<std::uint8_t>
encodeAttributes(const SplitForest& forest, VertexId begin, VertexId end) {
  return encodeAttributes(forest, idsFrom(begin, end));
}

AttributeBits measureAttributes(const SplitForest& forest, VertexId begin, VertexId end) {
  AttributeMeter meter;
  codeAll(meter, forest, idsFrom(begin, end));
  return meter.bits();
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
