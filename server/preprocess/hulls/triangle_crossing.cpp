// SPDX-License-Identifier: Apache-2.0
// Based on: P. Guigue, O. Devillers, "Fast and Robust Triangle-Triangle Overlap Test Using
// Orientation Predicates", 2003. We test edge against triangle, which needs a few more signs of
// determinants but covers touching and coplanar triangles in the same way; all signs are exact.
#include "server/preprocess/hulls/triangle_crossing.h"

#include "server/preprocess/hulls/hull_predicates.h"

#include <algorithm>
#include <cstdlib>

namespace limn::hull {
namespace {

struct Plane {
  glm::i64vec3 normal{0};
  glm::ivec3 point{0};

  [[nodiscard]] int side(const glm::ivec3& p) const {
    return sign(dotExact(normal, glm::i64vec3(p) - glm::i64vec3(point)));
  }

  [[nodiscard]] bool isDegenerate() const { return normal == glm::i64vec3(0); }

  /// The axis whose removal projects the plane best.
  [[nodiscard]] int dominantAxis() const {
    int axis = 0;
    for (int i = 1; i < 3; ++i) {
      if (std::abs(normal[i]) > std::abs(normal[axis])) axis = i;
    }
    return axis;
  }
};

Plane planeOf(const Triangle& t) {
  return {areaNormal(t[0], t[1], t[2]), t[0]};
}

/// Orientation of three points of a plane, seen along one axis.
int orient2(const glm::ivec3& a, const glm::ivec3& b, const glm::ivec3& c, int axis) {
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  const std::int64_t turn = (std::int64_t{b[u]} - a[u]) * (std::int64_t{c[v]} - a[v]) -
                            (std::int64_t{b[v]} - a[v]) * (std::int64_t{c[u]} - a[u]);
  return turn > 0 ? 1 : turn < 0 ? -1 : 0;
}

bool withinBox2(const glm::ivec3& a, const glm::ivec3& b, const glm::ivec3& p, int axis) {
  for (int k = 1; k <= 2; ++k) {
    const int i = (axis + k) % 3;
    if (p[i] < std::min(a[i], b[i]) || p[i] > std::max(a[i], b[i])) return false;
  }
  return true;
}

bool segmentsMeet2(
    const glm::ivec3& p,
    const glm::ivec3& q,
    const glm::ivec3& a,
    const glm::ivec3& b,
    int axis) {
  const int pa = orient2(a, b, p, axis);
  const int qa = orient2(a, b, q, axis);
  const int ap = orient2(p, q, a, axis);
  const int bp = orient2(p, q, b, axis);
  if (pa * qa < 0 && ap * bp < 0) return true;
  return (pa == 0 && withinBox2(a, b, p, axis)) || (qa == 0 && withinBox2(a, b, q, axis)) ||
         (ap == 0 && withinBox2(p, q, a, axis)) || (bp == 0 && withinBox2(p, q, b, axis));
}

bool segmentMeetsCoplanar(const glm::ivec3& p, const glm::ivec3& q, const Triangle& t, int axis) {
  const int first = orient2(t[0], t[1], p, axis);
  const int second = orient2(t[1], t[2], p, axis);
  const int third = orient2(t[2], t[0], p, axis);
  if (std::min({first, second, third}) >= 0 || std::max({first, second, third}) <= 0) return true;
  for (std::size_t k = 0; k < 3; ++k) {
    if (segmentsMeet2(p, q, t[k], t[(k + 1) % 3], axis)) return true;
  }
  return false;
}

/// plane: of t, not degenerate.
bool segmentMeets(const glm::ivec3& p, const glm::ivec3& q, const Triangle& t, const Plane& plane) {
  const int sp = plane.side(p);
  const int sq = plane.side(q);
  if (sp * sq > 0) return false;
  if (sp == 0 && sq == 0) return segmentMeetsCoplanar(p, q, t, plane.dominantAxis());
  const int first = sign(volume6(p, q, t[0], t[1]));
  const int second = sign(volume6(p, q, t[1], t[2]));
  const int third = sign(volume6(p, q, t[2], t[0]));
  return std::min({first, second, third}) >= 0 || std::max({first, second, third}) <= 0;
}

/// Whether all corners of t lie strictly on one side.
bool isBeside(const Triangle& t, const Plane& plane) {
  const int first = plane.side(t[0]);
  return first != 0 && plane.side(t[1]) == first && plane.side(t[2]) == first;
}

}  // namespace

bool trianglesMeet(const Triangle& s, const Triangle& t) {
  const Plane planeS = planeOf(s);
  const Plane planeT = planeOf(t);
  if (planeS.isDegenerate() || planeT.isDegenerate()) return false;
  if (isBeside(t, planeS) || isBeside(s, planeT)) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    if (segmentMeets(s[k], s[(k + 1) % 3], t, planeT) ||
        segmentMeets(t[k], t[(k + 1) % 3], s, planeS)) {
      return true;
    }
  }
  return false;
}

bool trianglesMeetBesidesCorner(const Triangle& s, const Triangle& t) {
  const Plane planeS = planeOf(s);
  const Plane planeT = planeOf(t);
  if (planeS.isDegenerate() || planeT.isDegenerate()) return false;
  return segmentMeets(s[1], s[2], t, planeT) || segmentMeets(t[1], t[2], s, planeS);
}

bool trianglesMeetBesidesEdge(const Triangle& s, const Triangle& t) {
  const Plane planeS = planeOf(s);
  const Plane planeT = planeOf(t);
  if (planeS.isDegenerate() || planeT.isDegenerate() || planeS.side(t[2]) != 0) return false;
  const int axis = planeS.dominantAxis();
  return orient2(s[0], s[1], s[2], axis) == orient2(s[0], s[1], t[2], axis);
}

bool facesMeet(
    const Corners& cornersS,
    const Triangle& s,
    const Corners& cornersT,
    const Triangle& t) {
  std::array<std::size_t, 3> partner{3, 3, 3};  // corner of t that is this corner of s
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (cornersS[i] != cornersT[j]) continue;
      partner[i] = j;
      ++shared;
    }
  }
  if (shared == 0) return trianglesMeet(s, t);
  if (shared == 3) return true;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    const std::size_t last = (i + 2) % 3;
    if (shared == 1 && partner[i] < 3) {
      const std::size_t j = partner[i];
      return trianglesMeetBesidesCorner(
          {s[i], s[next], s[last]},
          {t[j], t[(j + 1) % 3], t[(j + 2) % 3]});
    }
    if (shared == 2 && partner[i] == 3) {
      const std::size_t other = 3 - partner[next] - partner[last];
      return trianglesMeetBesidesEdge(
          {s[next], s[last], s[i]},
          {t[partner[next]], t[partner[last]], t[other]});
    }
  }
  return true;
}

}  // namespace limn::hull
