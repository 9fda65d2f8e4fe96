// SPDX-License-Identifier: Apache-2.0
// Based on: M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 3.2.4:
// silhouettes precomputed for a grid of viewpoints give the seeds.
// Deviations: seeds are vertices of a progressive mesh, so one that is not refined yet stands for
// its nearest ancestor; from a seed the search walks downhill in |normal · view| instead of testing
// a fixed neighbourhood; several viewpoints may give seeds at once.
#include "shared/silhouette/precomputed.h"

#include "shared/silhouette/trace.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {
namespace {

constexpr float kEndless = std::numeric_limits<float>::max();
constexpr std::uint32_t kMarkBits = 3;
constexpr std::uint32_t kLastFrame = (1U << (32 - kMarkBits)) - 1;

// The slot that each node of a table stands for: its own, else its nearest held ancestor's.
std::vector<std::uint32_t>
slotsOfNodes(const SeedTable& table, const SlotLookup& slotOf, std::uint32_t vertexCount) {
  std::vector<std::uint32_t> slots(table.nodes.size(), kNone);
  for (std::size_t i = 0; i < table.nodes.size(); ++i) {
    const SeedTable::Node& node = table.nodes[i];
    const Slot own = slotOf ? slotOf(node.vertex) : node.vertex;
    if (own < vertexCount) {
      slots[i] = own;
    } else if (node.parent < i) {  // parents come before children
      slots[i] = slots[node.parent];
    }
  }
  return slots;
}

// How far a plane is from edge-on, comparable between faces of different size.
float steepness(const SilhouetteField& field, std::uint32_t site, const glm::vec4& eye) {
  const float length = glm::length(glm::vec3(field.planes()[site]));
  return length > 0.0F ? std::abs(field.value(site, eye)) / length : 0.0F;
}

}  // namespace

PrecomputedDetector::PrecomputedDetector(
    const SilhouetteField& field,
    const DetectorOptions& options)
    : field_(&field),
      viewpoints_(options.seedViewpoints),
      steps_(options.seedSearchSteps),
      marks_(field.mesh().faceCount(), 0) {
  if (options.seeds == nullptr) return;
  const SeedTable& table = *options.seeds;
  directions_ = table.directions;
  const auto slots = slotsOfNodes(table, options.slotOf, field.mesh().vertexCount());
  slotBegin_.push_back(0);
  for (std::size_t v = 0; v + 1 < table.seedBegin.size(); ++v) {
    for (std::uint32_t i = table.seedBegin[v]; i < table.seedBegin[v + 1]; ++i) {
      const std::uint32_t node = i < table.seeds.size() ? table.seeds[i] : kNone;
      const std::uint32_t slot = node < slots.size() ? slots[node] : kNone;
      // Seeds that share an ancestor are one.
      if (slot != kNone &&
          std::find(slots_.begin() + slotBegin_.back(), slots_.end(), slot) == slots_.end()) {
        slots_.push_back(slot);
      }
    }
    slotBegin_.push_back(static_cast<std::uint32_t>(slots_.size()));
  }
  directions_.resize(std::min(directions_.size(), slotBegin_.size() - 1));
}

const SilhouetteResult& PrecomputedDetector::detect(const SilhouetteView& view) {
  const glm::vec4 eye = field_->eyeOf(view);
  result_.kind = field_->kind();
  result_.edges.clear();
  result_.faces.clear();
  result_.stats = {};
  if (frame_ == kLastFrame) {
    std::fill(marks_.begin(), marks_.end(), 0);
    frame_ = 0;
  }
  ++frame_;
  chooseViewpoints(glm::vec3(eye));
  for (const std::uint32_t v : nearest_) {
    for (std::uint32_t i = slotBegin_[v]; i < slotBegin_[v + 1]; ++i) {
      ++result_.stats.seedsTried;
      if (field_->kind() == SilhouetteKind::kEdges) {
        searchEdges(slots_[i], eye);
      } else {
        searchSmooth(slots_[i], eye);
      }
    }
  }
  result_.stats.segments = static_cast<std::uint32_t>(result_.edges.size() + result_.faces.size());
  result_.stats.facesVisited += result_.stats.segments;
  return result_;
}

void PrecomputedDetector::chooseViewpoints(const glm::vec3& toEye) {
  nearest_.resize(directions_.size());
  for (std::uint32_t v = 0; v < nearest_.size(); ++v)
    nearest_[v] = v;
  const auto count = std::min(nearest_.size(), static_cast<std::size_t>(std::max(viewpoints_, 0)));
  std::partial_sort(
      nearest_.begin(),
      nearest_.begin() + static_cast<std::ptrdiff_t>(count),
      nearest_.end(),
      [&](std::uint32_t a, std::uint32_t b) {
        return glm::dot(directions_[a], toEye) > glm::dot(directions_[b], toEye);
      });
  nearest_.resize(count);
}

