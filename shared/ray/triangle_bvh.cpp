// SPDX-License-Identifier: Apache-2.0
// Based on: I. Kamel, C. Faloutsos, "On Packing R-trees", CIKM 1993 (leaves filled along a Hilbert
// curve); J. Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707, 2004; S. Woop,
// C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.
// Deviations: nodes are eight wide and tested together; boxes are floats, widened by more than
// their test may round; triangles are tested in double. As in Woop et al. each edge is evaluated
// alike from both of its sides, as long as no product is fused into a sum.
#include "shared/ray/triangle_bvh.h"

#include "shared/mesh/closest_point.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace limn {
namespace {

constexpr int kCurveBits = 10;  // an axis

/// Place of a cell along the Hilbert curve of 2^kCurveBits cells an axis.
std::uint32_t hilbertIndex(glm::uvec3 cell) {
  constexpr std::uint32_t kTop = 1U << (kCurveBits - 1);
  for (std::uint32_t q = kTop; q > 1; q >>= 1U) {
    const std::uint32_t p = q - 1;
    for (int axis = 0; axis < 3; ++axis) {
      if ((cell[axis] & q) != 0) {
        cell.x ^= p;
      } else {
        const std::uint32_t t = (cell.x ^ cell[axis]) & p;
        cell.x ^= t;
        cell[axis] ^= t;
      }
    }
  }
  cell.y ^= cell.x;
  cell.z ^= cell.y;
  std::uint32_t t = 0;
  for (std::uint32_t q = kTop; q > 1; q >>= 1U) {
    if ((cell.z & q) != 0) t ^= q - 1;
  }
  cell ^= glm::uvec3(t);
  std::uint32_t index = 0;
  for (int bit = kCurveBits - 1; bit >= 0; --bit) {
    for (int axis = 0; axis < 3; ++axis)
      index = (index << 1U) | ((cell[axis] >> static_cast<std::uint32_t>(bit)) & 1U);
  }
  return index;
}

struct Keyed {
  std::uint32_t key;
  FaceId face;
};

/// Stable, so that the order depends on nothing but the mesh.
void radixSort(std::vector<Keyed>& items) {
  constexpr std::uint32_t kDigits = 1U << kCurveBits;
  std::vector<Keyed> other(items.size());
  for (std::uint32_t shift = 0; shift < 3 * kCurveBits; shift += kCurveBits) {
    std::array<std::uint32_t, kDigits> places{};
    for (const Keyed& item : items)
      ++places[(item.key >> shift) & (kDigits - 1)];
    std::uint32_t sum = 0;
    for (std::uint32_t& place : places)
      sum += std::exchange(place, sum);
    for (const Keyed& item : items)
      other[places[(item.key >> shift) & (kDigits - 1)]++] = item;
    items.swap(other);
  }
}

/// Where the ray's line meets the triangle's inside or rim; nothing when it does not, or when the
/// triangle is seen edge on.
struct Meeting {
  bool met = false;
  bool front = false;
  double t = 0.0;
};

/// A ray prepared for many triangles: the one axis that it mostly follows becomes depth, and space
/// is sheared so that the ray becomes that axis.
class ShearedRay {
 public:
  explicit ShearedRay(const Ray& ray) : ray_(&ray) {
    const glm::dvec3 size = glm::abs(ray.direction);
    z_ = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    x_ = (z_ + 1) % 3;
    y_ = (z_ + 2) % 3;
    shear_ = glm::dvec2(ray.direction[x_], ray.direction[y_]) / ray.direction[z_];
  }

  [[nodiscard]] Meeting meet(const std::array<glm::vec3, 3>& corners) const {
    const glm::dvec2 a = flat(corners[0]);
    const glm::dvec2 b = flat(corners[1]);
    const glm::dvec2 c = flat(corners[2]);
    const double u = b.x * c.y - b.y * c.x;
    const double v = c.x * a.y - c.y * a.x;
    const double w = a.x * b.y - a.y * b.x;
    const bool isInside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    if (!isInside) return {};
    const glm::dvec3 n =
        glm::cross(glm::dvec3(corners[1] - corners[0]), glm::dvec3(corners[2] - corners[0]));
    const double along = glm::dot(n, ray_->direction);
    if (along == 0.0) return {};
    return {true, along < 0.0, glm::dot(n, glm::dvec3(corners[0]) - ray_->origin) / along};
  }

