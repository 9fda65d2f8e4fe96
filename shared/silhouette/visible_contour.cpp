// SPDX-License-Identifier: Apache-2.0
// Based on: P. Mohr, "Silhouette Rendering of Complex Shapes with Stylized Lines" (thesis), 2013,
// §3.4 (the depth image is asked at a line's pixel and its eight neighbours).
// The rules are those of client/stroke/visibility/visibility: only neighbours on the silhouette's
// outward side are asked, two must be free, silhouettes that are concave or covered by faces around
// them are hidden, the bias follows the slope of the surface, and most of a segment decides for all
// of it.
#include "shared/silhouette/visible_contour.h"

#include "shared/mesh/edge_shape.h"
#include "shared/silhouette/trace.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limn {
namespace {

constexpr int kFreeNeighbours = 2;
constexpr double kReachPx = 0.75;
constexpr double kFloorSteps = 2.0;  // grid units

/// One silhouette segment in the picture.
struct Segment {
  glm::dvec3 from{0.0};  // pixels and nearness
  glm::dvec3 to{0.0};
  glm::vec2 outward{0.0F};  // unit, pixels; 0: unknown
  double bias = 0.0;        // nearness
};

class Judge {
 public:
  Judge(
      const SilhouetteField& field,
      const PictureView& picture,
      std::span<const glm::vec3> projected,
      const NearnessImage& image)
      : field_(field),
        mesh_(field.mesh()),
        picture_(picture),
        projected_(projected),
        image_(image) {}

  /// A silhouette edge, h of its front face. False: hidden by its own faces, or not in the picture.
  bool edgeSegment(HalfEdgeId h, Segment& segment) const {
    const std::uint32_t a = mesh_.origin(h);
    const std::uint32_t b = mesh_.target(h);
    if (isConcave(mesh_, field_.positions(), h)) return false;
    segment.from = glm::dvec3(projected_[a]);
    segment.to = glm::dvec3(projected_[b]);
    if (!inPicture(segment)) return false;
    const auto positions = field_.positions();
    if (isCoveredNearby(mesh_, positions, h, towardEye(edgeMiddle(mesh_, positions, h)))) {
      return false;
    }
    segment.outward = rightOf(segment);
    segment.bias = floorAt(segment) + slope(HalfEdgeMesh::face(h));
    return true;
  }

  /// A segment of the smooth silhouette within a face.
  bool faceSegment(FaceId face, const SmoothWalk& walk, Segment& segment) const {
    const glm::dvec3 a(walk.entryPoint());
    const glm::dvec3 b(walk.exitPoint());
    const glm::dvec3 n = normal(face);
    const glm::dvec3 middle = 0.5 * (a + b);
    const glm::dvec3 toEye = towardEye(middle);
    if (glm::dot(glm::cross(n, b - a), toEye) < 0.0) return false;
    segment.from = picture_.project(a);
    segment.to = picture_.project(b);
    if (!inPicture(segment)) return false;
    segment.outward = rightOf(segment);
    float low = projected_[mesh_.origins[3 * face]].z;
    float high = low;
    for (HalfEdgeId h = 3 * face + 1; h < 3 * face + 3; ++h) {
      low = std::min(low, projected_[mesh_.origins[h]].z);
      high = std::max(high, projected_[mesh_.origins[h]].z);
    }
    segment.bias = floorAt(segment) + (high - low);
    return true;
  }