bool PrecomputedDetector::isOnPath(std::uint32_t site) const {
  return std::find(path_.begin(), path_.end(), site) != path_.end();
}

// From the faces around a vertex on to the neighbour nearest to edge-on, never back, until one
// faces the other way.
void PrecomputedDetector::searchEdges(std::uint32_t slot, const glm::vec4& eye) {
  const HalfEdgeMesh& mesh = field_->mesh();
  const HalfEdgeId out = mesh.outgoing[slot];
  if (out == kNone) return;
  FaceId face = HalfEdgeMesh::face(out);
  float best = steepness(*field_, face, eye);
  for (HalfEdgeId h = mesh.rotateCcw(out); h != kNone && h != out; h = mesh.rotateCcw(h)) {
    const float s = steepness(*field_, HalfEdgeMesh::face(h), eye);
    ++result_.stats.facesVisited;
    if (s < best) {
      best = s;
      face = HalfEdgeMesh::face(h);
    }
  }
  path_.clear();
  for (int step = 0; step < steps_; ++step) {
    const bool isFront = field_->isFront(face, eye);
    path_.push_back(face);
    best = kEndless;
    FaceId next = kNone;
    for (HalfEdgeId h = 3 * face; h < 3 * face + 3; ++h) {
      const HalfEdgeId twin = mesh.twins[h];
      if (twin == kNone) continue;
      ++result_.stats.facesVisited;
      if (field_->isFront(HalfEdgeMesh::face(twin), eye) != isFront) {
        traceEdges(isFront ? h : twin, eye);
        return;
      }
      const float s = steepness(*field_, HalfEdgeMesh::face(twin), eye);
      if (s < best && !isOnPath(HalfEdgeMesh::face(twin))) {
        best = s;
        next = HalfEdgeMesh::face(twin);
      }
    }
    if (next == kNone) return;
    face = next;
  }
}

// The same from vertex to vertex, until one is on the other side.
void PrecomputedDetector::searchSmooth(std::uint32_t slot, const glm::vec4& eye) {
  const HalfEdgeMesh& mesh = field_->mesh();
  path_.clear();
  for (int step = 0; step < steps_; ++step) {
    const bool isFront = field_->isFront(slot, eye);
    path_.push_back(slot);
    float best = kEndless;
    const HalfEdgeId out = mesh.outgoing[slot];
    std::uint32_t next = kNone;
    for (HalfEdgeId h = out; h != kNone;) {
      ++result_.stats.facesVisited;
      // Both other corners: at a border the last one starts no half-edge out of here.
      for (const std::uint32_t v : {mesh.target(h), mesh.origins[HalfEdgeMesh::prev(h)]}) {
        if (field_->isFront(v, eye) != isFront) {
          traceSmooth(HalfEdgeMesh::face(h), eye);
          return;
        }
        const float value = std::abs(field_->value(v, eye));
        if (value < best && !isOnPath(v)) {
          best = value;
          next = v;
        }
      }
      h = mesh.rotateCcw(h);
      if (h == out) break;
    }
    if (next == kNone) return;
    slot = next;
  }
}

// False when it was marked in this frame already.
bool PrecomputedDetector::mark(FaceId f, std::uint32_t bit) {
  std::uint32_t& m = marks_[f];
  if (m >> kMarkBits != frame_) m = frame_ << kMarkBits;
  if ((m >> bit & 1U) != 0) return false;
  m |= 1U << bit;
  return true;
}

void PrecomputedDetector::traceEdges(HalfEdgeId first, const glm::vec4& eye) {
  HalfEdgeId h = first;
  while (h != kNone && mark(HalfEdgeMesh::face(h), h % 3)) {
    result_.edges.push_back(h);
    h = nextSilhouetteEdge(*field_, eye, h);
  }
  if (h != kNone) return;
  h = previousSilhouetteEdge(*field_, eye, first);
  while (h != kNone && mark(HalfEdgeMesh::face(h), h % 3)) {
    result_.edges.push_back(h);
    h = previousSilhouetteEdge(*field_, eye, h);
  }
}

void PrecomputedDetector::traceSmooth(FaceId first, const glm::vec4& eye) {
  SmoothWalk walk(*field_, eye);
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

std::size_t PrecomputedDetector::memoryBytes() const {
  return directions_.size() * sizeof(glm::vec3) +
         (slotBegin_.size() + slots_.size() + marks_.size() + nearest_.capacity() +
          result_.edges.capacity() + result_.faces.capacity()) *
             sizeof(std::uint32_t);
}

}  // namespace limn
