// SPDX-License-Identifier: Apache-2.0
// Based on: M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 3.3:
// chaining through half-edges, loops closed, directions made consistent.
// Deviations: direction is consistent by construction (front to the left), so nothing is flipped
// afterwards; where several silhouette edges meet, rotating through the front sector pairs them
// one to one; marks carry a frame number instead of being cleared.
#include "client/stroke/chain.h"

#include "shared/silhouette/trace.h"

#include <algorithm>

namespace limn {
namespace {

// Marks of a face: bits 0–2, its half-edges that are segments (bit 0: the face, when smooth); bits
// 3–5, those already chained; above, the frame.
constexpr std::uint32_t kMarkBits = 6;
constexpr std::uint32_t kUsedShift = 3;
constexpr std::uint32_t kLastFrame = (1U << (32 - kMarkBits)) - 1;

// The marks of one frame.
class Marks {
 public:
  Marks(std::vector<std::uint32_t>& marks, std::uint32_t frame)
      : marks_(marks.data()),
        frame_(frame << kMarkBits) {}

  void add(FaceId f, std::uint32_t bit) {
    if ((marks_[f] ^ frame_) >> kMarkBits != 0) marks_[f] = frame_;
    marks_[f] |= 1U << bit;
  }

  void use(FaceId f, std::uint32_t bit) { marks_[f] |= 1U << (bit + kUsedShift); }

  [[nodiscard]] bool has(FaceId f, std::uint32_t bit) const {
    return (marks_[f] ^ frame_) >> kMarkBits == 0 && (marks_[f] >> bit & 1U) != 0;
  }

  [[nodiscard]] bool isUsed(FaceId f, std::uint32_t bit) const { return has(f, bit + kUsedShift); }

 private:
  std::uint32_t* marks_;
  std::uint32_t frame_;
};

// Silhouette half-edges h, front face to the left.
class EdgeWalk {
 public:
  EdgeWalk(const HalfEdgeMesh& mesh, Marks marks) : mesh_(&mesh), marks_(marks) {}

  void add(HalfEdgeId h) { marks_.add(h / 3, h % 3); }

  void use(HalfEdgeId h) { marks_.use(h / 3, h % 3); }

  [[nodiscard]] bool isUsed(HalfEdgeId h) const { return marks_.isUsed(h / 3, h % 3); }

  // The silhouette half-edge that leaves h's target along the same front sector; kNone at a border,
  // or once round when the silhouette was not found there.
  [[nodiscard]] HalfEdgeId successor(HalfEdgeId h) const {
    const HalfEdgeId last = mesh_->twins[h];
    for (HalfEdgeId g = HalfEdgeMesh::next(h); g != kNone && g != last; g = mesh_->rotateCw(g)) {
      if (marks_.has(g / 3, g % 3)) return g;
    }
    return kNone;
  }

  // The inverse of successor.
  [[nodiscard]] HalfEdgeId predecessor(HalfEdgeId h) const {
    const HalfEdgeId last = mesh_->twins[h];
    for (HalfEdgeId g = HalfEdgeMesh::prev(h); g != last;) {
      if (marks_.has(g / 3, g % 3)) return g;
      const HalfEdgeId across = mesh_->twins[g];
      if (across == kNone) return kNone;
      g = HalfEdgeMesh::prev(across);
    }
    return kNone;
  }

