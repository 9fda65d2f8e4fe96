// SPDX-License-Identifier: Apache-2.0
// Based on: A. Hertzmann, D. Zorin, "Illustrating Smooth Surfaces", SIGGRAPH 2000, for silhouettes
// as the zero set of the interpolated normal · view.
// Deviation: the normals of a piecewise smooth surface, as in H. Hoppe et al., "Piecewise Smooth
// Surface Reconstruction", SIGGRAPH 1994: one for each sector between creases.
#include "client/stroke/chain/crease_contours.h"

#include "shared/progressive/vertex_split.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace limn {
namespace {

/// Pieces that a crack interrupts go on within this, grid units.
constexpr float kCrackWidth = 3.0F;

bool isCreaseAt(const HalfEdgeMesh& mesh, std::span<const std::uint8_t> features, HalfEdgeId h) {
  const HalfEdgeId twin = mesh.twins[h];
  return twin != kNone && ((features[h] | features[twin]) & kFeatureCrease) != 0;
}

auto keyOf(const glm::vec3& p) {
  return std::tuple(p.x, p.y, p.z);
}

void append(PolylineSet& set, const glm::vec3& point, HalfEdgeId h, FaceId f) {
  set.points.push_back(point);
  set.halfEdges.push_back(h);
  set.faces.push_back(f);
}

}  // namespace

CreaseContours::CreaseContours(
    const SilhouetteField& field,
    std::span<const std::uint8_t> features,
    std::span<const CrackPart> cracks)
    : field_(field) {
  const HalfEdgeMesh& mesh = field.mesh();
  if (field.kind() != SilhouetteKind::kSmooth) return;
  sectors_ = mesh.origins;
  isSharp_.assign(mesh.faceCount(), 0);
  if (features.size() == mesh.origins.size()) divideAtCreases(features);
  const auto sitesOf = [&](HalfEdgeId h) {
    return std::array<std::uint32_t, 2>{sectors_[h], sectors_[HalfEdgeMesh::next(h)]};
  };
  for (const CrackPart& part : cracks)
    cracks_.push_back({part, sitesOf(part.here), sitesOf(part.there)});
}

void CreaseContours::divideAtCreases(std::span<const std::uint8_t> features) {
  const HalfEdgeMesh& mesh = field_.mesh();
  std::vector<std::uint8_t> isCrease(features.size(), 0);
  std::vector<std::uint8_t> creasesAt(mesh.vertexCount(), 0);
  bool hasCreases = false;
  for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
    if (!isCreaseAt(mesh, features, h)) continue;
    isCrease[h] = 1;
    std::uint8_t& count = creasesAt[mesh.origin(h)];
    count = static_cast<std::uint8_t>(std::min(count + 1, 2));
    hasCreases = true;
  }
  if (!hasCreases) return;
  for (std::uint32_t v = 0; v < mesh.vertexCount(); ++v) {
    // One crease alone divides a vertex only where a border does the rest.
    if (creasesAt[v] == 2 || (creasesAt[v] == 1 && mesh.isBorderVertex(v))) divide(v, isCrease);
  }
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    const std::array<std::uint32_t, 3> sites = {
        sectors_[3 * f],
        sectors_[3 * f + 1],
        sectors_[3 * f + 2]};
    if (std::max({sites[0], sites[1], sites[2]}) < mesh.vertexCount()) continue;
    isSharp_[f] = 1;
    faces_.push_back({f, sites});
  }
  for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
    if (h > mesh.twins[h] || isCrease[h] == 0) continue;
    const HalfEdgeId twin = mesh.twins[h];
    const Crease crease{
        h,
        {sectors_[h], sectors_[HalfEdgeMesh::next(h)]},
        {sectors_[HalfEdgeMesh::next(twin)], sectors_[twin]}};
    if (crease.left != crease.right) creases_.push_back(crease);
  }
}

