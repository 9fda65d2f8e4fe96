// SPDX-License-Identifier: Apache-2.0
//
// Based on:
//   M. Garland, P. Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997;
//   P. Lindstrom, G. Turk, "Fast and memory efficient polygonal simplification", Visualization
//   1998; papers/002, section 3.1: FC = λ·F_vol·d + (1 − λ)·L²·F_bound, λ = ½.
// Ours: the kept vertex does not move (subset placement), so a cost is evaluated at its place;
// creases and seams count as borders; a small length term decides between collapses that cost
// nothing, in favour of well-shaped triangles.
#include "server/preprocess/collapse_cost.h"

#include "server/preprocess/view_sphere.h"

#include <bit>
#include <cmath>

namespace limn {
namespace {

constexpr double kLambda = 0.5;         // papers/002
constexpr double kFeatureWeight = 2.0;  // of a border or crease plane, against a face of that size
constexpr double kLengthWeight = 1e-3;  // of the tie-breaker: (1/30 of an edge)² of distance
constexpr double kFlatWeight = 0.1;     // of a region that no view sees as silhouette, against 1
constexpr double kVolumeLengthWeight = 3e-5;  // the same for volumes, which go with length³

// An edge that is drawn whatever the view, and has to stay where it is.
bool isLine(const CollapseMesh& mesh, HalfEdgeId edge) {
  return mesh.mesh().twin(edge) == kNone || mesh.features()[edge] != 0;
}

// The plane through a border or crease edge, perpendicular to the face beside it.
void addEdgePlane(const CollapseMesh& mesh, HalfEdgeId h, Quadric& quadric) {
  const std::uint32_t a = mesh.mesh().origin(h);
  const std::uint32_t b = mesh.mesh().target(h);
  const glm::dvec3 p(mesh.positions()[a]);
  const glm::dvec3 along = glm::dvec3(mesh.positions()[b]) - p;
  const glm::dvec3 across =
      glm::cross(along, mesh.areaNormal(a, b, mesh.mesh().origin(HalfEdgeMesh::prev(h))));
  const double length = glm::length(across);
  if (length > 0.0) quadric.addPlane(across / length, p, kFeatureWeight * glm::dot(along, along));
}

Quadric vertexQuadric(const CollapseMesh& mesh, std::uint32_t v) {
  Quadric quadric;
  mesh.forEachFace(v, [&](HalfEdgeId h, std::uint32_t a, std::uint32_t b) {
    const glm::dvec3 normal = mesh.areaNormal(v, a, b);
    const double length = glm::length(normal);
    if (length > 0.0)
      quadric.addPlane(normal / length, glm::dvec3(mesh.positions()[v]), length / 6.0);
    for (const HalfEdgeId edge : {h, HalfEdgeMesh::prev(h)}) {
      if (isLine(mesh, edge)) addEdgePlane(mesh, edge, quadric);
    }
  });
  return quadric;
}

double squaredLength(const CollapseMesh& mesh, std::uint32_t v, std::uint32_t u) {
  const glm::dvec3 d = glm::dvec3(mesh.positions()[u]) - glm::dvec3(mesh.positions()[v]);
  return glm::dot(d, d);
}

// Sum of the squared volumes that v's faces sweep when v goes to u, and of the squared areas that
// its border and crease edges sweep [Lindstrom98, equations 4 and 7]; all factors common to both
// dropped.
double volumeCost(const CollapseMesh& mesh, std::uint32_t v, std::uint32_t u) {
  const glm::dvec3 from(mesh.positions()[v]);
  const glm::dvec3 move = glm::dvec3(mesh.positions()[u]) - from;
  double volume = 0.0;
  double boundary = 0.0;
  double degree = 0.0;
  mesh.forEachFace(v, [&](HalfEdgeId h, std::uint32_t a, std::uint32_t b) {
    const double swept = glm::dot(mesh.areaNormal(v, a, b), move) / 6.0;
    volume += swept * swept;
    ++degree;
    for (const HalfEdgeId edge : {h, HalfEdgeMesh::prev(h)}) {
      if (!isLine(mesh, edge)) continue;
      const glm::dvec3 other(mesh.positions()[edge == h ? a : b]);
      const glm::dvec3 area = 0.5 * glm::cross(other - from, move);
      boundary += glm::dot(area, area);
    }
  });
  mesh.forEachFace(u, [&](HalfEdgeId, std::uint32_t, std::uint32_t) { ++degree; });
  const double length2 = glm::dot(move, move);
  return kLambda * volume * degree + (1.0 - kLambda) * length2 * boundary +
         kVolumeLengthWeight * length2 * length2 * length2;
}

}  // namespace

void Quadric::addPlane(const glm::dvec3& n, const glm::dvec3& point, double weight) {
  const double d = -glm::dot(n, point);
  xx += weight * n.x * n.x;
  xy += weight * n.x * n.y;
  xz += weight * n.x * n.z;
  yy += weight * n.y * n.y;
  yz += weight * n.y * n.z;
  zz += weight * n.z * n.z;
  x += weight * n.x * d;
  y += weight * n.y * d;
  z += weight * n.z * d;
  c += weight * d * d;
}

Quadric& Quadric::operator+=(const Quadric& o) {
  xx += o.xx;
  xy += o.xy;
  xz += o.xz;
  yy += o.yy;
  yz += o.yz;
  zz += o.zz;
  x += o.x;
  y += o.y;
  z += o.z;
  c += o.c;
  return *this;
}

double Quadric::at(const glm::dvec3& p) const {
  return p.x * (xx * p.x + 2.0 * (xy * p.y + xz * p.z + x)) +
         p.y * (yy * p.y + 2.0 * (yz * p.z + y)) + p.z * (zz * p.z + 2.0 * z) + c;
}

CostModel::CostModel(CollapseCost kind, const CollapseMesh& mesh) : kind_(kind) {
  if (kind_ != CollapseCost::kQuadric) return;
  quadrics_.resize(mesh.positions().size());
  for (std::uint32_t v = 0; v < quadrics_.size(); ++v)
    quadrics_[v] = vertexQuadric(mesh, v);
}

double CostModel::cost(const CollapseMesh& mesh, std::uint32_t v, std::uint32_t u) const {
  if (kind_ == CollapseCost::kVolume) return volumeCost(mesh, v, u);
  const glm::dvec3 target(mesh.positions()[u]);
  const double length2 = squaredLength(mesh, v, u);
  const double shape = kLengthWeight * length2 * length2;  // area · distance² units
  if (kind_ == CollapseCost::kMemoryless)
    return std::max(0.0, vertexQuadric(mesh, v).at(target)) + shape;
  return std::max(0.0, quadrics_[v].at(target) + quadrics_[u].at(target)) + shape;
}

void CostModel::collapsed(const HalfEdgeCollapse& collapse) {
  if (kind_ == CollapseCost::kQuadric) quadrics_[collapse.kept] += quadrics_[collapse.removed];
}

double silhouetteWeight(const CollapseMesh& mesh, std::uint32_t v) {
  std::uint64_t any = 0;
  std::uint64_t all = ~std::uint64_t{0};
  mesh.forEachFace(v, [&](HalfEdgeId, std::uint32_t a, std::uint32_t b) {
    const std::uint64_t cells = facingCells(mesh.areaNormal(v, a, b));
    any |= cells;
    all &= cells;
  });
  return kFlatWeight + std::popcount(any & ~all) / static_cast<double>(kViewCells);
}

}  // namespace limn
