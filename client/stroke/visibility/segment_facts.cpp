// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/visibility/segment_facts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limn {
namespace {

/// How far from its spine a line's visibility looks, in pixels: the 8-neighbourhood of a depth
/// image as fine as the picture.
constexpr float kReachPx = 1.5F;

/// A smooth silhouette that lies farther inside its mesh's outline than this is on its own.
constexpr double kMostStandOutPx = 16.0;

/// Beside a face this narrow (its height for its longest side) pixels have the depth of the faces
/// around it, taken as no more than this many times the least bias: those of machines are large,
/// and as steep as you like.
constexpr double kSliver = 0.05;
constexpr double kMostOfSliver = 32.0;

double affine(const glm::dvec4& row, const glm::dvec3& p) {
  return row.x * p.x + row.y * p.y + row.z * p.z + row.w;
}

bool isSliver(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 n = glm::cross(b - a, c - a);
  const double longest2 =
      std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
  return glm::dot(n, n) < kSliver * kSliver * longest2 * longest2;
}

}  // namespace

SegmentJudge::SegmentJudge(const PolylineSet& lines, const LineScene& scene)
    : lines_(lines),
      scene_(scene),
      faces_(scene),
      clipFromGrid_(clipFromGrid(scene)),
      clipRows_(glm::transpose(clipFromGrid_)) {
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

glm::dvec4 SegmentJudge::clipOf(const glm::dvec3& p) const {
  return clipFromGrid_[0] * p.x + clipFromGrid_[1] * p.y + clipFromGrid_[2] * p.z +
         clipFromGrid_[3];
}

float SegmentJudge::slopeBias(FaceId face, float reachPx) const {
  std::array<glm::dvec3, 3> corners{};
  for (HalfEdgeId k = 0; k < 3; ++k) {
    const glm::dvec4 clip = clipOf(faces_.corner(3 * face + k));
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

float SegmentJudge::biasAround(FaceId face) const {
  float bias = 0.0F;
  for (HalfEdgeId h = 3 * face; h < 3 * face + 3; ++h) {
    const HalfEdgeId twin = scene_.mesh.twin(h);
    if (twin != kNone) bias = std::max(bias, slopeBias(HalfEdgeMesh::face(twin), kReachPx));
  }
  return std::min(bias, static_cast<float>(kMostOfSliver * floor_));
}

SegmentFacts SegmentJudge::judgeSmooth(FaceId face, const LineEnd& begin, const LineEnd& end)
    const {
  const glm::dvec3 a = faces_.corner(3 * face);
  const glm::dvec3 b = faces_.corner(3 * face + 1);
  const glm::dvec3 c = faces_.corner(3 * face + 2);
  const glm::dvec3 from(lines_.points[begin.point]);
  const glm::dvec3 along = glm::dvec3(lines_.points[end.point]) - from;
  SegmentFacts facts;
  // Lines run with the front side to their left.
  facts.openSide = 1.0F;
  // The line may lie on a face turned away, under the faces around it: as deep as its own face is
  // across the line. Along it the line's own depth goes with the face: a rod's long faces reach
  // far.
  const glm::dvec4& clipFrom = begin.inClip;
  const glm::dvec4& clipTo = end.inClip;
  const glm::dvec2 start(clipFrom.w > 0.0 ? begin.inPicture : glm::dvec3(0.0));
  const glm::dvec2 course = glm::dvec2(clipTo.w > 0.0 ? end.inPicture : glm::dvec3(0.0)) - start;
  const double coursePx = glm::length(course);
  const glm::dvec2 outward =
      coursePx > 1e-6 ? glm::dvec2(-course.y, course.x) / coursePx : glm::dvec2(0.0);
  // How far outward a place lies, before it is divided by w.
  const glm::dvec2 half = 0.5 * glm::dvec2(scene_.viewport.width, scene_.viewport.height);
  const glm::dvec4 outwardRow =
      (half.x * outward.x) * clipRows_[0] - (half.y * outward.y) * clipRows_[1];
  const double outwardOfCentre = glm::dot(half - start, outward);
  const double length2 = glm::dot(along, along);
  const double perLength2 = length2 > 0.0 ? 1.0 / length2 : 0.0;
  double nearest = 0.0;
  double farthest = 0.0;
  double standOut = 0.0;
  for (const glm::dvec3& corner : {a, b, c}) {
    const double share = perLength2 * glm::dot(corner - from, along);
    const double footW = clipFrom.w + share * (clipTo.w - clipFrom.w);
    const double footZ = clipFrom.z + share * (clipTo.z - clipFrom.z);
    const double z = affine(clipRows_[2], corner);
    const double w = affine(clipRows_[3], corner);
    if (!(w > 0.0)) continue;
    const double perBoth = 1.0 / (w * footW);
    const double rise = footW > 0.0 ? 0.5 * (z * footW - footZ * w) * perBoth : 0.0;
    nearest = std::min(nearest, rise);
    farthest = std::max(farthest, rise);
    standOut = std::max(standOut, affine(outwardRow, corner) * footW * perBoth + outwardOfCentre);
  }
  facts.bias = static_cast<float>(floor_ + farthest - nearest);
  if (isSliver(a, b, c)) facts.bias = std::max(facts.bias, biasAround(face));
  facts.standOutPx = static_cast<float>(std::min(standOut, kMostStandOutPx));
  return facts;
}

SegmentFacts SegmentJudge::judge(
    const PolylineSet::Line& line,
    std::uint32_t point,
    const LineEnd& from,
    const LineEnd& to) const {
  const bool isSilhouette = line.isContour();
  SegmentFacts facts;
  const HalfEdgeId h = lines_.halfEdges[point];
  const FaceId face = h != kNone ? HalfEdgeMesh::face(h) : lines_.faces[point];
  facts.bias = static_cast<float>(floor_);
  if (face == kNone || face >= scene_.mesh.faceCount()) {
    // An outline of a mesh that is not here: the front side is to its left.
    if (isSilhouette) facts.openSide = 1.0F;
    return facts;
  }
  if (isSilhouette && h == kNone) return judgeSmooth(face, from, to);
  if (h == kNone) {
    facts.bias = slopeBias(face, kReachPx);
    return facts;
  }
  const HalfEdgeId twin = scene_.mesh.twin(h);
  if (twin == kNone) {
    // A border: seen from either side of its face.
    facts.bias = slopeBias(face, kReachPx);
    return facts;
  }
  const FaceId other = HalfEdgeMesh::face(twin);
  const bool isFrontHere = faces_.isFront(face);
  const bool isFrontThere = faces_.isFront(other);
  if (isFrontHere != isFrontThere || isSilhouette) {
    // A half-edge has its own face to its left; the surface ends on the other side of the front.
    facts.openSide = isFrontHere ? 1.0F : -1.0F;
    facts.bias = slopeBias(isFrontHere ? face : other, 0.5F * kReachPx);
    return facts;
  }
  facts.bias = std::max(slopeBias(face, kReachPx), slopeBias(other, kReachPx));
  return facts;
}

}  // namespace limn
