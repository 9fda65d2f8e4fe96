// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/primitives.h"

#include "shared/core/rng.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace limn::primitives {
namespace {

constexpr double kPi = std::numbers::pi;

// Puts real positions on a 14-bit grid, as preparation does.
TriangleMesh onGrid(const std::vector<glm::dvec3>& points, std::vector<glm::uvec3> triangles) {
  glm::dvec3 low = points[0];
  glm::dvec3 high = points[0];
  for (const glm::dvec3& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec3 side = high - low;
  TriangleMesh mesh;
  mesh.grid.origin = low;
  mesh.grid.bits = 14;
  mesh.grid.step = std::max({side.x, side.y, side.z}) / ((1 << 14) - 1);
  mesh.positions.reserve(points.size());
  for (const glm::dvec3& p : points) {
    mesh.positions.emplace_back(glm::round(mesh.grid.fromModel(p)));
  }
  mesh.triangles = std::move(triangles);
  return mesh;
}

// A grid of quads that wraps in both directions, two triangles each.
std::vector<glm::uvec3> wrappedQuads(int rings, int sides) {
  std::vector<glm::uvec3> triangles;
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < sides; ++j) {
      const int i1 = (i + 1) % rings;
      const int j1 = (j + 1) % sides;
      const auto at = [&](int a, int b) { return static_cast<std::uint32_t>(a * sides + b); };
      triangles.emplace_back(at(i, j), at(i1, j), at(i1, j1));
      triangles.emplace_back(at(i, j), at(i1, j1), at(i, j1));
    }
  }
  return triangles;
}

std::pair<std::vector<glm::dvec3>, std::vector<glm::uvec3>> unitIcosphere(int subdivisions) {
  const double t = (1.0 + std::sqrt(5.0)) / 2.0;
  std::vector<glm::dvec3> points = {
      {-1, t, 0},
      {1, t, 0},
      {-1, -t, 0},
      {1, -t, 0},
      {0, -1, t},
      {0, 1, t},
      {0, -1, -t},
      {0, 1, -t},
      {t, 0, -1},
      {t, 0, 1},
      {-t, 0, -1},
      {-t, 0, 1}};
  std::vector<glm::uvec3> triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                       {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                       {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                       {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int s = 0; s < subdivisions; ++s) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto key = std::minmax(a, b);
      const auto [entry, isNew] =
          middles.try_emplace(key, static_cast<std::uint32_t>(points.size()));
      if (isNew) points.push_back(0.5 * (points[a] + points[b]));
      return entry->second;
    };
    std::vector<glm::uvec3> finer;
    for (const glm::uvec3& f : triangles) {
      const std::uint32_t a = middle(f.x, f.y);
      const std::uint32_t b = middle(f.y, f.z);
      const std::uint32_t c = middle(f.z, f.x);
      finer.insert(finer.end(), {{f.x, a, c}, {f.y, b, a}, {f.z, c, b}, {a, b, c}});
    }
    triangles = std::move(finer);
  }
  for (glm::dvec3& p : points)
    p = glm::normalize(p);
  return {std::move(points), std::move(triangles)};
}

}  // namespace

TriangleMesh tetrahedron() {
  return onGrid(
      {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}},
      {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
}

TriangleMesh cube() {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 8; ++i)
    points.emplace_back(i & 1, (i >> 1) & 1, i >> 2);
  return onGrid(
      points,
      {{0, 2, 3},
       {0, 3, 1},
       {4, 5, 7},
       {4, 7, 6},
       {0, 1, 5},
       {0, 5, 4},
       {2, 6, 7},
       {2, 7, 3},
       {0, 4, 6},
       {0, 6, 2},
       {1, 3, 7},
       {1, 7, 5}});
}

TriangleMesh icosphere(int subdivisions) {
  auto [points, triangles] = unitIcosphere(subdivisions);
  return onGrid(points, std::move(triangles));
}

TriangleMesh bumpySphere(int subdivisions, std::uint64_t seed) {
  auto [points, triangles] = unitIcosphere(subdivisions);
  Rng rng(seed);
  std::vector<glm::dvec4> waves;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 frequency =
        24.0 * (glm::dvec3(rng.uniform(), rng.uniform(), rng.uniform()) - 0.5);
    waves.emplace_back(frequency, 2.0 * kPi * rng.uniform());
  }
  for (glm::dvec3& p : points) {
    double height = 1.0;
    for (const glm::dvec4& w : waves)
      height += 0.03 * std::sin(glm::dot(glm::dvec3(w), p) + w.w);
    p *= height;
  }
  return onGrid(points, std::move(triangles));
}

TriangleMesh torus(int rings, int sides) {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < rings; ++i) {
    const double u = 2.0 * kPi * i / rings;
    for (int j = 0; j < sides; ++j) {
      const double v = 2.0 * kPi * j / sides;
      const double r = 1.0 + 0.4 * std::cos(v);
      points.emplace_back(r * std::cos(u), r * std::sin(u), 0.4 * std::sin(v));
    }
  }
  return onGrid(points, wrappedQuads(rings, sides));
}

TriangleMesh torusKnot(int p, int q, int segments, int sides) {
  const auto curve = [&](double t) {
    const double r = 2.0 + std::cos(q * t);
    return glm::dvec3(r * std::cos(p * t), r * std::sin(p * t), std::sin(q * t));
  };
  std::vector<glm::dvec3> points;
  for (int i = 0; i < segments; ++i) {
    const double t = 2.0 * kPi * i / segments;
    const glm::dvec3 center = curve(t);
    const glm::dvec3 tangent = glm::normalize(curve(t + 1e-4) - curve(t - 1e-4));
    // A frame that closes up: relative to the curve's mean position, not a transported one.
    const glm::dvec3 side = glm::normalize(glm::cross(tangent, center));
    const glm::dvec3 out = glm::cross(side, tangent);
    for (int j = 0; j < sides; ++j) {
      const double a = 2.0 * kPi * j / sides;
      points.push_back(center + 0.35 * (std::cos(a) * out - std::sin(a) * side));
    }
  }
  return onGrid(points, wrappedQuads(segments, sides));
}

TriangleMesh openGrid(int columns, int rows) {
  std::vector<glm::dvec3> points;
  std::vector<glm::uvec3> triangles;
  const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * (columns + 1) + x); };
  for (int y = 0; y <= rows; ++y) {
    for (int x = 0; x <= columns; ++x) {
      const double u = static_cast<double>(x) / columns;
      const double v = static_cast<double>(y) / rows;
      points.emplace_back(u, v, 0.1 * std::sin(7.0 * u) * std::cos(5.0 * v));
    }
  }
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      triangles.emplace_back(at(x, y), at(x + 1, y), at(x + 1, y + 1));
      triangles.emplace_back(at(x, y), at(x + 1, y + 1), at(x, y + 1));
    }
  }
  return onGrid(points, std::move(triangles));
}

}  // namespace limn::primitives
