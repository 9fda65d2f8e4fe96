// SPDX-License-Identifier: Apache-2.0
//
// Based on: P. Sander, X. Gu, S. Gortler, H. Hoppe, J. Snyder, "Silhouette clipping", SIGGRAPH
// 2000, section 4. Rays are cast with our own tree (shared/ray), in doubles from integer corners,
// so the map does not depend on the machine; texels around a tile are shot like its own.
#include "server/preprocess/maps/hull_maps.h"

#include "server/preprocess/maps/corner_normals.h"

#include "shared/progressive/map_normal.h"
#include "shared/ray/triangle_bvh.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <thread>

namespace limn {
namespace {

using Triangle = std::array<glm::dvec3, 3>;

/// Barycentric coordinates of a point in the plane of a triangle, clamped to it.
glm::dvec3 barycentric(const Triangle& t, const glm::dvec3& p) {
  const glm::dvec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double area = glm::dot(n, n);
  if (!(area > 0.0)) return glm::dvec3(1.0 / 3.0);
  glm::dvec3 b(
      glm::dot(n, glm::cross(t[2] - t[1], p - t[1])),
      glm::dot(n, glm::cross(t[0] - t[2], p - t[2])),
      glm::dot(n, glm::cross(t[1] - t[0], p - t[0])));
  b = glm::max(b / area, glm::dvec3(0.0));
  return b / (b.x + b.y + b.z);
}

/// What a texel sees.
struct Shot {
  glm::dvec3 normal{0.0, 0.0, 1.0};
  glm::dvec3 color{0.0};  // sRGB, 0 to 255; zero where the mesh has none
};

class Shooter {
 public:
  Shooter(const TriangleMesh& mesh, const TriangleMesh& hull, const MapOptions& options)
      : mesh_(mesh),
        tree_(mesh.positions, mesh.triangles),
        normals_(cornerNormals(mesh, options.creaseAngleDegrees)),
        hull_(hull),
        scale_(hull.grid.step / mesh.grid.step),
        // All of the hull's normals count alike: its faces are few and meet at any angle.
        hullNormals_(cornerNormals(hull, 180.0)) {
    glm::dvec3 low(0.0);
    glm::dvec3 high(0.0);
    for (const glm::ivec3& p : hull.positions) {
      low = glm::min(low, scale_ * glm::dvec3(p));
      high = glm::max(high, scale_ * glm::dvec3(p));
    }
    // The hull may touch the surface: a ray begins a little outside.
    lift_ = 1e-4 * glm::length(high - low) + 1.0;
  }

  [[nodiscard]] bool hasColors() const { return !mesh_.attributes.colors.empty(); }

  /// The mesh as seen from barycentric coordinates of a hull face, which may lie outside of it a
  /// little. Adds to `misses` when nothing is hit.
  [[nodiscard]] Shot at(std::uint32_t face, const glm::dvec3& b, std::uint64_t& misses) const {
    glm::dvec3 place{0.0};
    glm::dvec3 normal{0.0};
    for (int k = 0; k < 3; ++k) {
      place += b[k] * scale_ * glm::dvec3(hull_.positions[hull_.triangles[face][k]]);
      normal += b[k] * glm::dvec3(hullNormals_[3 * face + static_cast<std::uint32_t>(k)]);
    }
    const double length = glm::length(normal);
    if (length > 0.0) {
      normal /= length;
      const Ray ray{place + lift_ * normal, -normal};
      if (const auto hit = tree_.firstHit(ray))
        return shotAt(hit->face, ray.origin + hit->t * ray.direction);
    }
    ++misses;
    const auto nearest = tree_.closest(place);
    return nearest ? shotAt(nearest->face, nearest->point) : Shot{};
  }

  [[nodiscard]] glm::dmat3 frameOf(std::uint32_t face) const {
    const glm::uvec3& t = hull_.triangles[face];
    return mapFrame(
        glm::dvec3(hull_.positions[t.x]),
        glm::dvec3(hull_.positions[t.y]),
        glm::dvec3(hull_.positions[t.z]));
  }

