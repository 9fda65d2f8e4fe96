// SPDX-License-Identifier: Apache-2.0
// Based on: A. Appel, "The Notion of Quantitative Invisibility and the Machine Rendering of
// Solids", ACM 1967, and L. Markosian et al., "Real-Time Nonphotorealistic Rendering", SIGGRAPH
// 1997: visibility changes only where a line passes behind a contour and at singular vertices.
// J. J. Koenderink, "What does the occluding contour tell us about solid shape?", Perception 13,
// 1984, for contours hidden by their own surface. A. Hertzmann, D. Zorin, "Illustrating Smooth
// Surfaces", SIGGRAPH 2000, section 4, for smooth silhouettes.
// Deviations: invisibility is not counted along a chain, where one wrong step spoils the rest: each
// piece asks for itself whether anything is in the way, which a ray tells in a microsecond.
#include "client/stroke/visibility/resolved_visibility.h"

#include "client/stroke/scene_faces.h"
#include "client/stroke/visibility/line_crossings.h"
#include "client/stroke/visibility/line_spans.h"
#include "client/stroke/visibility/own_surface.h"
#include "client/stroke/visibility/spine_samples.h"

#include "shared/mesh/edge_shape.h"
#include "shared/mesh/fan.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

/// Faces met within this distance (grid units) are those that the line lies on.
constexpr double kSkip = 1e-4;
/// Of points in floats, on faces that are not the line's own: where parts pass through each other.
constexpr double kSkipOnSurface = 0.05;
/// Of borders: parts of machines are put together with others' faces as far before their edges as
/// the two sides of a crack lie apart, and farther along a slanting ray.
constexpr double kSkipAtBorder = 5.0;

/// Resolves the lines of one view.
class ViewResolver {
 public:
  ViewResolver(
      const PolylineSet& lines,
      const LineScene& scene,
      const TriangleBvh& bvh,
      bool isClosed,
      std::span<const std::uint8_t> isNearest)
      : lines_(lines),
        isNearest_(isNearest),
        scene_(scene),
        mesh_(scene.mesh),
        faces_(scene),
        bvh_(bvh),
        isClosed_(isClosed),
        clipFromGrid_(clipFromGrid(scene)),
        crossings_(scene.viewport),
        ownSurface_(scene.mesh) {}

  ResolvedLines resolve() {
    findFronts();
    addOccluders();
    ResolvedLines out;
    out.begin.reserve(lines_.points.size() + 1);
    out.pieces.reserve(lines_.points.size());
    for (const PolylineSet::Line& line : lines_.lines) {
      for (std::uint32_t point = line.begin; point < line.end; ++point) {
        out.begin.push_back(static_cast<std::uint32_t>(out.pieces.size()));
        if (point - line.begin >= line.segmentCount()) continue;
        const std::uint32_t next = point + 1 < line.end ? point + 1 : line.begin;
        resolveSegment(line, point, next, out);
      }
    }
    out.begin.push_back(static_cast<std::uint32_t>(out.pieces.size()));
    return out;
  }

 private:
  [[nodiscard]] glm::dvec4 clip(const glm::dvec3& p) const {
    return clipFromGrid_ * glm::dvec4(p, 1.0);
  }

  void findFronts() {
    isFront_.resize(mesh_.faceCount());
    for (FaceId f = 0; f < isFront_.size(); ++f)
      isFront_[f] = faces_.isFront(f) ? 1 : 0;
  }

  // Where the mesh's outline lies: borders and contours. On a closed mesh concave contours lie
  // behind something, and nothing becomes visible or hidden by passing behind them.
  void addOccluders() {
    for (HalfEdgeId h = 0; h < mesh_.origins.size(); ++h) {
      const HalfEdgeId twin = mesh_.twin(h);
      if (twin != kNone) {
        if (isFront_[HalfEdgeMesh::face(h)] == 0 || isFront_[HalfEdgeMesh::face(twin)] != 0)
          continue;
        if (isClosed_ && isConcave(mesh_, scene_.positions, h)) continue;
      }
      const FaceId face = HalfEdgeMesh::face(h);
      crossings_.addEdge(
          clip(faces_.corner(h)),
          clip(faces_.corner(HalfEdgeMesh::next(h))),
          isFront_[face] != 0 ? LineCrossings::Surface::kLeft : LineCrossings::Surface::kRight,
          face);
    }
    crossings_.build();
  }

