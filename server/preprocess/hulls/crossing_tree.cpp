// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/hulls/crossing_tree.h"

#include <algorithm>
#include <array>
#include <bit>

namespace limn {
namespace {

/// Spreads 20 bits to every third place.
std::uint64_t spread(std::uint64_t v) {
  v &= 0xFFFFF;
  v = (v | v << 32) & 0x1F00000000FFFFULL;
  v = (v | v << 16) & 0x1F0000FF0000FFULL;
  v = (v | v << 8) & 0x100F00F00F00F00FULL;
  v = (v | v << 4) & 0x10C30C30C30C30C3ULL;
  v = (v | v << 2) & 0x1249249249249249ULL;
  return v;
}

/// Neighbours in space are mostly neighbours along the Morton curve: a tree over it needs no other
/// construction.
std::uint64_t mortonCode(const glm::ivec3& p, const glm::ivec3& low, int shift) {
  const glm::i64vec3 d = glm::i64vec3(p) - glm::i64vec3(low);
  return spread(static_cast<std::uint64_t>(d.x) >> shift) |
         spread(static_cast<std::uint64_t>(d.y) >> shift) << 1 |
         spread(static_cast<std::uint64_t>(d.z) >> shift) << 2;
}

}  // namespace

GridBox boxOf(const HullMesh& mesh, FaceId f) {
  GridBox box;
  for (std::uint32_t k = 0; k < 3; ++k)
    box.add(mesh.corner(f, k));
  return box;
}

void CrossingTree::build(const HullMesh& mesh) {
  const std::uint32_t total = mesh.links().faceCount();
  GridBox all;
  faceOfLeaf_.clear();
  for (FaceId f = 0; f < total; ++f) {
    if (!mesh.isAlive(f)) continue;
    faceOfLeaf_.push_back(f);
    all.add(boxOf(mesh, f));
  }
  faces_ = static_cast<std::uint32_t>(faceOfLeaf_.size());
  const glm::i64vec3 size = glm::i64vec3(all.high) - glm::i64vec3(all.low);
  const int bits = std::bit_width(static_cast<std::uint64_t>(std::max({size.x, size.y, size.z})));
  const int shift = std::max(0, bits - 20);
  std::vector<std::pair<std::uint64_t, FaceId>> order;
  order.reserve(faces_);
  for (const FaceId f : faceOfLeaf_) {
    const GridBox box = boxOf(mesh, f);
    order.emplace_back(mortonCode(box.low + (box.high - box.low) / 2, all.low, shift), f);
  }
  std::sort(order.begin(), order.end());
  leaves_ = std::bit_ceil(std::max(1U, faces_));
  boxes_.assign(2 * std::size_t{leaves_}, GridBox{});
  leafOfFace_.assign(total, 0);
  for (std::uint32_t i = 0; i < faces_; ++i) {
    const FaceId f = order[i].second;
    faceOfLeaf_[i] = f;
    leafOfFace_[f] = leaves_ + i;
    boxes_[leaves_ + i] = boxOf(mesh, f);
  }
  for (std::uint32_t i = leaves_; i-- > 1;) {
    boxes_[i] = boxes_[2 * i];
    boxes_[i].add(boxes_[2 * i + 1]);
  }
}

void CrossingTree::update(const HullMesh& mesh, FaceId f) {
  const GridBox box = boxOf(mesh, f);
  std::uint32_t node = leafOfFace_[f];
  boxes_[node] = box;
  for (node /= 2; node >= 1 && !boxes_[node].contains(box); node /= 2)
    boxes_[node].add(box);
}

void CrossingTree::maintain(const HullMesh& mesh) {
  if (mesh.aliveFaces() < faces_ / 2) build(mesh);
}

void CrossingTree::find(const GridBox& box, std::vector<FaceId>& out) const {
  out.clear();
  // One node a level waits at most.
  std::array<std::uint32_t, 40> stack{};
  std::size_t depth = 0;
  stack[depth++] = 1;
  while (depth > 0) {
    const std::uint32_t node = stack[--depth];
    if (!boxes_[node].meets(box)) continue;
    if (node >= leaves_) {
      out.push_back(faceOfLeaf_[node - leaves_]);
      continue;
    }
    stack[depth++] = 2 * node + 1;
    stack[depth++] = 2 * node;
  }
}

}  // namespace limn
