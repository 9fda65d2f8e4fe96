// SPDX-License-Identifier: Apache-2.0
// Based on: L. Markosian et al., "Real-Time Nonphotorealistic Rendering", SIGGRAPH 1997 (walking
// from a seed towards a silhouette, tracing it). M. Mohr, "Silhouette Rendering on Mobile Devices"
// (thesis, Graz 2013), sections 3.2.1 and 3.2.2 (neighbourhood search, camera motion).
// Deviations: the direction a silhouette moved in is read off the sites that changed sides between
// two eyes, which is exact, instead of from the camera's motion on the screen.
#include "shared/silhouette/tracer.h"

#include "shared/silhouette/trace.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace limn {
namespace {

constexpr float kEndless = std::numeric_limits<float>::max();

// How far a plane is from edge-on, comparable between faces of different size.
float steepness(const SilhouetteField& field, std::uint32_t site, const glm::vec4& eye) {
  const float length = glm::length(glm::vec3(field.plane(site)));
  return length > 0.0F ? std::abs(field.value(site, eye)) / length : 0.0F;
}

bool contains(const std::vector<std::uint32_t>& sites, std::uint32_t site) {
  return std::find(sites.begin(), sites.end(), site) != sites.end();
}

}  // namespace

SilhouetteTracer::SilhouetteTracer(const SilhouetteField& field)
    : field_(&field),
      marks_(field.mesh().faceCount(), 0) {
  result_.kind = field.kind();
}

void SilhouetteTracer::begin(const SilhouetteView& view) {
  constexpr std::uint32_t kLastFrame = (1U << (32 - kMarkBits)) - 1;
  eye_ = field_->eyeOf(view);
  result_.edges.clear();
  result_.faces.clear();
  result_.stats = {};
  if (frame_ == kLastFrame) {
    std::fill(marks_.begin(), marks_.end(), 0);
    frame_ = 0;
  }
  ++frame_;
}

// False when it was marked in this frame already.
bool SilhouetteTracer::mark(FaceId f, std::uint32_t bit) {
  std::uint32_t& m = marks_[f];
  if (m >> kMarkBits != frame_) m = frame_ << kMarkBits;
  if ((m >> bit & 1U) != 0) return false;
  m |= 1U << bit;
  return true;
}

bool SilhouetteTracer::visit(FaceId f) {
  if (!mark(f, kVisitedBit)) return false;
  ++result_.stats.facesVisited;
  return true;
}

bool SilhouetteTracer::take(FaceId f) {
  return field_->kind() == SilhouetteKind::kEdges ? addEdgesOf(f, Found::kTaken)
                                                  : addFace(f, Found::kTaken);
}

bool SilhouetteTracer::follow(FaceId f) {
  return field_->kind() == SilhouetteKind::kEdges ? addEdgesOf(f, Found::kFollowed)
                                                  : addFace(f, Found::kFollowed);
}

bool SilhouetteTracer::addEdgesOf(FaceId f, Found found) {
  const HalfEdgeMesh& mesh = field_->mesh();
  const bool isFront = field_->isFront(f, eye_);
  bool any = false;
  for (HalfEdgeId h = 3 * f; h < 3 * f + 3; ++h) {
    const HalfEdgeId twin = mesh.twins[h];
    if (twin == kNone || field_->isFront(HalfEdgeMesh::face(twin), eye_) == isFront) continue;
    any = true;
    const HalfEdgeId own = isFront ? h : twin;
    if (found == Found::kFollowed) {
      followEdges(own);
    } else if (mark(HalfEdgeMesh::face(own), own % 3)) {
      result_.edges.push_back(own);
    }
  }
  return any;
}

bool SilhouetteTracer::addFace(FaceId f, Found found) {
  const HalfEdgeMesh& mesh = field_->mesh();
  const bool a = field_->isFront(mesh.origins[3 * f], eye_);
  if (field_->isFront(mesh.origins[3 * f + 1], eye_) == a &&
      field_->isFront(mesh.origins[3 * f + 2], eye_) == a) {
    return false;
  }
  if (found == Found::kFollowed) {
    followSmooth(f);
  } else if (mark(f, 0)) {
    result_.faces.push_back(f);
  }
  return true;
}

void SilhouetteTracer::followEdges(HalfEdgeId first) {
  HalfEdgeId h = first;
  while (h != kNone && mark(HalfEdgeMesh::face(h), h % 3)) {
    result_.edges.push_back(h);
    h = nextSilhouetteEdge(*field_, eye_, h);
  }
  if (h != kNone) return;
  h = previousSilhouetteEdge(*field_, eye_, first);
  while (h != kNone && mark(HalfEdgeMesh::face(h), h % 3)) {
    result_.edges.push_back(h);
    h = previousSilhouetteEdge(*field_, eye_, h);
  }
}

void SilhouetteTracer::followSmooth(FaceId first) {
  SmoothWalk walk(*field_, eye_);
  if (!walk.start(first)) return;
  bool isInside = true;
  while (isInside && mark(walk.face(), 0)) {
    result_.faces.push_back(walk.face());
    isInside = walk.advance();
  }
  if (isInside) return;
  walk.start(first);
  while (walk.retreat() && mark(walk.face(), 0))
    result_.faces.push_back(walk.face());
}

