// SPDX-License-Identifier: Apache-2.0
#include "server/contour/contour_loops.h"

namespace limn {

ContourLinker::ContourLinker(const SilhouetteField& field)
    : field_(field),
      slots_(
          field.kind() == SilhouetteKind::kEdges ? field.mesh().origins.size()
                                                 : field.mesh().faceCount(),
          kNone) {}

/// The half-edge of a crossed face where the smooth silhouette comes in, from a front corner to a
/// back one, or goes out; so the front is to its left.
HalfEdgeId ContourLinker::crossedEdge(FaceId face, const glm::vec4& eye, Way way) const {
  const HalfEdgeMesh& mesh = field_.mesh();
  for (HalfEdgeId h = 3 * face; h < 3 * face + 3; ++h) {
    const bool from = field_.isFront(mesh.origin(h), eye);
    const bool to = field_.isFront(mesh.target(h), eye);
    if (from != to && from == (way == Way::kIn)) return h;
  }
  return kNone;
}

/// Where the smooth silhouette crosses an edge, on the finer grid.
glm::ivec3 ContourLinker::crossing(HalfEdgeId edge, const glm::vec4& eye) const {
  const std::uint32_t a = field_.mesh().origin(edge);
  const std::uint32_t b = field_.mesh().target(edge);
  const double va = field_.value(a, eye);
  const double vb = field_.value(b, eye);
  const glm::dvec3 from(field_.positions()[a]);
  const glm::dvec3 to(field_.positions()[b]);
  constexpr double kScale = 1 << kSmoothContourBits;
  // One value is above 0 and the other is not, so they differ.
  return glm::ivec3(glm::round((from + va / (va - vb) * (to - from)) * kScale));
}

/// The place of the segment that goes on from one, kNone at a border.
std::uint32_t ContourLinker::successorOf(std::uint32_t segment, const glm::vec4& eye) const {
  const HalfEdgeMesh& mesh = field_.mesh();
  if (field_.kind() == SilhouetteKind::kSmooth) {
    const HalfEdgeId across = mesh.twin(crossedEdge(segment, eye, Way::kOut));
    return across == kNone ? kNone : slots_[HalfEdgeMesh::face(across)];
  }
  // Through the front faces around its target, until the next edge with a back face beyond.
  HalfEdgeId h = HalfEdgeMesh::next(segment);
  while (slots_[h] == kNone) {
    if (mesh.twin(h) == kNone) return kNone;
    h = HalfEdgeMesh::next(mesh.twin(h));
    if (h == HalfEdgeMesh::next(segment)) return kNone;
  }
  return slots_[h];
}

void ContourLinker::appendLine(std::uint32_t first, const glm::vec4& eye, ContourLines& lines) {
  const HalfEdgeMesh& mesh = field_.mesh();
  const bool smooth = field_.kind() == SilhouetteKind::kSmooth;
  ContourLines::Line line;
  line.begin = static_cast<std::uint32_t>(lines.points.size());
  std::uint32_t last = first;
  for (std::uint32_t i = first; i != kNone && isDone_[i] == 0; i = next_[i]) {
    const std::uint32_t segment = segments_[i];
    lines.points.push_back(
        smooth ? crossing(crossedEdge(segment, eye, Way::kIn), eye)
               : field_.positions()[mesh.origin(segment)]);
    isDone_[i] = 1;
    last = i;
  }
  line.closed = next_[last] == first;
  if (!line.closed) {
    const std::uint32_t segment = segments_[last];
    lines.points.push_back(
        smooth ? crossing(crossedEdge(segment, eye, Way::kOut), eye)
               : field_.positions()[mesh.target(segment)]);
  }
  line.end = static_cast<std::uint32_t>(lines.points.size());
  lines.lines.push_back(line);
}

ContourLines ContourLinker::link(const SilhouetteView& view, const SilhouetteResult& found) {
  const bool smooth = field_.kind() == SilhouetteKind::kSmooth;
  segments_ = smooth ? found.faces : found.edges;
  const auto count = static_cast<std::uint32_t>(segments_.size());
  const glm::vec4 eye = field_.eyeOf(view);
  ContourLines lines;
  lines.extraBits = smooth ? kSmoothContourBits : 0;
  lines.points.reserve(count + 16);
  for (std::uint32_t i = 0; i < count; ++i)
    slots_[segments_[i]] = i;
  next_.resize(count);
  isDone_.assign(count, 0);
  std::vector<std::uint8_t> isContinued(count, 0);
  for (std::uint32_t i = 0; i < count; ++i) {
    next_[i] = successorOf(segments_[i], eye);
    if (next_[i] != kNone) isContinued[next_[i]] = 1;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (isContinued[i] == 0) appendLine(i, eye, lines);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (isDone_[i] == 0) appendLine(i, eye, lines);
  }
  for (const std::uint32_t segment : segments_)
    slots_[segment] = kNone;
  return lines;
}

}  // namespace limn