/// Gives each sector of faces around a vertex a plane of its own: the angle-weighted mean normal.
void CreaseContours::divide(std::uint32_t vertex, std::span<const std::uint8_t> isCrease) {
  const HalfEdgeMesh& mesh = field_.mesh();
  const std::span<const glm::ivec3> positions = field_.positions();
  // From a crease or border, so that no sector is cut at an arbitrary place.
  HalfEdgeId first = mesh.outgoing[vertex];
  if (!mesh.isBorderVertex(vertex)) {
    while (isCrease[first] == 0)
      first = mesh.rotateCcw(first);
  }
  const glm::dvec3 at(positions[vertex]);
  glm::dvec3 sum(0.0);
  std::vector<HalfEdgeId> corners;
  const auto finish = [&] {
    const double length = glm::length(sum);
    glm::vec4 plane(0.0F);
    if (length > 1e-9) {
      const glm::vec3 n(sum / length);
      plane = glm::vec4(
          n,
          static_cast<float>(-glm::dot(glm::dvec3(n), at - glm::dvec3(field_.center()))));
    }
    const auto site = static_cast<std::uint32_t>(mesh.vertexCount() + planes_.size());
    planes_.push_back(plane);
    for (const HalfEdgeId h : corners)
      sectors_[h] = site;
    corners.clear();
    sum = glm::dvec3(0.0);
  };
  HalfEdgeId h = first;
  do {
    const glm::dvec3 u = glm::dvec3(positions[mesh.target(h)]) - at;
    const glm::dvec3 v = glm::dvec3(positions[mesh.origin(HalfEdgeMesh::prev(h))]) - at;
    const glm::dvec3 normal = glm::cross(u, v);
    const double area = glm::length(normal);
    if (area > 0.0) sum += normal * (std::atan2(area, glm::dot(u, v)) / area);
    corners.push_back(h);
    h = mesh.rotateCcw(h);
    if (h == kNone || h == first || isCrease[h] != 0) finish();
  } while (h != kNone && h != first);
}

float CreaseContours::valueOf(std::uint32_t site) const {
  const std::uint32_t vertices = field_.mesh().vertexCount();
  return site < vertices ? field_.value(site, eye_)
                         : SilhouetteField::valueAt(planes_[site - vertices], eye_);
}

/// The same point as SmoothWalk's, to the last bit.
glm::vec3 CreaseContours::crossing(
    std::uint32_t front,
    float frontValue,
    std::uint32_t back,
    float backValue) const {
  const glm::ivec3& p = field_.positions()[front];
  const float t = frontValue / (frontValue - backValue);
  return glm::vec3(p) + t * glm::vec3(field_.positions()[back] - p);
}

const PolylineSet& CreaseContours::chain(
    const SilhouetteView& view,
    const SilhouetteResult& found,
    SilhouetteChainer& chainer) {
  if (isEmpty()) return chainer.chain(field_, view, found);
  eye_ = field_.eyeOf(view);
  away_.kind = SilhouetteKind::kSmooth;
  away_.faces.clear();
  for (const FaceId f : found.faces) {
    if (isSharp_[f] == 0) away_.faces.push_back(f);
  }
  const PolylineSet& smooth = chainer.chain(field_, view, away_);
  pieces_.clear();
  for (std::uint32_t i = 0; i < smooth.lines.size(); ++i) {
    const PolylineSet::Line& line = smooth.lines[i];
    if (line.closed) continue;
    pieces_.push_back({smooth.points[line.begin], smooth.points[line.end - 1], kNone, kNone, i});
  }
  findPieces();
  linkPieces();
  readLines(smooth);
  return lines_;
}

void CreaseContours::findPieces() {
  const HalfEdgeMesh& mesh = field_.mesh();
  for (const SharpFace& sharp : faces_) {
    const std::array<float, 3> values = {
        valueOf(sharp.sites[0]),
        valueOf(sharp.sites[1]),
        valueOf(sharp.sites[2])};
    const int fronts =
        (values[0] > 0.0F ? 1 : 0) + (values[1] > 0.0F ? 1 : 0) + (values[2] > 0.0F ? 1 : 0);
    if (fronts == 0 || fronts == 3) continue;
    Piece piece{{}, {}, kNone, sharp.face, kNone};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t l = (k + 1) % 3;
      const std::uint32_t from = mesh.origins[3 * sharp.face + k];
      const std::uint32_t to = mesh.origins[3 * sharp.face + l];
      if (values[k] > 0.0F && !(values[l] > 0.0F)) {
        piece.begin = crossing(from, values[k], to, values[l]);
      } else if (!(values[k] > 0.0F) && values[l] > 0.0F) {
        piece.end = crossing(to, values[l], from, values[k]);
      }
    }
    if (piece.begin != piece.end) pieces_.push_back(piece);
  }
  for (const Crease& crease : creases_)
    findOn(crease);
  for (const CrackSites& crack : cracks_)
    findOn(crack);
}