 private:
  [[nodiscard]] glm::dvec2 flat(const glm::vec3& corner) const {
    const glm::dvec3 p = glm::dvec3(corner) - ray_->origin;
    return {p[x_] - shear_.x * p[z_], p[y_] - shear_.y * p[z_]};
  }

  const Ray* ray_;
  int x_ = 0;
  int y_ = 1;
  int z_ = 2;
  glm::dvec2 shear_{0.0};
};

/// Four numbers at once, in whatever registers the machine has (an extension of gcc and clang).
using Lanes = float __attribute__((vector_size(16)));
constexpr std::uint32_t kLanes = 4;

Lanes load(const float* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

Lanes splat(float value) {
  return value - Lanes{};
}

bool contains(std::span<const FaceId> faces, FaceId face) {
  return std::find(faces.begin(), faces.end(), face) != faces.end();
}

}  // namespace

TriangleBvh::TriangleBvh(
    std::span<const glm::ivec3> positions,
    std::span<const glm::uvec3> triangles) {
  if (triangles.empty()) return;
  sortFaces(positions, triangles);
  glm::vec3 low = triangles_.front().corners[0];
  glm::vec3 high = low;
  for (const Triangle& triangle : triangles_) {
    for (const glm::vec3& p : triangle.corners) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }
  center_ = 0.5 * (glm::dvec3(low) + glm::dvec3(high));
  reach_ = 1.0 + 0.5 * glm::distance(glm::dvec3(low), glm::dvec3(high));
  // A box test rounds a few times, each by 2^-24 of distances and coordinates within the mesh.
  buildLevels(static_cast<float>(0x1p-20 * (reach_ + glm::length(center_))));
}

void TriangleBvh::sortFaces(
    std::span<const glm::ivec3> positions,
    std::span<const glm::uvec3> triangles) {
  glm::ivec3 low(std::numeric_limits<std::int32_t>::max());
  glm::ivec3 high(std::numeric_limits<std::int32_t>::min());
  const auto sumOf = [&](const glm::uvec3& t) {
    return positions[t.x] + positions[t.y] + positions[t.z];
  };
  for (const glm::uvec3& t : triangles) {
    const glm::ivec3 sum = sumOf(t);
    low = glm::min(low, sum);
    high = glm::max(high, sum);
  }
  const glm::ivec3 extent = high - low;
  const float scale = static_cast<float>((1 << kCurveBits) - 1) /
                      static_cast<float>(std::max({1, extent.x, extent.y, extent.z}));
  std::vector<Keyed> order(triangles.size());
  for (FaceId f = 0; f < triangles.size(); ++f) {
    const glm::uvec3 cell(glm::vec3(sumOf(triangles[f]) - low) * scale);
    order[f] = {hilbertIndex(cell), f};
  }
  radixSort(order);
  triangles_.reserve(order.size());
  for (const Keyed& item : order) {
    const glm::uvec3& t = triangles[item.face];
    triangles_.push_back(
        {{glm::vec3(positions[t.x]), glm::vec3(positions[t.y]), glm::vec3(positions[t.z])},
         item.face});
  }
}

void TriangleBvh::buildLevels(float padding) {
  const auto emptyNode = [] {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    Node node;
    for (int axis = 0; axis < 3; ++axis) {
      std::fill_n(node.low[axis], kWidth, kInfinity);
      std::fill_n(node.high[axis], kWidth, -kInfinity);
    }
    return node;
  };
  const auto ceilDivide = [](std::size_t a, std::size_t b) { return (a + b - 1) / b; };
  const std::size_t leaves = ceilDivide(triangles_.size(), kLeafFaces);
  levelBegin_.push_back(0);
  nodes_.assign(ceilDivide(leaves, kWidth), emptyNode());
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const std::size_t leaf = i / kLeafFaces;
    Node& node = nodes_[leaf / kWidth];
    const std::size_t child = leaf % kWidth;
    for (const glm::vec3& p : triangles_[i].corners) {
      for (int axis = 0; axis < 3; ++axis) {
        node.low[axis][child] = std::min(node.low[axis][child], p[axis] - padding);
        node.high[axis][child] = std::max(node.high[axis][child], p[axis] + padding);
      }
    }
  }
  while (nodes_.size() - levelBegin_.back() > 1) {
    const std::size_t begin = levelBegin_.back();
    const std::size_t count = nodes_.size() - begin;
    const std::size_t above = nodes_.size();
    levelBegin_.push_back(static_cast<std::uint32_t>(above));
    nodes_.resize(above + ceilDivide(count, kWidth), emptyNode());
    for (std::size_t i = 0; i < count; ++i) {
      const Node& from = nodes_[begin + i];
      Node& to = nodes_[above + i / kWidth];
      for (int axis = 0; axis < 3; ++axis) {
        to.low[axis][i % kWidth] = *std::min_element(from.low[axis], from.low[axis] + kWidth);
        to.high[axis][i % kWidth] = *std::max_element(from.high[axis], from.high[axis] + kWidth);
      }
    }
  }
}

