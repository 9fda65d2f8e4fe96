// SPDX-License-Identifier: Apache-2.0
// Based on: M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 3.2.1.
// L. Markosian et al., "Real-Time Nonphotorealistic Rendering", SIGGRAPH 1997 (candidates sorted by
// dihedral angle, search away from or towards the viewer).
// Deviations: from a sorted list, place n·u² is drawn (u uniform), so that every face stays
// possible; the walk goes downhill in |normal · view|, which is away from the viewer on a front
// face and towards on a back one.
#include "shared/silhouette/random_seeds.h"

#include <algorithm>
#include <numeric>

namespace limn {
namespace {

// Faces by the sharpest dihedral angle to a neighbour, sharpest first.
std::vector<FaceId> sortByDihedral(const SilhouetteField& field) {
  const HalfEdgeMesh& mesh = field.mesh();
  const auto positions = field.positions();
  std::vector<glm::vec3> normals;
  normals.reserve(mesh.faceCount());
  for (const glm::uvec3& t : mesh.triangles()) {
    const glm::vec3 n = glm::cross(
        glm::vec3(positions[t.y] - positions[t.x]),
        glm::vec3(positions[t.z] - positions[t.x]));
    const float length = glm::length(n);
    normals.push_back(length > 0.0F ? n / length : n);
  }
  std::vector<float> sharpest(mesh.faceCount(), 1.0F);  // smallest cosine
  for (HalfEdgeId h = 0; h < mesh.twins.size(); ++h) {
    if (mesh.twins[h] == kNone) continue;
    const FaceId f = HalfEdgeMesh::face(h);
    const float cosine = glm::dot(normals[f], normals[HalfEdgeMesh::face(mesh.twins[h])]);
    sharpest[f] = std::min(sharpest[f], cosine);
  }
  std::vector<FaceId> faces(mesh.faceCount());
  std::iota(faces.begin(), faces.end(), FaceId{0});
  std::stable_sort(faces.begin(), faces.end(), [&](FaceId a, FaceId b) {
    return sharpest[a] < sharpest[b];
  });
  return faces;
}

}  // namespace

RandomDetector::RandomDetector(const SilhouetteField& field, const RandomSeedOptions& options)
    : SeededDetector(field),
      options_(options),
      rng_(options.seed) {
  if (options.sortByDihedral) byDihedral_ = sortByDihedral(field);
}

void RandomDetector::search(const SilhouetteView& /*view*/) {
  const std::uint32_t faces = field().mesh().faceCount();
  if (faces == 0) return;
  const double share = std::clamp(options_.fraction, 0.0, 1.0);
  const auto seeds = static_cast<std::uint32_t>(share * faces + 0.5);
  for (std::uint32_t i = 0; i < seeds; ++i) {
    FaceId f = 0;
    if (byDihedral_.empty()) {
      f = static_cast<FaceId>(rng_.below(faces));
    } else {
      const double u = rng_.uniform();
      f = byDihedral_[static_cast<std::size_t>(u * u * faces)];
    }
    ++tracer().stats().seedsTried;
    if (!tracer().visit(f) || tracer().follow(f) || options_.searchSteps <= 0) continue;
    tracer().walkFromFace(f, options_.searchSteps);
  }
}

}  // namespace limn
