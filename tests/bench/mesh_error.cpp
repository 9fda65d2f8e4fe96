// SPDX-License-Identifier: GPL-3.0-or-later
//
// Based on: P. Cignoni, C. Rocchini, R. Scopigno, "Metro: measuring error on simplified surfaces",
// Computer Graphics Forum 1998.
#include "tests/bench/mesh_error.h"

#include "shared/core/rng.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cmath>

namespace limn::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangle = Kernel::Triangle_3;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, std::vector<Triangle>::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 toCgal(const glm::dvec3& p) {
  return {p.x, p.y, p.z};
}

std::vector<Triangle> trianglesOf(const PlainMesh& mesh) {
  std::vector<Triangle> triangles;
  for (const glm::uvec3& t : mesh.triangles) {
    triangles.emplace_back(
        toCgal(mesh.positions[t.x]),
        toCgal(mesh.positions[t.y]),
        toCgal(mesh.positions[t.z]));
  }
  return triangles;
}

class Sampler {
 public:
  explicit Sampler(const PlainMesh& mesh) : mesh_(&mesh) {
    double sum = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3& a = mesh.positions[t.x];
      sum += glm::length(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a));
      areas_.push_back(sum);
    }
  }

  glm::dvec3 sample(Rng& rng) const {
    const auto at = std::upper_bound(areas_.begin(), areas_.end(), rng.uniform() * areas_.back());
    const auto index =
        std::min<std::size_t>(static_cast<std::size_t>(at - areas_.begin()), areas_.size() - 1);
    const glm::uvec3& t = mesh_->triangles[index];
    double u = rng.uniform();
    double v = rng.uniform();
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    const glm::dvec3& a = mesh_->positions[t.x];
    return a + u * (mesh_->positions[t.y] - a) + v * (mesh_->positions[t.z] - a);
  }

 private:
  const PlainMesh* mesh_;
  std::vector<double> areas_;  // running sum of twice the areas
};

struct Sums {
  double first = 0.0;
  double squares = 0.0;
  double largest2 = 0.0;
};

void measure(const PlainMesh& from, const Tree& to, std::uint32_t samples, Sums& sums) {
  Rng rng(1);
  const Sampler sampler(from);
  for (std::uint32_t i = 0; i < samples; ++i) {
    const double d2 = to.squared_distance(toCgal(sampler.sample(rng)));
    sums.first += std::sqrt(d2);
    sums.squares += d2;
    sums.largest2 = std::max(sums.largest2, d2);
  }
  const auto stride = static_cast<std::uint32_t>(from.triangles.size() / samples + 1);
  for (std::size_t f = 0; f < from.triangles.size(); f += stride) {
    sums.largest2 =
        std::max(sums.largest2, to.squared_distance(toCgal(from.positions[from.triangles[f].x])));
  }
}

}  // namespace

SurfaceError surfaceError(const PlainMesh& one, const PlainMesh& other, std::uint32_t samples) {
  const std::vector<Triangle> facesOne = trianglesOf(one);
  const std::vector<Triangle> facesOther = trianglesOf(other);
  Tree treeOne(facesOne.begin(), facesOne.end());
  Tree treeOther(facesOther.begin(), facesOther.end());
  treeOne.accelerate_distance_queries();
  treeOther.accelerate_distance_queries();
  Sums sums;
  measure(one, treeOther, samples, sums);
  measure(other, treeOne, samples, sums);
  return {
      sums.first / (2.0 * samples),
      std::sqrt(sums.squares / (2.0 * samples)),
      std::sqrt(sums.largest2)};
}

double volume(const PlainMesh& mesh) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    sum += glm::dot(mesh.positions[t.x], glm::cross(mesh.positions[t.y], mesh.positions[t.z]));
  }
  return sum / 6.0;
}

double diagonal(const PlainMesh& mesh) {
  glm::dvec3 low(1e300);
  glm::dvec3 high(-1e300);
  for (const glm::uvec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      low = glm::min(low, mesh.positions[t[k]]);
      high = glm::max(high, mesh.positions[t[k]]);
    }
  }
  return glm::length(high - low);
}

}  // namespace limn::bench