double TriangleBvh::approach(const Ray& ray) const {
  const glm::dvec3 toCenter = center_ - ray.origin;
  const double length = glm::length(ray.direction);
  const double t = glm::dot(toCenter, ray.direction) / (length * length) - reach_ / length;
  return std::max(t, ray.begin);
}

/// onHit(hit, place in triangles_) says how far the ray still matters: its new end.
template <class OnHit>
void TriangleBvh::traverse(const Ray& ray, OnHit onHit) const {
  if (nodes_.empty()) return;
  // Floats are exact enough only about the mesh: boxes are met from where the ray comes near.
  const double start = approach(ray);
  const glm::vec3 origin(ray.origin + start * ray.direction);
  glm::vec3 inverse;
  std::array<bool, 3> isDown{};
  for (int axis = 0; axis < 3; ++axis) {
    // A direction of 0 becomes a very small one: 0 · ∞ is no number.
    const auto d = static_cast<float>(ray.direction[axis]);
    const float least = std::copysign(1e-30F, d);
    inverse[axis] = 1.0F / (std::abs(d) < 1e-30F ? least : d);
    isDown[axis] = inverse[axis] < 0.0F;
  }
  const ShearedRay sheared(ray);
  double end = ray.end;
  const auto begin = static_cast<float>(ray.begin - start);

  struct Place {
    std::uint32_t level;
    std::uint32_t node;  // within its level
  };

  std::array<Place, 96> stack;  // 7 siblings wait a level, and 2^32 faces make 10 levels
  std::uint32_t size = 0;
  stack[size++] = {static_cast<std::uint32_t>(levelBegin_.size()) - 1, 0};
  while (size > 0) {
    const Place place = stack[--size];
    const Node& node = nodes_[levelBegin_[place.level] + place.node];
    std::array<bool, kWidth> isMet;
    for (std::uint32_t first = 0; first < kWidth; first += kLanes) {
      Lanes enter = splat(begin);
      Lanes leave = splat(static_cast<float>(end - start));
      for (int axis = 0; axis < 3; ++axis) {
        const float* nearSide = isDown[axis] ? node.high[axis] : node.low[axis];
        const float* farSide = isDown[axis] ? node.low[axis] : node.high[axis];
        const Lanes in = (load(nearSide + first) - origin[axis]) * inverse[axis];
        const Lanes out = (load(farSide + first) - origin[axis]) * inverse[axis];
        enter = in > enter ? in : enter;
        leave = out < leave ? out : leave;
      }
      const auto met = enter <= leave;
      for (std::uint32_t k = 0; k < kLanes; ++k)
        isMet[first + k] = met[k] != 0;
    }
    for (std::uint32_t k = 0; k < kWidth; ++k) {
      if (!isMet[k]) continue;
      const std::uint32_t child = place.node * kWidth + k;
      if (place.level > 0) {
        stack[size++] = {place.level - 1, child};
        continue;
      }
      const std::size_t first = std::size_t{child} * kLeafFaces;
      const std::size_t past = std::min(first + kLeafFaces, triangles_.size());
      for (std::size_t i = first; i < past; ++i) {
        const Meeting meeting = sheared.meet(triangles_[i].corners);
        if (!meeting.met || !(meeting.t > ray.begin) || meeting.t > end) continue;
        end = std::min(end, onHit({triangles_[i].face, meeting.t, meeting.front}, i));
        if (end <= ray.begin) return;
      }
    }
  }
}