 private:
  [[nodiscard]] Shot shotAt(FaceId face, const glm::dvec3& point) const {
    Triangle t;
    for (int k = 0; k < 3; ++k)
      t[static_cast<std::size_t>(k)] = glm::dvec3(mesh_.positions[mesh_.triangles[face][k]]);
    const glm::dvec3 b = barycentric(t, point);
    glm::dvec3 normal{0.0};
    Shot shot;
    for (int k = 0; k < 3; ++k) {
      normal += b[k] * glm::dvec3(normals_[3 * face + static_cast<std::uint32_t>(k)]);
      if (hasColors())
        shot.color += b[k] * glm::dvec3(mesh_.attributes.colors[mesh_.triangles[face][k]]);
    }
    const double length = glm::length(normal);
    shot.normal = length > 0.0 ? normal / length : glm::dvec3(normals_[3 * face]);
    return shot;
  }

  const TriangleMesh& mesh_;
  TriangleBvh tree_;
  std::vector<glm::vec3> normals_;  // 3 a face
  const TriangleMesh& hull_;
  double scale_;  // from the hull's grid to the mesh's
  std::vector<glm::vec3> hullNormals_;
  double lift_ = 1.0;
};

/// The cells of `layout` from first on, every `stride`-th.
std::uint64_t fillCells(const Shooter& shooter, HullMaps& map, int first, int stride) {
  const MapLayout& layout = map.layout;
  const int side = layout.cellSide();
  std::uint64_t misses = 0;
  for (int cell = first; cell < layout.cells(); cell += stride) {
    const glm::ivec2 corner = layout.cellOf(2 * static_cast<std::uint32_t>(cell));
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const bool isOdd = x + y > side - 1;
        const std::uint32_t face = 2 * static_cast<std::uint32_t>(cell) + (isOdd ? 1 : 0);
        if (face >= layout.faces) continue;
        const glm::dvec2 inTile = glm::dvec2(
            (isOdd ? side - 1 - x : x) - MapLayout::kPadding,
            (isOdd ? side - 1 - y : y) - MapLayout::kPadding);
        const glm::dvec2 uv = inTile / static_cast<double>(layout.leg - 1);
        const bool isInside = uv.x >= 0.0 && uv.y >= 0.0 && uv.x + uv.y <= 1.0;
        std::uint64_t missed = 0;
        const Shot shot = shooter.at(face, glm::dvec3(1.0 - uv.x - uv.y, uv.x, uv.y), missed);
        if (isInside) misses += missed;
        const std::size_t texel =
            static_cast<std::size_t>(corner.y + y) * static_cast<std::size_t>(layout.width()) +
            static_cast<std::size_t>(corner.x + x);
        const auto code = encodeMapNormal(shooter.frameOf(face), shot.normal);
        std::ranges::copy(code, map.normals.begin() + static_cast<std::ptrdiff_t>(2 * texel));
        if (!shooter.hasColors()) continue;
        for (int k = 0; k < 3; ++k) {
          map.colors[3 * texel + static_cast<std::size_t>(k)] =
              static_cast<std::uint8_t>(std::lround(shot.color[k] * kMapColorSteps / 255.0));
        }
      }
    }
  }
  return misses;
}

}  // namespace

HullMaps shootMaps(const TriangleMesh& mesh, const TriangleMesh& hull, const MapOptions& options) {
  HullMaps map;
  map.layout.faces = static_cast<std::uint32_t>(hull.triangles.size());
  // leg · (leg + 1) / 2 texels lie in a tile.
  map.layout.leg =
      std::max(2, static_cast<int>(std::lround(std::sqrt(2.0 * options.texelsPerFace) - 0.5)));
  const Shooter shooter(mesh, hull, options);
  const std::size_t texels =
      static_cast<std::size_t>(map.layout.width()) * static_cast<std::size_t>(map.layout.height());
  map.normals.assign(2 * texels, 64);
  if (shooter.hasColors()) map.colors.assign(3 * texels, 0);
  const int threads = static_cast<int>(
      options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency()));
  std::atomic<std::uint64_t> misses = 0;
  std::vector<std::thread> workers;
  for (int i = 1; i < threads; ++i)
    workers.emplace_back([&, i] { misses += fillCells(shooter, map, i, threads); });
  misses += fillCells(shooter, map, 0, threads);
  for (std::thread& worker : workers)
    worker.join();
  map.misses = misses;
  return map;
}

}  // namespace limn