  /// Whether most of a segment is visible.
  [[nodiscard]] bool isVisible(const Segment& segment) const {
    const double length = glm::distance(glm::dvec2(segment.from), glm::dvec2(segment.to));
    const int steps = std::clamp(static_cast<int>(std::ceil(length)), 1, 10'000);
    int seen = 0;
    for (int i = 0; i < steps; ++i)
      seen += test(segment, (i + 0.5) / steps) ? 1 : 0;
    return 2 * seen > steps;
  }

 private:
  [[nodiscard]] glm::dvec3 position(std::uint32_t v) const {
    return glm::dvec3(field_.positions()[v]);
  }

  [[nodiscard]] glm::dvec3 normal(FaceId face) const {
    const glm::dvec3 a = position(mesh_.origins[3 * face]);
    return glm::cross(
        position(mesh_.origins[3 * face + 1]) - a,
        position(mesh_.origins[3 * face + 2]) - a);
  }

  [[nodiscard]] bool inPicture(const Segment& segment) const {
    if (!picture_.orthographic && (segment.from.z == 0.0 || segment.to.z == 0.0)) return false;
    const glm::dvec2 low = glm::min(glm::dvec2(segment.from), glm::dvec2(segment.to));
    const glm::dvec2 high = glm::max(glm::dvec2(segment.from), glm::dvec2(segment.to));
    return high.x >= 0.0 && high.y >= 0.0 && low.x <= picture_.width && low.y <= picture_.height;
  }

  [[nodiscard]] double floorAt(const Segment& segment) const {
    const double z = 0.5 * (segment.from.z + segment.to.z);
    return picture_.nearnessOf(kFloorSteps, z) + 1e-6 * std::abs(z);
  }

  /// How much nearer a face may get within reach of a line on it.
  [[nodiscard]] double slope(FaceId face) const {
    std::array<glm::dvec3, 3> p{};
    for (HalfEdgeId k = 0; k < 3; ++k)
      p[k] = glm::dvec3(projected_[mesh_.origins[3 * face + k]]);
    const glm::dvec3 u = p[1] - p[0];
    const glm::dvec3 v = p[2] - p[0];
    const double area = u.x * v.y - u.y * v.x;
    const double range = std::max({p[0].z, p[1].z, p[2].z}) - std::min({p[0].z, p[1].z, p[2].z});
    if (std::abs(area) <= 1e-12) return range;
    const double perX = (u.z * v.y - v.z * u.y) / area;
    const double perY = (v.z * u.x - u.z * v.x) / area;
    return std::min(range, kReachPx * (std::abs(perX) + std::abs(perY)));
  }

  /// Segments run with the front to their left, so the surface ends on their right.
  [[nodiscard]] static glm::vec2 rightOf(const Segment& segment) {
    const glm::dvec2 along(segment.to - segment.from);
    const double length = glm::length(along);
    return length > 1e-6 ? glm::vec2(glm::dvec2(-along.y, along.x) / length) : glm::vec2(0.0F);
  }

  /// From a point of the surface; of a perspective view as long as the way is.
  [[nodiscard]] glm::dvec3 towardEye(const glm::dvec3& p) const {
    return picture_.orthographic ? -picture_.forward : picture_.eye - p;
  }

  [[nodiscard]] bool test(const Segment& segment, double t) const {
    const glm::dvec3 p = glm::mix(segment.from, segment.to, t);
    if (p.x < 0.0 || p.y < 0.0 || p.x >= image_.width || p.y >= image_.height) return false;
    const auto column = static_cast<int>(p.x);
    const auto row = static_cast<int>(p.y);
    const auto limit = static_cast<float>(p.z + segment.bias);
    int free = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const glm::vec2 aside(static_cast<float>(dx), static_cast<float>(dy));
        if (glm::dot(aside, segment.outward) < -0.1F) continue;
        const int x = std::clamp(column + dx, 0, image_.width - 1);
        const int y = std::clamp(row + dy, 0, image_.height - 1);
        if (image_.at(x, y) <= limit && ++free == kFreeNeighbours) return true;
      }
    }
    return false;
  }

  const SilhouetteField& field_;
  const HalfEdgeMesh& mesh_;
  const PictureView& picture_;
  std::span<const glm::vec3> projected_;
  const NearnessImage& image_;
};

void appendPoints(
    const Segment& segment,
    std::uint32_t name,
    const PictureView& picture,
    double spacingPx,
    std::vector<ContourPoint>& points) {
  const glm::dvec2 from(segment.from);
  const glm::dvec2 to(segment.to);
  const double length = glm::distance(from, to);
  const int steps = std::clamp(static_cast<int>(std::ceil(length / spacingPx)), 1, 100'000);
  const auto each = static_cast<float>(length / steps);
  for (int i = 0; i < steps; ++i) {
    const glm::dvec2 p = glm::mix(from, to, (i + 0.5) / steps);
    if (p.x < 0.0 || p.y < 0.0 || p.x > picture.width || p.y > picture.height) continue;
    points.push_back({glm::vec2(p), each, name});
  }
}

}  // namespace

const std::vector<ContourPoint>& VisibleContourFinder::find(
    const SilhouetteField& field,
    const PictureView& picture,
    double spacingPx) {
  const HalfEdgeMesh& mesh = field.mesh();
  projected_.resize(field.positions().size());
  for (std::size_t v = 0; v < projected_.size(); ++v)
    projected_[v] = glm::vec3(picture.project(glm::dvec3(field.positions()[v])));
  bool closed = true;
  for (const HalfEdgeId twin : mesh.twins)
    closed = closed && twin != kNone;
  image_.width = picture.width;
  image_.height = picture.height;
  drawNearness(
      mesh.triangles(),
      projected_,
      closed ? Occluders::kFrontFaces : Occluders::kBothSides,
      image_);

  const glm::vec4 eye = field.eyeOf(picture.silhouetteView());
  front_.resize(field.siteCount());
  for (std::uint32_t site = 0; site < front_.size(); ++site)
    front_[site] = field.isFront(site, eye) ? 1 : 0;
  points_.clear();
  const Judge judge(field, picture, projected_, image_);
  Segment segment;
  if (field.kind() == SilhouetteKind::kEdges) {
    for (HalfEdgeId h = 0; h < mesh.twins.size(); ++h) {
      if (front_[HalfEdgeMesh::face(h)] == 0 || mesh.twins[h] == kNone) continue;
      if (front_[HalfEdgeMesh::face(mesh.twins[h])] != 0) continue;
      if (judge.edgeSegment(h, segment) && judge.isVisible(segment)) {
        appendPoints(segment, h, picture, spacingPx, points_);
      }
    }
    return points_;
  }
  const auto triangles = mesh.triangles();
  SmoothWalk walk(field, eye);
  for (FaceId f = 0; f < triangles.size(); ++f) {
    const glm::uvec3& t = triangles[f];
    if (front_[t.x] == front_[t.y] && front_[t.y] == front_[t.z]) continue;
    if (!walk.start(f)) continue;
    if (judge.faceSegment(f, walk, segment) && judge.isVisible(segment)) {
      appendPoints(segment, f, picture, spacingPx, points_);
    }
  }
  return points_;
}

}  // namespace limn
