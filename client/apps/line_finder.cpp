// SPDX-License-Identifier: Apache-2.0
#include "client/apps/line_finder.h"

#include "client/stroke/chain/crease_noise.h"
#include "client/stroke/chain/panel_edges.h"

#include "shared/mesh/cracks.h"

#include <chrono>
#include <utility>

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

bool isChosen(LineKind kind, const FeatureChoice& choice) {
  switch (kind) {
    case LineKind::kSilhouette:
      return true;
    case LineKind::kCrease:
      return choice.crease;
    case LineKind::kBorder:
      return choice.border;
    case LineKind::kSeam:
      return choice.seam;
    default:
      return false;
  }
}

/// Appends the segments of a line for which isWanted(point) holds, as one line or in pieces.
template <class IsWanted>
void appendWanted(
    const PolylineSet& from,
    const PolylineSet::Line& line,
    IsWanted isWanted,
    PolylineSet& to) {
  const std::uint32_t segments = line.segmentCount();
  const std::uint32_t size = line.end - line.begin;
  std::uint32_t first = 0;
  while (first < segments && isWanted(line.begin + first))
    ++first;
  if (first == segments) {
    appendLine(from, line, to);
    return;
  }
  PolylineSet::Line piece = line;
  // A loop is read from a segment that is left out, so that no piece is split at its start.
  if (!line.closed) first = 0;
  piece.closed = false;
  bool isOpen = false;
  for (std::uint32_t k = 0; k <= segments; ++k) {
    const std::uint32_t point = line.begin + (first + k) % size;
    if (k < segments && isWanted(point)) {
      if (!isOpen) piece.begin = static_cast<std::uint32_t>(to.points.size());
      isOpen = true;
      appendPoint(from, point, to);
    } else if (isOpen) {
      appendPoint(from, point, to);
      to.halfEdges.back() = kNone;
      to.faces.back() = kNone;
      piece.end = static_cast<std::uint32_t>(to.points.size());
      to.lines.push_back(piece);
      isOpen = false;
    }
  }
}

}  // namespace

LineFinder::LineFinder(
    std::shared_ptr<const MeshSnapshot> snapshot,
    const LineFinderOptions& options)
    : snapshot_(std::move(snapshot)),
      light_(options.light),
      field_(snapshot_->mesh.mesh(), snapshot_->mesh.positions(), options.silhouette) {
  DetectorOptions detector = options.parameters;
  detector.seeds = snapshot_->seeds.get();
  detector.slotOf = [&mesh = snapshot_->mesh](VertexId v) {
    return mesh.holds(v) ? mesh.slotOf(v) : kNone;
  };
  if (options.imageSeeds) {
    detector.imageFaces = [this, find = options.imageSeeds](const SilhouetteView&) {
      return find(*snapshot_, camera_);
    };
  }
  const bool hasCones =
      options.detector == DetectorMethod::kCones || options.detector == DetectorMethod::kExact;
  if (hasCones && options.cones != nullptr && options.cones->kind() == options.silhouette)
    detector.cones = options.cones->conesOf(snapshot_, field_);
  detector_ = makeDetector(options.detector, field_, detector);
  Cracks cracks = findCracks(snapshot_->mesh.mesh(), snapshot_->mesh.positions());
  const std::vector<std::uint8_t> features = withoutNoise(
      snapshot_->mesh.mesh(),
      snapshot_->mesh.positions(),
      snapshot_->mesh.features(),
      cracks.kinds);
  if (options.features.crease && options.silhouette == SilhouetteKind::kSmooth)
    creaseContours_.emplace(
        field_,
        withPanelEdges(
            snapshot_->mesh.mesh(),
            snapshot_->mesh.positions(),
            features,
            snapshot_->model.sphere.radius / snapshot_->model.grid.step),
        cracks.parts);
  openSurfaces_.emplace(snapshot_->mesh.mesh(), snapshot_->mesh.positions(), cracks);
  acrossCracks_ = std::move(cracks.across);
  const PolylineSet all = chainFeatures(
      snapshot_->mesh.mesh(),
      snapshot_->mesh.positions(),
      features,
      {.cracks = cracks.kinds});
  for (const PolylineSet::Line& line : all.lines) {
    if (isChosen(line.kind, options.features)) appendLine(all, line, features_);
  }
  if (options.features.surface.any()) {
    surfaceLines_.emplace(
        snapshot_->mesh.mesh(),
        snapshot_->mesh.positions(),
        features,
        options.features.surface);
  }
  isContour_.assign(snapshot_->mesh.mesh().origins.size(), 0);
}

