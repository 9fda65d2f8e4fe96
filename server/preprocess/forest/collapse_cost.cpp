// SPDX-License-Identifier: Apache-2.0
//
// Based on:
//   M. Garland, P. Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997;
//   P. Lindstrom, G. Turk, "Fast and memory efficient polygonal simplification", Visualization
//   1998; papers/002, section 3.1: FC = λ·F_vol·d + (1 − λ)·L²·F_bound, λ = ½.
// Ours: the kept vertex does not move (subset placement), so a cost is evaluated at its place;
// creases and seams count as borders; a small length term decides between collapses that cost
// nothing, in favour of well-shaped triangles.
#include "server/preprocess/forest/collapse_cost.h"

#include "server/preprocess/forest/view_sphere.h"

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

// The forms of the squared distances that memoryless quadrics measure [Lindstrom98]: all planes go
// through v.
void addPlanes(const CollapseMesh& mesh, HalfEdgeId h, const glm::dvec3& areaNormal, Form& form) {
  const double length = glm::length(areaNormal);
  if (length == 0.0) return;
  form.add(areaNormal, 1.0 / (6.0 * length));
  for (const HalfEdgeId edge : {h, HalfEdgeMesh::prev(h)}) {
    if (!isLine(mesh, edge)) continue;
    const glm::dvec3 along = glm::dvec3(mesh.positions()[mesh.mesh().target(edge)]) -
                             glm::dvec3(mesh.positions()[mesh.mesh().origin(edge)]);
    const glm::dvec3 across = glm::cross(along, areaNormal);
    form.add(across, kFeatureWeight * glm::dot(along, along) / glm::dot(across, across));
  }
}

// The squared areas that v's border and crease edges sweep when v moves [Lindstrom98, equation 7]:
// |e × d|²/4.
void addSweptAreas(const CollapseMesh& mesh, HalfEdgeId h, Form& form) {
  for (const HalfEdgeId edge : {h, HalfEdgeMesh::prev(h)}) {
    if (!isLine(mesh, edge)) continue;
    const glm::dvec3 e = glm::dvec3(mesh.positions()[mesh.mesh().target(edge)]) -
                         glm::dvec3(mesh.positions()[mesh.mesh().origin(edge)]);
    form.add({1.0, 0.0, 0.0}, 0.25 * glm::dot(e, e));
    form.add({0.0, 1.0, 0.0}, 0.25 * glm::dot(e, e));
    form.add({0.0, 0.0, 1.0}, 0.25 * glm::dot(e, e));
    form.add(e, -0.25);
  }
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

void Form::add(const glm::dvec3& n, double weight) {
  xx += weight * n.x * n.x;
  xy += weight * n.x * n.y;
  xz += weight * n.x * n.z;
  yy += weight * n.y * n.y;
  yz += weight * n.y * n.z;
  zz += weight * n.z * n.z;
}

double Form::at(const glm::dvec3& d) const {
  return d.x * (xx * d.x + 2.0 * (xy * d.y + xz * d.z)) + d.y * (yy * d.y + 2.0 * yz * d.z) +
         zz * d.z * d.z;
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

VertexCost CostModel::around(const CollapseMesh& mesh, std::uint32_t v) const {
  VertexCost result;
  result.vertex = v;
  thread_local std::vector<glm::vec3> normals;
  normals.clear();
  mesh.forEachFace(v, [&](HalfEdgeId h, std::uint32_t a, std::uint32_t b) {
    const glm::dvec3 normal = mesh.areaNormal(v, a, b);
    normals.emplace_back(normal);
    ++result.degree;
    if (kind_ == CollapseCost::kMemoryless) addPlanes(mesh, h, normal, result.surface);
    if (kind_ == CollapseCost::kVolume) {
      // The volume that the face sweeps is a third of its height's way times its area.
      result.surface.add(normal, 1.0 / 36.0);
      addSweptAreas(mesh, h, result.lines);
    }
  });
  result.weight = kFlatWeight + silhouetteCells(normals) / static_cast<double>(kViewCells);
  return result;
}

double CostModel::cost(const CollapseMesh& mesh, const VertexCost& v, std::uint32_t u) const {
  const glm::dvec3 target(mesh.positions()[u]);
  const glm::dvec3 move = target - glm::dvec3(mesh.positions()[v.vertex]);
  const double length2 = glm::dot(move, move);
  const double shape = kLengthWeight * length2 * length2;  // area · distance² units
  switch (kind_) {
    case CollapseCost::kVolume: {
      double degree = v.degree;
      mesh.forEachFace(u, [&](HalfEdgeId, std::uint32_t, std::uint32_t) { ++degree; });
      return v.weight *
             (kLambda * v.surface.at(move) * degree + (1.0 - kLambda) * length2 * v.lines.at(move) +
              kVolumeLengthWeight * length2 * length2 * length2);
    }
    case CollapseCost::kMemoryless:
      return v.weight * (v.surface.at(move) + shape);
    case CollapseCost::kQuadric:
      break;
  }
  const double error = quadrics_[v.vertex].at(target) + quadrics_[u].at(target);
  return v.weight * (std::max(0.0, error) + shape);
}

void CostModel::collapsed(const HalfEdgeCollapse& collapse) {
  if (kind_ == CollapseCost::kQuadric) quadrics_[collapse.kept] += quadrics_[collapse.removed];
}

}  // namespace limn
