// SPDX-License-Identifier: Apache-2.0
//
// Based on:
//   M. Garland, P. Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997;
//   P. Lindstrom, G. Turk, "Fast and memory efficient polygonal simplification", Visualization
//   1998; papers/002, section 3.1: FC = λ·F_vol·d + (1 − λ)·L²·F_bound, λ = ½.
// Ours: the kept vertex does not move unless it is placed, so a cost is evaluated at its place;
// creases and seams count as borders; a small length term decides between collapses that cost
// nothing, in favour of well-shaped triangles.
#include "server/preprocess/forest/collapse_cost.h"

#include "server/preprocess/forest/view_sphere.h"

#include <algorithm>
#include <limits>

namespace limn {
namespace {

constexpr double kLambda = 0.5;         // papers/002
constexpr double kFeatureWeight = 2.0;  // of a border or crease plane, against a face of that size
constexpr double kLengthWeight = 1e-3;  // of the tie-breaker: (1/30 of an edge)² of distance
constexpr double kFlatWeight = 0.1;     // of a region that no view sees as silhouette, against 1
constexpr double kVolumeLengthWeight = 3e-5;  // the same for volumes, which go with length³

// Of placed vertices (place), parts of the trace of the surface's form, for a squared distance:
constexpr double kPull = 1.0;          // … from where the vertex stood
constexpr double kVolumeWeight = 3.0;  // … from the plane that keeps the volume, when rounding
constexpr double kLeastWay2 = 2.0;     // of moves, squared: a step of one is not worth its bytes
constexpr double kLeastArea = 0.01;    // that plane's area², of its parts': else it is no plane

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

// A⁻¹ b for a positive definite form.
glm::dvec3 solve(const Form& a, const glm::dvec3& b) {
  const glm::dvec3 x(a.xx, a.xy, a.xz);
  const glm::dvec3 y(a.xy, a.yy, a.yz);
  const glm::dvec3 z(a.xz, a.yz, a.zz);
  const glm::dvec3 yz = glm::cross(y, z);
  return (b.x * yz + b.y * glm::cross(z, x) + b.z * glm::cross(x, y)) / glm::dot(x, yz);
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

glm::dvec3 Form::times(const glm::dvec3& d) const {
  return {
      xx * d.x + xy * d.y + xz * d.z,
      xy * d.x + yy * d.y + yz * d.z,
      xz * d.x + yz * d.y + zz * d.z};
}

double Quadric::at(const glm::dvec3& p) const {
  return p.x * (xx * p.x + 2.0 * (xy * p.y + xz * p.z + x)) +
         p.y * (yy * p.y + 2.0 * (yz * p.z + y)) + p.z * (zz * p.z + 2.0 * z) + c;
}

CostModel::CostModel(CollapseCost kind, const CollapseMesh& mesh) : kind_(kind) {
  if (!mesh.positions().empty()) low_ = high_ = mesh.positions().front();
  for (const glm::ivec3& p : mesh.positions()) {
    low_ = glm::min(low_, p);
    high_ = glm::max(high_, p);
  }
  if (kind_ != CollapseCost::kQuadric) return;
  quadrics_.resize(mesh.positions().size());
  for (std::uint32_t v = 0; v < quadrics_.size(); ++v)
    quadrics_[v] = vertexQuadric(mesh, v);
}

template <class Visit>
VertexCost CostModel::gather(const CollapseMesh& mesh, std::uint32_t v, Visit visit) const {
  VertexCost result;
  result.vertex = v;
  mesh.forEachFace(v, [&](HalfEdgeId h, std::uint32_t a, std::uint32_t b) {
    const glm::dvec3 normal = mesh.areaNormal(v, a, b);
    visit(normal);
    ++result.degree;
    result.isOnLine = result.isOnLine || isLine(mesh, h) || isLine(mesh, HalfEdgeMesh::prev(h));
    if (kind_ == CollapseCost::kMemoryless) addPlanes(mesh, h, normal, result.surface);
    if (kind_ == CollapseCost::kVolume) {
      // The volume that the face sweeps is a third of its height's way times its area.
      result.surface.add(normal, 1.0 / 36.0);
      addSweptAreas(mesh, h, result.lines);
    }
  });
  return result;
}

VertexCost CostModel::formsAround(const CollapseMesh& mesh, std::uint32_t v) const {
  return gather(mesh, v, [](const glm::dvec3&) {});
}

VertexCost CostModel::around(const CollapseMesh& mesh, std::uint32_t v) const {
  thread_local std::vector<glm::vec3> normals;
  normals.clear();
  VertexCost result = gather(mesh, v, [](const glm::dvec3& n) { normals.emplace_back(n); });
  result.weight = kFlatWeight + silhouetteCells(normals) / static_cast<double>(kViewCells);
  return result;
}

std::optional<PlacedCollapse>
CostModel::place(const CollapseMesh& mesh, const VertexCost& v, const VertexCost& u) const {
  if (v.isOnLine || u.isOnLine) return std::nullopt;
  const glm::ivec3 origin = mesh.positions()[u.vertex];
  const glm::dvec3 old(origin);
  const glm::dvec3 edge = glm::dvec3(mesh.positions()[v.vertex]) - old;
  const double length2 = glm::dot(edge, edge);
  // What a displacement x of u costs, beside v's of x − edge: xᵀAx − 2gᵀx + what does not change.
  Form form;
  glm::dvec3 gradient(0.0);
  double scale = 1.0;
  const auto add = [&form](const Form& other) {
    form.xx += other.xx;
    form.xy += other.xy;
    form.xz += other.xz;
    form.yy += other.yy;
    form.yz += other.yz;
    form.zz += other.zz;
  };
  if (kind_ == CollapseCost::kQuadric) {
    for (const std::uint32_t x : {v.vertex, u.vertex}) {
      const Quadric& q = quadrics_[x];
      add({q.xx, q.xy, q.xz, q.yy, q.yz, q.zz});
      gradient -= glm::dvec3(q.x, q.y, q.z);
    }
    gradient -= form.times(old);
  } else {
    add(v.surface);
    add(u.surface);
    gradient = v.surface.times(edge);
    if (kind_ == CollapseCost::kVolume) scale = kLambda * (v.degree + u.degree);
  }

  // The volume stays the same in the plane area · x = swept.
  glm::dvec3 area(0.0);
  double all = 0.0;
  double swept = 0.0;
  const auto at = [&](std::uint32_t x) { return glm::dvec3(mesh.positions()[x]) - old; };
  const auto addFan = [&](std::uint32_t centre, std::uint32_t other) {
    mesh.forEachFace(centre, [&](HalfEdgeId, std::uint32_t a, std::uint32_t b) {
      if (a == other || b == other) return;
      const glm::dvec3 base = glm::cross(at(a), at(b));
      area += base;
      all += glm::length(base);
      if (centre == v.vertex) swept += glm::dot(edge, base);
    });
  };
  addFan(v.vertex, u.vertex);
  addFan(u.vertex, v.vertex);
  const double area2 = glm::dot(area, area);
  const double trace = form.trace();
  if (area2 <= kLeastArea * all * all || trace <= 0.0) return std::nullopt;

  Form pulled = form;
  pulled.xx += kPull * trace;
  pulled.yy += kPull * trace;
  pulled.zz += kPull * trace;
  const glm::dvec3 free = solve(pulled, gradient);
  const glm::dvec3 along = solve(pulled, area);
  const glm::dvec3 best = free + (swept - glm::dot(area, free)) / glm::dot(area, along) * along;
  if (!(glm::dot(best, best) <= length2)) return std::nullopt;

  const auto costAt = [&](const glm::dvec3& x) {
    return kind_ == CollapseCost::kQuadric
               ? quadrics_[v.vertex].at(old + x) + quadrics_[u.vertex].at(old + x)
               : v.surface.at(x - edge) + u.surface.at(x);
  };
  const glm::ivec3 corner(glm::floor(best));
  glm::ivec3 chosen(0);
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 move = corner + glm::ivec3(k & 1, k >> 1 & 1, k >> 2);
    const glm::dvec3 x(move);
    const double off = glm::dot(area, x) - swept;
    const double badness =
        costAt(x) + trace * (kPull * glm::dot(x, x) + kVolumeWeight * off * off / area2);
    if (badness >= least) continue;
    least = badness;
    chosen = move;
  }
  const glm::ivec3 position = origin + chosen;
  const double way2 = glm::dot(glm::dvec3(chosen), glm::dvec3(chosen));
  if (way2 < kLeastWay2 || glm::clamp(position, low_, high_) != position) return std::nullopt;
  const double shape = kind_ == CollapseCost::kVolume
                           ? kVolumeLengthWeight * length2 * length2 * length2
                           : kLengthWeight * length2 * length2;
  return PlacedCollapse{
      position,
      v.weight * (scale * std::max(0.0, costAt(glm::dvec3(chosen))) + shape)};
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