LineFinder::Lines LineFinder::find(const Camera& camera) {
  const SilhouetteView view = viewOf(camera);
  Lines result;
  auto begin = Clock::now();
  const SilhouetteResult& found = detector_->detect(view);
  result.detectMs = millisecondsSince(begin);
  begin = Clock::now();
  const PolylineSet& silhouettes = creaseContours_ ? creaseContours_->chain(view, found, chainer_)
                                                   : chainer_.chain(field_, view, found);
  result.chainMs = millisecondsSince(begin);
  result.stats = found.stats;
  for (const PolylineSet::Line& line : silhouettes.lines)
    result.loops += line.closed ? 1 : 0;
  result.lines = silhouettes;
  for (PolylineSet::Line& line : result.lines.lines)
    line.onSurface = light_.has_value();
  appendFeatures(silhouettes, view, result.lines);
  if (surfaceLines_) {
    begin = Clock::now();
    surfaceLines_->append(view, result.lines);
    result.chainMs += millisecondsSince(begin);
  }
  openSurfaces_->markBacks(view, result.lines);
  return result;
}

/// Features but for those that are silhouettes from here: each edge is drawn once. A cracked crease
/// whose sides face differently is no silhouette to any detector, but as strong as a border.
void LineFinder::appendFeatures(
    const PolylineSet& silhouettes,
    const SilhouetteView& view,
    PolylineSet& lines) {
  const HalfEdgeMesh& mesh = snapshot_->mesh.mesh();
  const std::span<const glm::ivec3> positions = snapshot_->mesh.positions();
  const auto markContours = [&](std::uint8_t mark) {
    for (const PolylineSet::Line& line : silhouettes.lines) {
      for (std::uint32_t k = 0; k < line.segmentCount(); ++k) {
        const std::uint32_t point = line.begin + k;
        const std::uint32_t next = point + 1 < line.end ? point + 1 : line.begin;
        const HalfEdgeId h = silhouettes.halfEdges[point];
        // A part of an edge is no reason to leave out the whole.
        if (h == kNone || mesh.twin(h) == kNone ||
            silhouettes.points[point] != glm::vec3(positions[mesh.origin(h)]) ||
            silhouettes.points[next] != glm::vec3(positions[mesh.target(h)])) {
          continue;
        }
        isContour_[h] = mark;
        isContour_[mesh.twin(h)] = mark;
      }
    }
  };
  markContours(1);
  const auto isFront = [&](FaceId face) {
    const glm::dvec3 a(positions[mesh.origin(3 * face)]);
    const glm::dvec3 n = glm::cross(
        glm::dvec3(positions[mesh.origin(3 * face + 1)]) - a,
        glm::dvec3(positions[mesh.origin(3 * face + 2)]) - a);
    return glm::dot(n, view.orthographic ? -view.forward : view.eye - a) > 0.0;
  };
  const auto isOutline = [&](HalfEdgeId h) {
    const FaceId across = acrossCracks_[h];
    return across != kNone && isFront(HalfEdgeMesh::face(h)) != isFront(across);
  };
  for (const PolylineSet::Line& line : features_.lines) {
    bool hasOutline = false;
    const auto isPlain = [&](std::uint32_t point) {
      const HalfEdgeId h = features_.halfEdges[point];
      if (isOutline(h)) hasOutline = true;
      return isContour_[h] == 0 && !isOutline(h);
    };
    appendWanted(features_, line, isPlain, lines);
    if (!hasOutline) continue;
    PolylineSet::Line outline = line;
    outline.kind = LineKind::kBorder;
    appendWanted(
        features_,
        outline,
        [&](std::uint32_t point) { return isOutline(features_.halfEdges[point]); },
        lines);
  }
  markContours(0);
}

double LineFinder::recallFrom(const Camera& camera) {
  const SilhouetteView view = viewOf(camera);
  const auto brute = makeDetector(DetectorMethod::kBrute, field_);
  return recall(detector_->detect(view), brute->detect(view));
}

SilhouetteView LineFinder::viewOf(const Camera& camera) {
  camera_ = camera;
  SilhouetteView view;
  if (light_) {
    view.eye = snapshot_->model.grid.fromModel(*light_);
    return view;
  }
  view.eye = snapshot_->model.grid.fromModel(camera.eye);
  view.forward = camera.forward();
  view.orthographic = camera.orthographic;
  return view;
}

}  // namespace limn
