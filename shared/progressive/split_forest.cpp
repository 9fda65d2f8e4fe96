// SPDX-License-Identifier: Apache-2.0
#include "shared/progressive/split_forest.h"

#include <bit>
#include <cstring>
#include <string>
#include <type_traits>

namespace limn {

static_assert(std::endian::native == std::endian::little, "the forest section is little-endian");

VertexSplit SplitForest::split(VertexId v) const {
  const std::uint32_t s = v - baseVertexCount();
  const std::span<const VertexId> around = ring(v);
  const RingCut cut = cuts[s];
  return {
      .vertex = v,
      .parent = parents[s],
      .left = cut.left == RingCut::kNoCut ? kNone : around[cut.left],
      .right = cut.right == RingCut::kNoCut ? kNone : around[cut.right],
      .position = positions[v],
      .features = features[s],
      .seams = seams.empty() ? std::uint8_t{0} : seams[s],
      .attributes = attributes.at(v)};
}

namespace {

constexpr std::uint32_t kForestMagic = 0x31464C4D;            // "MLF1"
constexpr std::uint32_t kForestMagicAttributes = 0x32464C4D;  // "MLF2": attributes follow

class Writer {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* begin = reinterpret_cast<const std::uint8_t*>(&v);
    bytes_.insert(bytes_.end(), begin, begin + sizeof(T));
  }

  template <class T>
  void array(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    value(static_cast<std::uint64_t>(values.size()));
    const auto* begin = reinterpret_cast<const std::uint8_t*>(values.data());
    bytes_.insert(bytes_.end(), begin, begin + values.size() * sizeof(T));
  }

  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <class T>
  bool value(T& v) {
    if (bytes_.size() < sizeof(T)) return false;
    std::memcpy(&v, bytes_.data(), sizeof(T));
    bytes_ = bytes_.subspan(sizeof(T));
    return true;
  }

  template <class T>
  bool array(std::vector<T>& values) {
    std::uint64_t count = 0;
    if (!value(count) || count > bytes_.size() / sizeof(T)) return false;
    values.resize(count);
    if (count > 0) std::memcpy(static_cast<void*>(values.data()), bytes_.data(), count * sizeof(T));
    bytes_ = bytes_.subspan(count * sizeof(T));
    return true;
  }

  [[nodiscard]] bool atEnd() const { return bytes_.empty(); }

 private:
  std::span<const std::uint8_t> bytes_;
};

// Everything that indexes something else, so that the rest of the server may trust a parsed forest.
const char* findFault(const SplitForest& forest) {
  const auto& begin = forest.levelBegin;
  if (begin.size() < 2 || begin[0] != 0 || !std::is_sorted(begin.begin(), begin.end())) {
    return "level table";
  }
  const std::uint32_t vertices = forest.vertexCount();
  const std::uint32_t splits = forest.splitCount();
  if (forest.positions.size() != vertices || forest.parents.size() != splits ||
      forest.ringBegin.size() != splits + 1U || forest.cuts.size() != splits ||
      forest.features.size() != splits || forest.bounds.size() != splits ||
      forest.baseFeatures.size() != 3 * forest.baseTriangles.size() ||
      (!forest.seams.empty() && forest.seams.size() != splits) ||
      (!forest.attributes.colors.empty() && forest.attributes.colors.size() != vertices) ||
      (!forest.attributes.normals.empty() && forest.attributes.normals.size() != vertices)) {
    return "array sizes";
  }
  for (const OctNormal& normal : forest.attributes.normals) {
    if (std::max(normal.x, normal.y) > 2 * kOctRadius) return "normal";
  }
  for (const glm::uvec3& t : forest.baseTriangles) {
    if (std::max({t.x, t.y, t.z}) >= forest.baseVertexCount()) return "base triangle";
  }
  for (const glm::uvec3& t : forest.triangles) {
    if (std::max({t.x, t.y, t.z}) >= vertices) return "triangle";
  }
  if (forest.ringBegin.front() != 0 || forest.ringBegin.back() != forest.rings.size() ||
      !std::is_sorted(forest.ringBegin.begin(), forest.ringBegin.end())) {
    return "ring table";
  }
  for (std::uint32_t level = 1; level < forest.levelCount(); ++level) {
    for (VertexId v = begin[level]; v < begin[level + 1]; ++v) {
      const auto ring = forest.ring(v);
      const RingCut cut = forest.cuts[v - begin[1]];
      if (forest.parent(v) >= begin[level]) return "parent";
      for (const VertexId w : ring) {
        if (w >= begin[level]) return "ring";
      }
      const auto bad = [&](std::uint8_t side) {
        return side != RingCut::kNoCut && side >= ring.size();
      };
      if (bad(cut.left) || bad(cut.right) || cut.left == cut.right) return "cut";
    }
  }
  return nullptr;
}

}  // namespace

std::vector<std::uint8_t> serializeForest(const SplitForest& forest) {
  Writer out;
  const bool hasAttributes = forest.attributeKinds() != 0;
  out.value(hasAttributes ? kForestMagicAttributes : kForestMagic);
  out.value(static_cast<std::int32_t>(forest.grid.bits));
  out.value(forest.grid.origin);
  out.value(forest.grid.step);
  out.array(forest.levelBegin);
  out.array(forest.positions);
  out.array(forest.baseTriangles);
  out.array(forest.baseFeatures);
  out.array(forest.triangles);
  out.array(forest.parents);
  out.array(forest.ringBegin);
  out.array(forest.rings);
  out.array(forest.cuts);
  out.array(forest.features);
  out.array(forest.bounds);
  if (hasAttributes) {
    out.array(forest.seams);
    out.array(forest.attributes.colors);
    out.array(forest.attributes.normals);
  }
  return out.take();
}

Result<SplitForest> parseForest(std::span<const std::uint8_t> bytes) {
  Reader in(bytes);
  SplitForest forest;
  std::uint32_t magic = 0;
  std::int32_t bits = 0;
  const bool whole =
      in.value(magic) && (magic == kForestMagic || magic == kForestMagicAttributes) &&
      in.value(bits) && in.value(forest.grid.origin) && in.value(forest.grid.step) &&
      in.array(forest.levelBegin) && in.array(forest.positions) && in.array(forest.baseTriangles) &&
      in.array(forest.baseFeatures) && in.array(forest.triangles) && in.array(forest.parents) &&
      in.array(forest.ringBegin) && in.array(forest.rings) && in.array(forest.cuts) &&
      in.array(forest.features) && in.array(forest.bounds) &&
      (magic == kForestMagic || (in.array(forest.seams) && in.array(forest.attributes.colors) &&
                                 in.array(forest.attributes.normals))) &&
      in.atEnd();
  if (!whole)
    return fail(
        ErrorCode::kCorrupt,
        "forest section is cut short or not a forest: prepare the model again");
  forest.grid.bits = bits;
  if (const char* fault = findFault(forest)) {
    return fail(
        ErrorCode::kCorrupt,
        std::string("forest section is damaged (") + fault + "): prepare the model again");
  }
  return forest;
}

}  // namespace limn
