// SPDX-License-Identifier: Apache-2.0
#include "shared/progressive/split_forest.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
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
      .position = positionIn(v + 1, v),
      .parentMove = moves.by.empty() ? glm::ivec3(0) : moves.by[s],
      .features = features[s],
      .seams = seams.empty() ? std::uint8_t{0} : seams[s],
      .attributes = attributes.at(v)};
}

TriangleMesh SplitForest::baseMesh() const {
  const std::uint32_t count = baseVertexCount();
  TriangleMesh base{grid, {}, baseTriangles, {}};
  base.positions.reserve(count);
  for (VertexId v = 0; v < count; ++v)
    base.positions.push_back(positionIn(count, v));
  const auto take = [count](const auto& all, auto& some) {
    if (!all.empty()) some.assign(all.begin(), all.begin() + count);
  };
  take(attributes.colors, base.attributes.colors);
  take(attributes.normals, base.attributes.normals);
  return base;
}

void SplitForest::deriveMoves() {
  if (moves.by.empty()) return;
  const std::uint32_t base = baseVertexCount();
  moves.last.assign(vertexCount(), kNone);
  moves.earlier.assign(splitCount(), kNone);
  moves.neededBegin.assign(1, 0);
  moves.needed.clear();
  // Level by level: until a level is done, `last` knows nothing finer.
  for (std::uint32_t level = 1; level < levelCount(); ++level) {
    for (VertexId v = levelBegin[level]; v < levelBegin[level + 1]; ++v) {
      const std::span<const VertexId> around = ring(v);
      const auto need = [&](VertexId x) {
        const VertexId mover = moves.last[x];
        const bool isThere = mover == kNone || mover == parent(v) ||
                             std::find(around.begin(), around.end(), mover) != around.end();
        if (!isThere) moves.needed.push_back(mover);
      };
      need(parent(v));
      for (const VertexId w : around)
        need(w);
      moves.neededBegin.push_back(static_cast<std::uint32_t>(moves.needed.size()));
    }
    for (VertexId v = levelBegin[level]; v < levelBegin[level + 1]; ++v) {
      if (moves.by[v - base] == glm::ivec3(0)) continue;
      moves.earlier[v - base] = moves.last[parent(v)];
      moves.last[parent(v)] = v;
    }
  }
}

namespace {

constexpr std::uint32_t kForestMagic = 0x31464C4D;            // "MLF1"
constexpr std::uint32_t kForestMagicAttributes = 0x32464C4D;  // "MLF2": attributes follow
constexpr std::uint32_t kForestMagicMoves = 0x33464C4D;       // "MLF3": attributes, then moves

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
      (!forest.moves.by.empty() && forest.moves.by.size() != splits) ||
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

// Wherever its splits put them, vertices are on the grid. Needs the derived moves.
bool standsOnGrid(const SplitForest& forest) {
  if (forest.placement() == Placement::kSubset) return true;
  for (VertexId v = 0; v < forest.vertexCount(); ++v) {
    glm::i64vec3 position(forest.positions[v]);
    for (VertexId w = forest.moves.last[v]; w != kNone;) {
      const std::uint32_t s = w - forest.baseVertexCount();
      position -= glm::i64vec3(forest.moves.by[s]);
      for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(position[axis]) > kMaxGridCoordinate) return false;
      }
      w = forest.moves.earlier[s];
    }
  }
  return true;
}

}  // namespace

std::vector<std::uint8_t> serializeForest(const SplitForest& forest) {
  Writer out;
  const bool hasMoves = forest.placement() != Placement::kSubset;
  const bool hasAttributes = hasMoves || forest.attributeKinds() != 0;
  out.value(hasMoves ? kForestMagicMoves : hasAttributes ? kForestMagicAttributes : kForestMagic);
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
  if (hasMoves) out.array(forest.moves.by);
  return out.take();
}

Result<SplitForest> parseForest(std::span<const std::uint8_t> bytes) {
  Reader in(bytes);
  SplitForest forest;
  std::uint32_t magic = 0;
  std::int32_t bits = 0;
  const bool whole =
      in.value(magic) &&
      (magic == kForestMagic || magic == kForestMagicAttributes || magic == kForestMagicMoves) &&
      in.value(bits) && in.value(forest.grid.origin) && in.value(forest.grid.step) &&
      in.array(forest.levelBegin) && in.array(forest.positions) && in.array(forest.baseTriangles) &&
      in.array(forest.baseFeatures) && in.array(forest.triangles) && in.array(forest.parents) &&
      in.array(forest.ringBegin) && in.array(forest.rings) && in.array(forest.cuts) &&
      in.array(forest.features) && in.array(forest.bounds) &&
      (magic == kForestMagic || (in.array(forest.seams) && in.array(forest.attributes.colors) &&
                                 in.array(forest.attributes.normals))) &&
      (magic != kForestMagicMoves || (in.array(forest.moves.by) && !forest.moves.by.empty())) &&
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
  forest.deriveMoves();
  if (!standsOnGrid(forest)) {
    return fail(
        ErrorCode::kCorrupt,
        "forest section is damaged (a vertex moves off the grid): prepare the model again");
  }
  return forest;
}

}  // namespace limn