 private:
  const HalfEdgeMesh* mesh_;
  Marks marks_;
};

void append(PolylineSet& set, const glm::vec3& point, HalfEdgeId h, FaceId f) {
  set.points.push_back(point);
  set.halfEdges.push_back(h);
  set.faces.push_back(f);
}

std::uint32_t sizeOf(const PolylineSet& set) {
  return static_cast<std::uint32_t>(set.points.size());
}

// Puts what was appended from `middle` on, back to front, before [begin, middle).
template <class T>
void moveReversedToFront(std::vector<T>& values, std::uint32_t begin, std::uint32_t middle) {
  std::reverse(values.begin() + middle, values.end());
  std::rotate(values.begin() + begin, values.begin() + middle, values.end());
}

void moveReversedToFront(PolylineSet& set, std::uint32_t begin, std::uint32_t middle) {
  moveReversedToFront(set.points, begin, middle);
  moveReversedToFront(set.halfEdges, begin, middle);
  moveReversedToFront(set.faces, begin, middle);
}

}  // namespace

const PolylineSet& SilhouetteChainer::chain(
    const SilhouetteField& field,
    const SilhouetteView& view,
    const SilhouetteResult& found) {
  lines_.points.clear();
  lines_.lines.clear();
  lines_.halfEdges.clear();
  lines_.faces.clear();
  beginFrame(field.mesh().faceCount());
  if (found.kind == SilhouetteKind::kEdges) {
    chainEdges(field, found);
  } else {
    chainSmooth(field, field.eyeOf(view), found);
  }
  return lines_;
}

void SilhouetteChainer::beginFrame(std::size_t faces) {
  if (marks_.size() != faces || frame_ == kLastFrame) {
    marks_.assign(faces, 0);
    frame_ = 0;
  }
  ++frame_;
}

void SilhouetteChainer::chainEdges(const SilhouetteField& field, const SilhouetteResult& found) {
  const HalfEdgeMesh& mesh = field.mesh();
  EdgeWalk walk(mesh, Marks(marks_, frame_));
  for (const HalfEdgeId h : found.edges)
    walk.add(h);
  const auto emit = [&](HalfEdgeId h) {
    walk.use(h);
    append(lines_, glm::vec3(field.positions()[mesh.origin(h)]), h, HalfEdgeMesh::face(h));
  };
  for (const HalfEdgeId first : found.edges) {
    if (walk.isUsed(first)) continue;
    PolylineSet::Line line;
    line.begin = sizeOf(lines_);
    HalfEdgeId last = first;
    HalfEdgeId following = first;
    do {
      last = following;
      emit(last);
      following = walk.successor(last);
    } while (following != kNone && !walk.isUsed(following));
    line.closed = following == first;
    if (!line.closed) {
      append(lines_, glm::vec3(field.positions()[mesh.target(last)]), kNone, kNone);
      const std::uint32_t middle = sizeOf(lines_);
      for (HalfEdgeId h = walk.predecessor(first); h != kNone && !walk.isUsed(h);
           h = walk.predecessor(h)) {
        emit(h);
      }
      moveReversedToFront(lines_, line.begin, middle);
    }
    line.end = sizeOf(lines_);
    lines_.lines.push_back(line);
  }
}

void SilhouetteChainer::chainSmooth(
    const SilhouetteField& field,
    const glm::vec4& eye,
    const SilhouetteResult& found) {
  Marks marks(marks_, frame_);
  for (const FaceId f : found.faces)
    marks.add(f, 0);
  const auto isFree = [&](FaceId f) { return marks.has(f, 0) && !marks.isUsed(f, 0); };
  SmoothWalk walk(field, eye);
  const auto emit = [&] {
    marks.use(walk.face(), 0);
    append(lines_, walk.entryPoint(), kNone, walk.face());
  };
  for (const FaceId first : found.faces) {
    if (marks.isUsed(first, 0) || !walk.start(first)) continue;
    PolylineSet::Line line;
    line.begin = sizeOf(lines_);
    glm::vec3 end{0.0F};
    bool isInside = true;
    do {
      emit();
      end = walk.exitPoint();
      isInside = walk.advance();
    } while (isInside && isFree(walk.face()));
    line.closed = isInside && walk.face() == first;
    if (!line.closed) {
      append(lines_, end, kNone, kNone);
      const std::uint32_t middle = sizeOf(lines_);
      walk.start(first);
      while (walk.retreat() && isFree(walk.face()))
        emit();
      moveReversedToFront(lines_, line.begin, middle);
    }
    line.end = sizeOf(lines_);
    lines_.lines.push_back(line);
  }
}

}  // namespace limn
