// SPDX-License-Identifier: Apache-2.0
// Based on: J. J. Koenderink, "What does the occluding contour tell us about solid shape?",
// Perception 13, 1984: a contour is hidden by its own surface where the surface curves towards the
// viewer (negative radial curvature). For a mesh edge that is a concave edge; for a smooth
// silhouette it is where the front side lies farther away than the back side.
#include "client/stroke/segment_facts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limn {
namespace {

/// How far from its spine a line's visibility looks, in pixels: the 8-neighbourhood of a depth
/// image as fine as the picture.
constexpr float kReachPx = 1.5F;

/// Whether the two faces at h bend inwards, exactly: grid coordinates have at most 18 bits, so the
/// triple product fits 64.
bool isConcave(const HalfEdgeMesh& mesh, std::span<const glm::ivec3> positions, HalfEdgeId h) {
  using Wide = glm::i64vec3;
  const Wide a(positions[mesh.origin(h)]);
  const Wide ab = Wide(positions[mesh.target(h)]) - a;
  const Wide ac = Wide(positions[mesh.origin(HalfEdgeMesh::prev(h))]) - a;
  const Wide ad = Wide(positions[mesh.origin(HalfEdgeMesh::prev(mesh.twin(h)))]) - a;
  const Wide n(ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z, ab.x * ac.y - ab.y * ac.x);
  return n.x * ad.x + n.y * ad.y + n.z * ad.z > 0;
}

}  // namespace

SegmentJudge::SegmentJudge(const PolylineSet& lines, const LineScene& scene)
    : lines_(lines),
      scene_(scene) {
  const glm::dmat4 clipFromWorld = scene.camera.clipFromWorld(scene.viewport.aspect());
  clipFromGrid_ = clipFromWorld * scene.grid.step;
  clipFromGrid_[3] = clipFromWorld * glm::dvec4(scene.grid.origin, 1.0);
  eye_ = scene.grid.fromModel(scene.camera.eye);
  forward_ = scene.camera.forward();
  // Two grid steps in depth at the target, and what 32-bit rasterisation may round.
  const double nearPlane = scene.camera.nearPlane;
  const double farPlane = scene.camera.farPlane;
  const double distance = std::max(glm::distance(scene.camera.eye, scene.camera.target), nearPlane);
  const double depthPerUnit =
      scene.camera.orthographic
          ? 1.0 / (farPlane - nearPlane)
          : nearPlane * farPlane / ((farPlane - nearPlane) * distance * distance);
  floor_ = 1e-6 + 2.0 * scene.grid.step * depthPerUnit;
}

glm::dvec3 SegmentJudge::normal(FaceId face) const {
  const glm::dvec3 a = corner(3 * face);
  return glm::cross(corner(3 * face + 1) - a, corner(3 * face + 2) - a);
}

glm::dvec3 SegmentJudge::towardEye(const glm::dvec3& p) const {
  return scene_.camera.orthographic ? -forward_ : eye_ - p;
}

bool SegmentJudge::isFront(FaceId face) const {
  return glm::dot(normal(face), towardEye(corner(3 * face))) > 0.0;
}

glm::vec2 SegmentJudge::outward(std::uint32_t point, std::uint32_t next, const glm::dvec3& away)
    const {
  const glm::dvec3 a(lines_.points[point]);
  const glm::dvec3 b(lines_.points[next]);
  const glm::dvec3 middle = 0.5 * (a + b);
  const double length = glm::length(away);
  if (!(length > 0.0)) return {};
  // A step outwards that is small beside the distance to the eye.
  const glm::dvec3 step = away * (1e-4 * glm::length(towardEye(middle)) / length);
  const auto pixel = [this](const glm::dvec3& p) {
    return glm::dvec2(pixelFromClip(clipFromGrid_ * glm::dvec4(p, 1.0), scene_.viewport));
  };
  const glm::dvec2 along = pixel(b) - pixel(a);
  const glm::dvec2 aside = pixel(middle + step) - pixel(middle);
  glm::dvec2 across(-along.y, along.x);
  const double size = glm::length(across);
  if (!(size > 1e-9) || !std::isfinite(size)) return {};
  if (glm::dot(across, aside) < 0.0) across = -across;
  return glm::vec2(across / size);
}