  void resolveSegment(
      const PolylineSet::Line& line,
      std::uint32_t point,
      std::uint32_t next,
      ResolvedLines& out) {
    const glm::dvec3 a(lines_.points[point]);
    const glm::dvec3 b(lines_.points[next]);
    const bool isSmooth = lines_.halfEdges[point] == kNone;
    const bool isHidden = !isSmooth        ? isHiddenEdge(line, lines_.halfEdges[point])
                          : line.onSurface ? isClosed_ && isFront_[lines_.faces[point]] == 0
                                           : line.back != PolylineSet::Back::kSeen &&
                                                 faces_.hidesSmooth(lines_.faces[point], a, b);
    if (isHidden) {
      out.pieces.push_back({1.0F, false});
      return;
    }
    if (isSmooth) {
      gatherAround(lines_.faces[point]);
    } else {
      const HalfEdgeId h = lines_.halfEdges[point];
      const HalfEdgeId twin = mesh_.twin(h);
      own_.assign(1, HalfEdgeMesh::face(h));
      if (twin != kNone) own_.push_back(HalfEdgeMesh::face(twin));
    }
    cuts_.clear();
    crossings_.cross(clip(a), clip(b), cuts_);
    if (line.kind != LineKind::kIntersection) cutWherePierced(a, b);
    double from = 0.0;
    for (std::size_t cut = 0; cut <= cuts_.size(); ++cut) {
      const double to = cut < cuts_.size() ? cuts_[cut].inSpace : 1.0;
      const glm::dvec3 middle = glm::mix(a, b, 0.5 * (from + to));
      const bool isAside = isSmooth && !line.onSurface;
      const bool visible = isAside ? !isBlockedAside(point, b - a, middle, out)
                                   : !isBlocked(middle, skipOf(line, point), own_, out);
      const bool isFirst = out.pieces.size() == out.begin.back();
      if (!isFirst && out.pieces.back().visible == visible) {
        out.pieces.back().end = static_cast<float>(to);
      } else {
        out.pieces.push_back({static_cast<float>(to), visible});
      }
      from = to;
    }
  }

  [[nodiscard]] double skipOf(const PolylineSet::Line& line, std::uint32_t point) const {
    if (line.kind == LineKind::kIntersection) return kSkipOnSurface;
    const HalfEdgeId h = lines_.halfEdges[point];
    return h != kNone && mesh_.twin(h) == kNone ? kSkipAtBorder : kSkip;
  }

  // Where parts pass through one another a line comes out of a face, or goes in behind it.
  void cutWherePierced(const glm::dvec3& a, const glm::dvec3& b) {
    Ray way;
    way.origin = a;
    way.direction = b - a;
    const double length = glm::length(way.direction);
    if (!(length > 2.0 * kSkipOnSurface)) return;
    way.begin = kSkipOnSurface / length;
    way.end = 1.0 - way.begin;
    if (!bvh_.isBlocked(way, own_)) return;
    for (const RayHit& hit : bvh_.allHits(way)) {
      if (std::find(own_.begin(), own_.end(), hit.face) != own_.end()) continue;
      LineCrossings::Crossing cut;
      cut.inSpace = hit.t;
      cuts_.push_back(cut);
    }
    std::sort(cuts_.begin(), cuts_.end(), [](const auto& x, const auto& y) {
      return x.inSpace < y.inSpace;
    });
  }

  // A place of a smooth silhouette, by more than facets of its own surface that stand out beside
  // it, or what else does and has no line of its own.
  [[nodiscard]] bool isBlockedAside(
      std::uint32_t point,
      const glm::dvec3& along,
      const glm::dvec3& middle,
      ResolvedLines& out) {
    const FaceId face = lines_.faces[point];
    const glm::dvec3 aside = faces_.outward(face, along, middle);
    const glm::dvec3 place = middle + faces_.standOut(face, middle, aside) * aside;
    if (!isBlocked(place, kSkip, own_, out)) return false;
    const bool isNearest = isNearest_[point] != 0;
    if (!isNearest && isBlocked(place, kSkip, ownSurface_.around(face), out)) return true;
    const double reachPx = isNearest ? kFartherPx : OwnSurface::kReachPx;
    const glm::dvec3 farther =
        reachPx / pixelsPerGrid(scene_, place) * faces_.outward(face, along, place);
    return isBlocked(place + farther, kSkip, own_, out);
  }