/// The parts of a crease whose sides face differently.
void CreaseContours::findOn(const Crease& crease) {
  const HalfEdgeMesh& mesh = field_.mesh();
  const std::uint32_t from = mesh.origin(crease.edge);
  const std::uint32_t to = mesh.target(crease.edge);
  const glm::vec3 start(field_.positions()[from]);
  const glm::vec3 along = glm::vec3(field_.positions()[to]) - start;

  struct Change {
    glm::vec3 point;
    float t;
    bool isLeft;
  };

  std::array<Change, 2> changes{};
  std::size_t count = 0;
  std::array<bool, 2> isFront{};  // left, right
  for (const bool isLeft : {true, false}) {
    const auto& sites = isLeft ? crease.left : crease.right;
    const float a = valueOf(sites[0]);
    const float b = valueOf(sites[1]);
    isFront[isLeft ? 0 : 1] = a > 0.0F;
    if ((a > 0.0F) == (b > 0.0F)) continue;
    const glm::vec3 point = a > 0.0F ? crossing(from, a, to, b) : crossing(to, b, from, a);
    changes[count++] = {point, glm::dot(point - start, along), isLeft};
  }
  if (count == 2 && changes[1].t < changes[0].t) std::swap(changes[0], changes[1]);
  glm::vec3 begin = start;
  for (std::size_t i = 0; i <= count; ++i) {
    const glm::vec3 end = i < count ? changes[i].point : glm::vec3(field_.positions()[to]);
    if (isFront[0] != isFront[1] && begin != end) {
      const HalfEdgeId twin = mesh.twins[crease.edge];
      if (isFront[0]) {
        pieces_.push_back({begin, end, crease.edge, HalfEdgeMesh::face(crease.edge), kNone});
      } else {
        pieces_.push_back({end, begin, twin, HalfEdgeMesh::face(twin), kNone});
      }
    }
    if (i < count) {
      bool& side = isFront[changes[i].isLeft ? 0 : 1];
      side = !side;
      begin = end;
    }
  }
}

/// The parts of a crack on whose other side the surface has turned away: of the two sides' parts
/// only the front one's.
void CreaseContours::findOn(const CrackSites& crack) {
  const CrackPart& part = crack.part;
  const std::array<float, 2> here = {valueOf(crack.here[0]), valueOf(crack.here[1])};
  const std::array<float, 2> there = {valueOf(crack.there[0]), valueOf(crack.there[1])};
  if ((!(here[0] > 0.0F) && !(here[1] > 0.0F)) || (there[0] > 0.0F && there[1] > 0.0F)) return;
  const HalfEdgeMesh& mesh = field_.mesh();
  const auto changeOf = [](const std::array<float, 2>& values) {
    return (values[0] > 0.0F) == (values[1] > 0.0F) ? 2.0F : values[0] / (values[0] - values[1]);
  };
  const auto placeOf = [&](HalfEdgeId h, const std::array<float, 2>& values) {
    const std::uint32_t from = mesh.origin(h);
    const std::uint32_t to = mesh.target(h);
    return values[0] > 0.0F ? crossing(from, values[0], to, values[1])
                            : crossing(to, values[1], from, values[0]);
  };

  struct Change {
    float t;  // along this side
    glm::vec3 point;
    bool isHere;
  };

  std::array<Change, 2> changes{};
  std::size_t count = 0;
  const float own = changeOf(here);
  const float others = changeOf(there);
  if (own > part.begin && own < part.end) changes[count++] = {own, placeOf(part.here, here), true};
  if (others < part.beginThere && others > part.endThere) {
    const float share = (part.beginThere - others) / (part.beginThere - part.endThere);
    // To the point where the other side's own pieces end.
    changes[count++] = {
        part.begin + share * (part.end - part.begin),
        placeOf(part.there, there),
        false};
  }
  if (count == 2 && changes[1].t < changes[0].t) std::swap(changes[0], changes[1]);
  bool isFrontHere = (part.begin < own ? here[0] : here[1]) > 0.0F;
  bool isFrontThere = (part.beginThere > others ? there[1] : there[0]) > 0.0F;
  const auto pointAt = [&](float t) {
    const glm::ivec3& from = field_.positions()[mesh.origin(part.here)];
    const glm::ivec3& to = field_.positions()[mesh.target(part.here)];
    return t < 1.0F ? glm::vec3(from) + t * glm::vec3(to - from) : glm::vec3(to);
  };
  glm::vec3 begin = pointAt(part.begin);
  for (std::size_t i = 0; i <= count; ++i) {
    const glm::vec3 end = i < count ? changes[i].point : pointAt(part.end);
    if (isFrontHere && !isFrontThere && begin != end)
      pieces_.push_back({begin, end, part.here, HalfEdgeMesh::face(part.here), kNone});
    if (i == count) break;
    bool& side = changes[i].isHere ? isFrontHere : isFrontThere;
    side = !side;
    begin = end;
  }
}