// kEdges: from the faces around a vertex, the one nearest to edge-on. kSmooth: from vertex to
// vertex, never back, until one is on the other side.
bool SilhouetteTracer::walkFromVertex(std::uint32_t vertex, int steps) {
  const HalfEdgeMesh& mesh = field_->mesh();
  if (field_->kind() == SilhouetteKind::kEdges) {
    const HalfEdgeId out = mesh.outgoing[vertex];
    if (out == kNone) return false;
    FaceId face = HalfEdgeMesh::face(out);
    float best = steepness(*field_, face, eye_);
    for (HalfEdgeId h = mesh.rotateCcw(out); h != kNone && h != out; h = mesh.rotateCcw(h)) {
      ++result_.stats.facesVisited;
      const float s = steepness(*field_, HalfEdgeMesh::face(h), eye_);
      if (s >= best) continue;
      best = s;
      face = HalfEdgeMesh::face(h);
    }
    return walkFromFace(face, steps);
  }
  path_.clear();
  for (int step = 0; step < steps; ++step) {
    const bool isFront = field_->isFront(vertex, eye_);
    path_.push_back(vertex);
    float best = kEndless;
    const HalfEdgeId out = mesh.outgoing[vertex];
    std::uint32_t next = kNone;
    for (HalfEdgeId h = out; h != kNone;) {
      ++result_.stats.facesVisited;
      // Both other corners: at a border the last one starts no half-edge out of here.
      for (const std::uint32_t v : {mesh.target(h), mesh.origins[HalfEdgeMesh::prev(h)]}) {
        if (field_->isFront(v, eye_) != isFront) {
          followSmooth(HalfEdgeMesh::face(h));
          return true;
        }
        const float value = std::abs(field_->value(v, eye_));
        if (value < best && !contains(path_, v)) {
          best = value;
          next = v;
        }
      }
      h = mesh.rotateCcw(h);
      if (h == out) break;
    }
    if (next == kNone) return false;
    vertex = next;
  }
  return false;
}

// kEdges: on to the neighbour nearest to edge-on, never back, until one faces the other way.
// kSmooth: from the corner nearest to edge-on.
bool SilhouetteTracer::walkFromFace(FaceId face, int steps) {
  const HalfEdgeMesh& mesh = field_->mesh();
  if (field_->kind() == SilhouetteKind::kSmooth) {
    std::uint32_t best = mesh.origins[3 * face];
    for (HalfEdgeId h = 3 * face + 1; h < 3 * face + 3; ++h) {
      if (steepness(*field_, mesh.origins[h], eye_) < steepness(*field_, best, eye_)) {
        best = mesh.origins[h];
      }
    }
    return walkFromVertex(best, steps);
  }
  path_.clear();
  for (int step = 0; step < steps; ++step) {
    const bool isFront = field_->isFront(face, eye_);
    path_.push_back(face);
    float best = kEndless;
    FaceId next = kNone;
    for (HalfEdgeId h = 3 * face; h < 3 * face + 3; ++h) {
      const HalfEdgeId twin = mesh.twins[h];
      if (twin == kNone) continue;
      ++result_.stats.facesVisited;
      if (field_->isFront(HalfEdgeMesh::face(twin), eye_) != isFront) {
        followEdges(isFront ? h : twin);
        return true;
      }
      const float s = steepness(*field_, HalfEdgeMesh::face(twin), eye_);
      if (s < best && !contains(path_, HalfEdgeMesh::face(twin))) {
        best = s;
        next = HalfEdgeMesh::face(twin);
      }
    }
    if (next == kNone) return false;
    face = next;
  }
  return false;
}

// Whether a site of edge h is on another side than it was.
bool SilhouetteTracer::hasTurned(HalfEdgeId h, const glm::vec4& before) const {
  const HalfEdgeMesh& mesh = field_->mesh();
  const auto turned = [&](std::uint32_t site) {
    return field_->isFront(site, eye_) != field_->isFront(site, before);
  };
  if (field_->kind() == SilhouetteKind::kSmooth) {
    return turned(mesh.origin(h)) || turned(mesh.target(h));
  }
  return turned(HalfEdgeMesh::face(h)) || turned(HalfEdgeMesh::face(mesh.twins[h]));
}

void SilhouetteTracer::searchAround(FaceId f, int rings, Found found, const glm::vec4* before) {
  const HalfEdgeMesh& mesh = field_->mesh();
  ring_.assign(1, f);
  for (int r = 0; r < rings && !ring_.empty(); ++r) {
    nextRing_.clear();
    for (const FaceId center : ring_) {
      for (HalfEdgeId h = 3 * center; h < 3 * center + 3; ++h) {
        if (mesh.twins[h] == kNone || (before != nullptr && !hasTurned(h, *before))) continue;
        const FaceId g = HalfEdgeMesh::face(mesh.twins[h]);
        if (!visit(g)) continue;
        if (!(found == Found::kTaken ? take(g) : follow(g))) nextRing_.push_back(g);
      }
    }
    std::swap(ring_, nextRing_);
  }
}

void SilhouetteTracer::adopt(const SilhouetteResult& complete) {
  for (const HalfEdgeId h : complete.edges) {
    if (mark(HalfEdgeMesh::face(h), h % 3)) result_.edges.push_back(h);
  }
  for (const FaceId f : complete.faces) {
    if (mark(f, 0)) result_.faces.push_back(f);
  }
  result_.stats.facesVisited += complete.stats.facesVisited;
  result_.stats.sitesTested += complete.stats.sitesTested;
}

const SilhouetteResult& SilhouetteTracer::finish() {
  result_.stats.segments = static_cast<std::uint32_t>(segmentCount());
  return result_;
}

std::size_t SilhouetteTracer::memoryBytes() const {
  return (marks_.size() + path_.capacity() + ring_.capacity() + nextRing_.capacity() +
          result_.edges.capacity() + result_.faces.capacity()) *
         sizeof(std::uint32_t);
}

}  // namespace limn