  [[nodiscard]] bool
  isBlocked(const glm::dvec3& p, double skip, std::span<const FaceId> own, ResolvedLines& out) {
    ++out.rays;
    Ray ray;
    ray.origin = p;
    ray.direction = faces_.towardEye(p);
    ray.begin = skip / glm::length(ray.direction);
    if (!scene_.camera.orthographic) ray.end = 1.0;
    const std::uint32_t blocker = bvh_.findBlocker(ray, own, lastBlocker_);
    if (blocker != kNone) lastBlocker_ = blocker;
    return blocker != kNone;
  }

  // Hidden by its own two faces, whatever else there is.
  [[nodiscard]] bool isHiddenEdge(const PolylineSet::Line& line, HalfEdgeId h) const {
    const HalfEdgeId twin = mesh_.twin(h);
    if (twin == kNone || line.back != PolylineSet::Back::kNeverSeen) return false;
    const bool here = isFront_[HalfEdgeMesh::face(h)] != 0;
    const bool there = isFront_[HalfEdgeMesh::face(twin)] != 0;
    if (here != there || line.isContour()) return isConcave(mesh_, scene_.positions, h);
    // A closed surface that turns away on both sides lies behind its own front.
    return isClosed_ && !here;
  }

  // Every face that shares a corner with `face`.
  void gatherAround(FaceId face) {
    own_.clear();
    for (HalfEdgeId first = 3 * face; first < 3 * face + 3; ++first)
      forFan(mesh_, first, [&](HalfEdgeId h) { own_.push_back(HalfEdgeMesh::face(h)); });
  }

  const PolylineSet& lines_;
  std::span<const std::uint8_t> isNearest_;  // LineSpans::isNearest
  const LineScene& scene_;
  const HalfEdgeMesh& mesh_;
  SceneFaces faces_;
  const TriangleBvh& bvh_;
  bool isClosed_;
  glm::dmat4 clipFromGrid_;
  LineCrossings crossings_;
  std::vector<std::uint8_t> isFront_;  // by face
  OwnSurface ownSurface_;
  std::uint32_t lastBlocker_ = kNone;  // what hides one piece often hides the next
  // Of the segment being resolved.
  std::vector<FaceId> own_;
  std::vector<LineCrossings::Crossing> cuts_;
};

}  // namespace

VisibilityResolver::VisibilityResolver(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions)
    : bvh_(positions, mesh.triangles()),
      isClosed_(
          std::find(mesh.twins.begin(), mesh.twins.end(), HalfEdgeId{kNone}) == mesh.twins.end()) {}

ResolvedLines VisibilityResolver::resolve(
    const PolylineSet& lines,
    const LineScene& scene,
    std::span<const std::uint8_t> isDrawn) const {
  LineSpans spans;
  if (hasSmoothContours(lines)) LineSpanFinder().find(lines, isDrawn, scene, spans);
  return ViewResolver(lines, scene, bvh_, isClosed_, spans.isNearest).resolve();
}

std::vector<std::uint8_t>
segmentVisibility(const PolylineSet& lines, const ResolvedLines& resolved, const LineScene& scene) {
  const glm::dmat4 toClip = clipFromGrid(scene);
  std::vector<std::uint8_t> visible(lines.points.size(), 0);
  for (const PolylineSet::Line& line : lines.lines) {
    for (std::uint32_t k = 0; k < line.segmentCount(); ++k) {
      const std::uint32_t point = line.begin + k;
      const std::uint32_t next = point + 1 < line.end ? point + 1 : line.begin;
      const glm::dvec3 middle =
          0.5 * (glm::dvec3(lines.points[point]) + glm::dvec3(lines.points[next]));
      const glm::dvec4 clip = toClip * glm::dvec4(middle, 1.0);
      const bool isInside =
          clip.z >= -clip.w && std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w;
      if (!isInside) continue;
      for (const ResolvedLines::Piece& piece : resolved.piecesOf(point)) {
        if (piece.end < 0.5F) continue;
        visible[point] = piece.visible ? 1 : 0;
        break;
      }
    }
  }
  return visible;
}

}  // namespace limn
