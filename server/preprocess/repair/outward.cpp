// SPDX-License-Identifier: Apache-2.0
// Based on: A. Jacobson, L. Kavan, O. Sorkine-Hornung, "Robust Inside-Outside Segmentation using
// Generalized Winding Numbers", 2013 (the test of containment); A. Van Oosterom, J. Strackee, "The
// Solid Angle of a Plane Triangle", 1983.
#include "server/preprocess/repair/repair_steps.h"

#include "shared/core/integer_vectors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

namespace limn::repair {

namespace {

/// Solid angles to evaluate at most, about a second of them. Past that, a component counts as
/// standing alone.
constexpr std::uint64_t kMaxSolidAngles = 20'000'000;

struct Component {
  std::vector<FaceId> faces;
  Int128 volume6 = 0;  // six times the signed volume
  glm::ivec3 low{0};
  glm::ivec3 high{0};
  bool closed = true;
  bool authored = true;  // the file's own orientation, no face of it turned

  [[nodiscard]] bool boxContains(const Component& other) const {
    return glm::all(glm::lessThanEqual(low, other.low)) &&
           glm::all(glm::greaterThanEqual(high, other.high)) &&
           (low != other.low || high != other.high);
  }
};

std::vector<Component> findComponents(const Manifold& mesh) {
  std::vector<Component> components;
  std::vector<std::uint8_t> seen(mesh.triangles.size(), 0);
  for (FaceId seed = 0; seed < mesh.triangles.size(); ++seed) {
    if (seen[seed] != 0) continue;
    Component component;
    component.faces.push_back(seed);
    seen[seed] = 1;
    component.low = component.high = mesh.positions[mesh.triangles[seed].x];
    for (std::size_t done = 0; done < component.faces.size(); ++done) {
      const FaceId face = component.faces[done];
      const glm::uvec3& t = mesh.triangles[face];
      const glm::i64vec3 a(mesh.positions[t.x]);
      const glm::i64vec3 b(mesh.positions[t.y]);
      const glm::i64vec3 c(mesh.positions[t.z]);
      component.volume6 += dotExact(a, crossExact(b, c));
      component.authored = component.authored && mesh.flipped[face] == 0;
      for (int k = 0; k < 3; ++k) {
        component.low = glm::min(component.low, mesh.positions[t[k]]);
        component.high = glm::max(component.high, mesh.positions[t[k]]);
        const HalfEdgeId twin = mesh.twins[3 * face + static_cast<std::uint32_t>(k)];
        if (twin == kNone) {
          component.closed = false;
        } else if (seen[twin / 3] == 0) {
          seen[twin / 3] = 1;
          component.faces.push_back(twin / 3);
        }
      }
    }
    components.push_back(std::move(component));
  }
  return components;
}

/// How often the component winds round p; p on its surface gives some fraction.
double windingNumber(const Manifold& mesh, const Component& component, const glm::dvec3& p) {
  double sum = 0.0;
  for (const FaceId face : component.faces) {
    const glm::uvec3& t = mesh.triangles[face];
    const glm::dvec3 a = glm::dvec3(mesh.positions[t.x]) - p;
    const glm::dvec3 b = glm::dvec3(mesh.positions[t.y]) - p;
    const glm::dvec3 c = glm::dvec3(mesh.positions[t.z]) - p;
    const double la = glm::length(a);
    const double lb = glm::length(b);
    const double lc = glm::length(c);
    const double divisor =
        la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    sum += 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)), divisor);
  }
  return sum / (4.0 * std::numbers::pi);
}

void turn(Manifold& mesh, const Component& component) {
  for (const FaceId face : component.faces) {
    std::swap(mesh.triangles[face].y, mesh.triangles[face].z);
    mesh.flipped[face] = static_cast<std::uint8_t>(1 - mesh.flipped[face]);
  }
}

/// For each component the outermost one that contains it, itself where none does. Only components
/// whose orientation is the file's own take part.
std::vector<std::uint32_t> findOutermost(
    const Manifold& mesh,
    std::span<const Component> components) {
  std::vector<std::uint32_t> outermost(components.size());
  std::iota(outermost.begin(), outermost.end(), 0U);
  // Only an inward component makes it matter who contains whom.
  const bool anyInward = std::any_of(components.begin(), components.end(), [](const Component& c) {
    return c.closed && c.authored && c.volume6 < 0;
  });
  if (!anyInward || components.size() == 1) return outermost;

  std::vector<std::uint32_t> bySize;
  for (const std::uint32_t i : outermost) {
    const Component& component = components[i];
    if (component.closed && component.authored && component.volume6 != 0) bySize.push_back(i);
  }
  const auto size = [&](std::uint32_t i) {
    return components[i].volume6 < 0 ? -components[i].volume6 : components[i].volume6;
  };
  std::stable_sort(bySize.begin(), bySize.end(), [&](std::uint32_t a, std::uint32_t b) {
    return size(a) > size(b);
  });
  std::uint64_t angles = kMaxSolidAngles;
  std::uint64_t boxes = kMaxSolidAngles;
  const auto contains = [&](const Component& outer, const Component& inner) {
    if (boxes == 0 || !outer.boxContains(inner)) return false;
    if (outer.faces.size() > angles) return false;
    angles -= outer.faces.size();
    const glm::dvec3 probe(mesh.positions[mesh.triangles[inner.faces[0]].x]);
    return std::abs(windingNumber(mesh, outer, probe)) > 0.75;
  };
  // Roots are few in a file of many parts; a box test spares nearly all of the rest.
  std::vector<std::uint32_t> roots;
  for (const std::uint32_t i : bySize) {
    const auto root = std::find_if(roots.begin(), roots.end(), [&](std::uint32_t candidate) {
      const bool inside = contains(components[candidate], components[i]);
      boxes -= boxes > 0 ? 1 : 0;
      return inside;
    });
    if (root == roots.end()) {
      roots.push_back(i);
    } else {
      outermost[i] = *root;
    }
  }
  return outermost;
}

}  // namespace

void orientOutward(Manifold& mesh) {
  const std::vector<Component> components = findComponents(mesh);
  // A component that the file orients inward, face for face, inside another closed one is a cavity:
  // it turns with the outermost one or not at all.
  const std::vector<std::uint32_t> outermost = findOutermost(mesh, components);
  for (std::size_t i = 0; i < components.size(); ++i) {
    if (components[i].closed && components[outermost[i]].volume6 < 0) turn(mesh, components[i]);
  }
  // Turning exchanges corners y and z: half-edges change numbers and so do their twins.
  // The caller links again.
  mesh.twins.clear();
}

}  // namespace limn::repair