/// Each piece goes on with one that begins where it ends; the straightest first where several do.
void CreaseContours::linkPieces() {
  const auto count = static_cast<std::uint32_t>(pieces_.size());
  order_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i)
    order_[i] = i;
  const auto beginsBefore = [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(keyOf(pieces_[a].begin), a) < std::tuple(keyOf(pieces_[b].begin), b);
  };
  std::sort(order_.begin(), order_.end(), beginsBefore);
  next_.assign(count, kNone);
  isContinued_.assign(count, 0);
  const auto turnCosine = [&](const Piece& a, const Piece& b) {
    const glm::vec3 u = a.end - a.begin;
    const glm::vec3 v = b.end - b.begin;
    const float size = glm::length(u) * glm::length(v);
    return size > 0.0F ? glm::dot(u, v) / size : -1.0F;
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto key = keyOf(pieces_[i].end);
    auto at =
        std::lower_bound(order_.begin(), order_.end(), key, [&](std::uint32_t a, const auto& k) {
          return keyOf(pieces_[a].begin) < k;
        });
    float best = -2.0F;
    for (; at != order_.end() && keyOf(pieces_[*at].begin) == key; ++at) {
      if (isContinued_[*at] != 0) continue;
      const float cosine = turnCosine(pieces_[i], pieces_[*at]);
      if (cosine > best) {
        best = cosine;
        next_[i] = *at;
      }
    }
    if (next_[i] != kNone) isContinued_[next_[i]] = 1;
  }
  if (!cracks_.empty()) linkAcrossCracks();
}

/// What ends on one side of a crack goes on with the nearest that begins on the other.
void CreaseContours::linkAcrossCracks() {
  order_.clear();
  for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
    if (isContinued_[i] == 0) order_.push_back(i);
  }
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(keyOf(pieces_[a].begin), a) < std::tuple(keyOf(pieces_[b].begin), b);
  });
  for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
    if (next_[i] != kNone) continue;
    const glm::vec3& end = pieces_[i].end;
    auto at = std::lower_bound(
        order_.begin(),
        order_.end(),
        end.x - kCrackWidth,
        [&](std::uint32_t a, float x) { return pieces_[a].begin.x < x; });
    float nearest = kCrackWidth;
    for (; at != order_.end() && pieces_[*at].begin.x <= end.x + kCrackWidth; ++at) {
      // A piece shorter than a crack is wide is no loop.
      if (isContinued_[*at] != 0 || (*at == i && pieces_[i].line == kNone)) continue;
      const float distance = glm::distance(pieces_[*at].begin, end);
      if (distance > nearest) continue;
      nearest = distance;
      next_[i] = *at;
    }
    if (next_[i] != kNone) isContinued_[next_[i]] = 1;
  }
}

void CreaseContours::readLines(const PolylineSet& smooth) {
  lines_.points.clear();
  lines_.lines.clear();
  lines_.halfEdges.clear();
  lines_.faces.clear();
  const auto copyPoints = [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i)
      append(lines_, smooth.points[i], smooth.halfEdges[i], smooth.faces[i]);
  };
  for (const PolylineSet::Line& line : smooth.lines) {
    if (!line.closed) continue;
    PolylineSet::Line copy = line;
    copy.begin = static_cast<std::uint32_t>(lines_.points.size());
    copyPoints(line.begin, line.end);
    copy.end = static_cast<std::uint32_t>(lines_.points.size());
    lines_.lines.push_back(copy);
  }
  const auto count = static_cast<std::uint32_t>(pieces_.size());
  isUsed_.assign(count, 0);
  const auto readFrom = [&](std::uint32_t first) {
    PolylineSet::Line line;
    line.begin = static_cast<std::uint32_t>(lines_.points.size());
    std::uint32_t last = first;
    std::uint32_t i = first;
    for (; i != kNone && isUsed_[i] == 0; i = next_[i]) {
      isUsed_[i] = 1;
      last = i;
      const Piece& piece = pieces_[i];
      if (piece.line != kNone) {
        copyPoints(smooth.lines[piece.line].begin, smooth.lines[piece.line].end - 1);
      } else {
        append(lines_, piece.begin, piece.edge, piece.face);
      }
    }
    line.closed = i == first;
    if (!line.closed) append(lines_, pieces_[last].end, kNone, kNone);
    line.end = static_cast<std::uint32_t>(lines_.points.size());
    lines_.lines.push_back(line);
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    if (isContinued_[i] == 0) readFrom(i);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (isUsed_[i] == 0) readFrom(i);
  }
}

}  // namespace limn