std::uint32_t TriangleBvh::findBlocker(
    const Ray& ray,
    std::span<const FaceId> except,
    std::uint32_t guess) const {
  if (guess < triangles_.size() && !contains(except, triangles_[guess].face)) {
    const Meeting meeting = ShearedRay(ray).meet(triangles_[guess].corners);
    if (meeting.met && meeting.t > ray.begin && meeting.t < ray.end) return guess;
  }
  std::uint32_t blocker = kNone;
  traverse(ray, [&](const RayHit& hit, std::size_t place) {
    if (hit.t >= ray.end || contains(except, hit.face)) return ray.end;
    blocker = static_cast<std::uint32_t>(place);
    return ray.begin;
  });
  return blocker;
}

std::optional<RayHit> TriangleBvh::firstHit(const Ray& ray, std::span<const FaceId> except) const {
  RayHit first{kNone, ray.end, false};
  traverse(ray, [&](const RayHit& hit, std::size_t) {
    const bool isNearer = hit.t < first.t || (hit.t == first.t && hit.face < first.face);
    if (hit.t < ray.end && isNearer && !contains(except, hit.face)) first = hit;
    return first.t;
  });
  if (first.face == kNone) return std::nullopt;
  return first;
}

std::vector<RayHit> TriangleBvh::allHits(const Ray& ray) const {
  std::vector<RayHit> hits;
  traverse(ray, [&](const RayHit& hit, std::size_t) {
    if (hit.t < ray.end) hits.push_back(hit);
    return ray.end;
  });
  return hits;
}

std::optional<NearestPoint> TriangleBvh::closest(const glm::dvec3& point) const {
  if (nodes_.empty()) return std::nullopt;

  struct Place {
    double distance2;  // to its box, at least
    std::uint32_t level;
    std::uint32_t node;
  };

  NearestPoint nearest;
  double best = std::numeric_limits<double>::infinity();
  std::array<Place, 96> stack;  // as in traverse()
  std::uint32_t size = 0;
  stack[size++] = {0.0, static_cast<std::uint32_t>(levelBegin_.size()) - 1, 0};
  while (size > 0) {
    const Place place = stack[--size];
    if (place.distance2 >= best) continue;
    const Node& node = nodes_[levelBegin_[place.level] + place.node];
    const std::uint32_t first = size;
    for (std::uint32_t k = 0; k < kWidth; ++k) {
      if (node.low[0][k] > node.high[0][k]) continue;  // no child
      double distance2 = 0.0;
      for (int axis = 0; axis < 3; ++axis) {
        const double low = node.low[axis][k];
        const double high = node.high[axis][k];
        const double off = std::max({low - point[axis], point[axis] - high, 0.0});
        distance2 += off * off;
      }
      if (distance2 >= best) continue;
      const std::uint32_t child = place.node * kWidth + k;
      if (place.level > 0) {
        stack[size++] = {distance2, place.level - 1, child};
        continue;
      }
      const std::size_t begin = std::size_t{child} * kLeafFaces;
      const std::size_t past = std::min(begin + kLeafFaces, triangles_.size());
      for (std::size_t i = begin; i < past; ++i) {
        const auto& [a, b, c] = triangles_[i].corners;
        const glm::dvec3 on = closestPointOnTriangle(point, a, b, c);
        const glm::dvec3 away = on - point;
        const double d = glm::dot(away, away);
        if (d >= best) continue;
        best = d;
        nearest = {triangles_[i].face, on};
      }
    }
    // The nearest box last, to be looked into next.
    std::sort(stack.begin() + first, stack.begin() + size, [](const Place& a, const Place& b) {
      return a.distance2 > b.distance2;
    });
  }
  return nearest;
}

std::size_t TriangleBvh::memoryBytes() const {
  return triangles_.capacity() * sizeof(Triangle) + nodes_.capacity() * sizeof(Node) +
         levelBegin_.capacity() * sizeof(std::uint32_t);
}

}  // namespace limn