float SegmentJudge::depthRange(FaceId face) const {
  double low = 1.0;
  double high = 0.0;
  for (HalfEdgeId h = 3 * face; h < 3 * face + 3; ++h) {
    const glm::dvec4 clip = clipFromGrid_ * glm::dvec4(corner(h), 1.0);
    const double depth = clip.w > 0.0 ? std::clamp(0.5 * (clip.z / clip.w + 1.0), 0.0, 1.0) : 0.0;
    low = std::min(low, depth);
    high = std::max(high, depth);
  }
  return static_cast<float>(std::max(high - low, 0.0));
}

float SegmentJudge::slopeBias(FaceId face, float reachPx) const {
  std::array<glm::dvec3, 3> corners{};
  for (HalfEdgeId k = 0; k < 3; ++k) {
    const glm::dvec4 clip = clipFromGrid_ * glm::dvec4(corner(3 * face + k), 1.0);
    if (!(clip.w > 0.0)) return static_cast<float>(floor_);
    corners[k] = pixelFromClip(clip, scene_.viewport);
  }
  const glm::dvec3 u = corners[1] - corners[0];
  const glm::dvec3 v = corners[2] - corners[0];
  const double area = u.x * v.y - u.y * v.x;
  const double range = std::max({corners[0].z, corners[1].z, corners[2].z}) -
                       std::min({corners[0].z, corners[1].z, corners[2].z});
  double rise = range;
  if (std::abs(area) > 1e-12) {
    const double perX = (u.z * v.y - v.z * u.y) / area;
    const double perY = (v.z * u.x - u.z * v.x) / area;
    rise = std::min(range, reachPx * (std::abs(perX) + std::abs(perY)));
  }
  return static_cast<float>(floor_ + rise);
}

SegmentFacts SegmentJudge::judge(LineKind kind, std::uint32_t point, std::uint32_t next) const {
  SegmentFacts facts;
  const HalfEdgeId h = lines_.halfEdges[point];
  const FaceId face = h != kNone ? HalfEdgeMesh::face(h) : lines_.faces[point];
  facts.bias = static_cast<float>(floor_);
  if (face == kNone || face >= scene_.mesh.faceCount()) return facts;
  const HalfEdgeId twin = h == kNone ? kNone : scene_.mesh.twin(h);

  if (kind == LineKind::kSilhouette && h == kNone) {
    // Lines run with the front side to their left: n × along points there.
    const glm::dvec3 n = normal(face);
    const glm::dvec3 along(lines_.points[next] - lines_.points[point]);
    const glm::dvec3 middle = 0.5 * glm::dvec3(lines_.points[point] + lines_.points[next]);
    facts.hiddenByRule = glm::dot(glm::cross(n, along), towardEye(middle)) < 0.0;
    facts.outward = outward(point, next, n);
    // The line may lie on a face turned away, under the faces around it: as deep as its own face
    // is.
    facts.bias = static_cast<float>(floor_) + depthRange(face);
    return facts;
  }
  if (twin == kNone) {
    // A border: seen from either side of its face.
    facts.bias = slopeBias(face, kReachPx);
    return facts;
  }
  const FaceId other = HalfEdgeMesh::face(twin);
  const bool isFrontHere = isFront(face);
  const bool isFrontThere = isFront(other);
  if (isFrontHere != isFrontThere || kind == LineKind::kSilhouette) {
    facts.hiddenByRule = isConcave(scene_.mesh, scene_.positions, h);
    const glm::dvec3 here = normal(face);
    const glm::dvec3 there = normal(other);
    const double hereLength = glm::length(here);
    const double thereLength = glm::length(there);
    glm::dvec3 away(0.0);
    if (hereLength > 0.0) away += here / hereLength;
    if (thereLength > 0.0) away += there / thereLength;
    facts.outward = outward(point, next, away);
    facts.bias = slopeBias(isFrontHere ? face : other, 0.5F * kReachPx);
    return facts;
  }
  // A crease inside the picture of the surface, or one that faces away on both sides.
  facts.hiddenByRule = !isFrontHere;
  facts.bias = std::max(slopeBias(face, kReachPx), slopeBias(other, kReachPx));
  return facts;
}

}  // namespace limn
