// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/seed_codec.h"

#include "shared/codec/varint.h"

#include <cmath>

namespace limn {
namespace {

// A direction only has to pick the right viewpoint: a ten-thousandth is plenty.
constexpr float kDirectionScale = 10000.0F;

std::uint32_t zigzag(std::int32_t value) {
  return (static_cast<std::uint32_t>(value) << 1) ^ static_cast<std::uint32_t>(value >> 31);
}

std::int32_t unzigzag(std::uint32_t value) {
  return static_cast<std::int32_t>(value >> 1) ^ -static_cast<std::int32_t>(value & 1);
}

tl::unexpected<Error> damaged() {
  return fail(ErrorCode::kCorrupt, "seeds are damaged");
}

}  // namespace

std::vector<std::uint8_t> encodeSeeds(const SeedTable& seeds) {
  std::vector<std::uint8_t> bytes;
  appendVarint(seeds.nodes.size(), bytes);
  VertexId expected = 0;
  for (std::uint32_t i = 0; i < seeds.nodes.size(); ++i) {
    const SeedTable::Node& node = seeds.nodes[i];
    appendVarint(node.vertex - expected, bytes);
    expected = node.vertex + 1;
    // 0: a base vertex; else how far back the parent stands.
    appendVarint(node.parent == kNone ? 0 : i - node.parent, bytes);
  }
  appendVarint(seeds.directions.size(), bytes);
  for (std::size_t d = 0; d < seeds.directions.size(); ++d) {
    for (int axis = 0; axis < 3; ++axis) {
      appendVarint(
          zigzag(
              static_cast<std::int32_t>(std::lround(seeds.directions[d][axis] * kDirectionScale))),
          bytes);
    }
    appendVarint(seeds.seedBegin[d + 1] - seeds.seedBegin[d], bytes);
    for (std::uint32_t s = seeds.seedBegin[d]; s < seeds.seedBegin[d + 1]; ++s) {
      appendVarint(seeds.seeds[s], bytes);
    }
  }
  return bytes;
}

Result<SeedTable> decodeSeeds(std::span<const std::uint8_t> bytes, std::uint32_t vertexCount) {
  VarintReader in(bytes);
  SeedTable seeds;
  const auto nodeCount = in.read();
  // Each node takes two bytes at least, each direction four: counts are bounded by the bytes.
  if (!nodeCount || *nodeCount > bytes.size() / 2) return damaged();
  seeds.nodes.reserve(*nodeCount);
  std::uint64_t expected = 0;
  for (std::uint32_t i = 0; i < *nodeCount; ++i) {
    const auto gap = in.read();
    const auto back = in.read();
    if (!gap || !back || expected + *gap >= vertexCount || *back > i) return damaged();
    seeds.nodes.push_back({static_cast<VertexId>(expected + *gap), *back == 0 ? kNone : i - *back});
    expected += *gap + 1;
  }
  const auto directionCount = in.read();
  if (!directionCount || *directionCount > bytes.size() / 4) return damaged();
  seeds.seedBegin.push_back(0);
  for (std::uint32_t d = 0; d < *directionCount; ++d) {
    glm::vec3 direction;
    for (int axis = 0; axis < 3; ++axis) {
      const auto value = in.read();
      if (!value) return damaged();
      direction[axis] = static_cast<float>(unzigzag(*value)) / kDirectionScale;
    }
    const float length = glm::length(direction);
    if (!(length > 0.5F && length < 2.0F)) return damaged();
    seeds.directions.push_back(direction / length);
    const auto count = in.read();
    if (!count || *count > bytes.size()) return damaged();
    for (std::uint32_t s = 0; s < *count; ++s) {
      const auto node = in.read();
      if (!node || *node >= *nodeCount) return damaged();
      seeds.seeds.push_back(*node);
    }
    seeds.seedBegin.push_back(static_cast<std::uint32_t>(seeds.seeds.size()));
  }
  if (!in.atEnd()) return damaged();
  return seeds;
}

}  // namespace limn
