// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/visibility/line_crossings.h"

#include "client/stroke/clip_segment.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limn {
namespace {

/// Crossings nearer than this to an end of a segment (as a share of it) are the end itself: lines
/// meet edges at the vertices that they share.
constexpr double kEnd = 1e-6;

/// How much nearer (window depth) an edge must be to lie before a line, and not on it.
constexpr double kBefore = 1e-11;

/// So many edges near a line are found before any is looked at.
constexpr std::size_t kAtOnce = 32;

double cross2(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// The place of a → b that is closest to p in the picture.
glm::dvec3 closest(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& p) {
  const glm::dvec3 along = b - a;
  const glm::dvec2 course(along);
  const double length2 = glm::dot(course, course);
  const double share = length2 > 0.0 ? glm::dot(glm::dvec2(p - a), course) / length2 : 0.0;
  return a + std::clamp(share, 0.0, 1.0) * along;
}

}  // namespace

void LineCrossings::begin(const Viewport& viewport) {
  viewport_ = viewport;
  edges_.clear();
  cellBegin_.clear();
  const glm::dvec2 size(viewport.width, viewport.height);
  low_ = -kSpineMargin * size;
}

void LineCrossings::addEdge(const glm::dvec4& a, const glm::dvec4& b, Surface side, FaceId face) {
  const ClipSpan span = clipSegment(a, b);
  if (span.empty()) return;
  const glm::dvec4 d = b - a;
  addEdgeInPicture(
      pixelFromClip(span.begin > 0.0 ? a + span.begin * d : a, viewport_),
      pixelFromClip(span.end < 1.0 ? a + span.end * d : b, viewport_),
      side,
      face);
}

template <class Visit>
void LineCrossings::forCells(const glm::dvec2& a, const glm::dvec2& b, Visit visit) const {
  const glm::dvec2 from = (a - low_) * cellsPerPx_;
  const glm::dvec2 to = (b - low_) * cellsPerPx_;
  const auto row = [&](double y) { return std::clamp(static_cast<int>(y), 0, rows_ - 1); };
  const auto column = [&](double x) { return std::clamp(static_cast<int>(x), 0, columns_ - 1); };
  const int firstRow = row(std::min(from.y, to.y));
  const int lastRow = row(std::max(from.y, to.y));
  const auto visitRow = [&](int y, double x0, double x1) {
    // A little more on both sides makes up for rounding.
    const int first = column(std::min(x0, x1) - 1e-6);
    const int last = column(std::max(x0, x1) + 1e-6);
    for (int x = first; x <= last; ++x)
      visit(static_cast<std::uint32_t>(y * columns_ + x));
  };
  if (firstRow == lastRow) {
    visitRow(firstRow, from.x, to.x);
    return;
  }
  const double slope = (to.x - from.x) / (to.y - from.y);
  const double low = std::min(from.y, to.y);
  const double high = std::max(from.y, to.y);
  for (int y = firstRow; y <= lastRow; ++y) {
    const double y0 = std::clamp(static_cast<double>(y), low, high);
    const double y1 = std::clamp(static_cast<double>(y + 1), low, high);
    visitRow(y, from.x + (y0 - from.y) * slope, from.x + (y1 - from.y) * slope);
  }
}

LineCrossings::Box LineCrossings::boxAround(const glm::dvec3& a, const glm::dvec3& b) {
  // A little larger makes up for rounding to floats.
  const double pad =
      1e-6 * (1.0 + std::max({std::abs(a.x), std::abs(b.x), std::abs(a.y), std::abs(b.y)}));
  return {
      static_cast<float>(std::min(a.x, b.x) - pad),
      static_cast<float>(std::max(a.x, b.x) + pad),
      static_cast<float>(std::min(a.y, b.y) - pad),
      static_cast<float>(std::max(a.y, b.y) + pad)};
}

void LineCrossings::build() {
  // Some cells an edge, whatever the picture's size.
  const glm::dvec2 extent =
      (1.0 + 2.0 * kSpineMargin) * glm::dvec2(viewport_.width, viewport_.height);
  const double cells = std::clamp(8.0 * static_cast<double>(edges_.size()), 4e3, 2.5e5);
  const double cellPx = std::max(1.0, std::sqrt(extent.x * extent.y / cells));
  cellsPerPx_ = 1.0 / cellPx;
  columns_ = std::max(1, static_cast<int>(std::ceil(extent.x / cellPx)));
  rows_ = std::max(1, static_cast<int>(std::ceil(extent.y / cellPx)));
  // First how many, then where each cell ends; filling from the back leaves where it begins.
  cellBegin_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  touches_.clear();
  touchBegin_.clear();
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    touchBegin_.push_back(static_cast<std::uint32_t>(touches_.size()));
    forCells(glm::dvec2(edges_[i].a), glm::dvec2(edges_[i].b), [&](std::uint32_t cell) {
      ++cellBegin_[cell];
      touches_.push_back({cell, i});
    });
  }
  touchBegin_.push_back(static_cast<std::uint32_t>(touches_.size()));
  for (std::size_t c = 1; c < cellBegin_.size(); ++c)
    cellBegin_[c] += cellBegin_[c - 1];
  cellEdges_.resize(touches_.size());
  for (std::size_t i = touches_.size(); i-- > 0;) {
    const Edge& edge = edges_[touches_[i].edge];
    cellEdges_[--cellBegin_[touches_[i].cell]] = {
        edge.box,
        static_cast<float>(std::min(edge.a.z, edge.b.z) - 1e-6),
        touches_[i].edge};
  }
}

void LineCrossings::cross(const glm::dvec4& a, const glm::dvec4& b, std::vector<Crossing>& out)
    const {
  const ClipSpan span = clipSegment(a, b);
  if (span.empty()) return;
  const glm::dvec4 d = b - a;
  const glm::dvec4 from = a + span.begin * d;
  const glm::dvec4 to = a + span.end * d;
  const std::size_t before = out.size();
  crossInPicture(pixelFromClip(from, viewport_), pixelFromClip(to, viewport_), out);
  for (std::size_t i = before; i < out.size(); ++i) {
    // From a share in the picture to one in space.
    const double s = out[i].inPicture;
    const double inSpace = s * from.w / (s * from.w + (1.0 - s) * to.w);
    out[i].inSpace = span.begin + inSpace * (span.end - span.begin);
  }
}

void LineCrossings::crossInPicture(
    const glm::dvec3& p,
    const glm::dvec3& q,
    std::vector<Crossing>& out) const {
  crossCells(
      {p, q, boxAround(p, q)},
      0.0F,
      [&](auto visit) { forCells(glm::dvec2(p), glm::dvec2(q), visit); },
      [](std::uint32_t) {},
      out);
}

void LineCrossings::crossAlong(std::uint32_t edge, std::vector<Crossing>& out, const Beside& beside)
    const {
  const Edge& along = edges_[edge];
  crossCells(
      {along.a,
       along.b,
       along.box,
       edge > 0 && edges_[edge - 1].isJoined ? edge - 1 : edge,
       along.isJoined ? edge + 2 : edge + 1},
      beside.reachPx,
      [&](auto visit) {
        for (std::uint32_t i = touchBegin_[edge]; i < touchBegin_[edge + 1]; ++i)
          visit(touches_[i].cell);
      },
      [&](std::uint32_t other) { beside.add(other); },
      out);
}

// visitNear(edge) for edges of the cells on the way, not farther away than it, whose box is within
// reachPx.
template <class ForCells, class VisitNear>
void LineCrossings::crossCells(
    const Course& course,
    float reachPx,
    ForCells forEachCell,
    VisitNear visitNear,
    std::vector<Crossing>& out) const {
  if (cellBegin_.empty()) return;
  const glm::dvec3& p = course.from;
  const glm::dvec3& q = course.to;
  const glm::dvec2 along(q - p);
  const Box reach = {
      course.box.lowX - reachPx,
      course.box.highX + reachPx,
      course.box.lowY - reachPx,
      course.box.highY + reachPx};
  const auto farthest = static_cast<float>(std::max(p.z, q.z) + 1e-6);
  const auto isNear = [&](const Entry& entry) {
    // Which of these fails cannot be foretold: no branches.
    return static_cast<std::uint32_t>(
        static_cast<int>(entry.nearest <= farthest) &
        static_cast<int>(entry.box.lowX <= reach.highX) &
        static_cast<int>(entry.box.highX >= reach.lowX) &
        static_cast<int>(entry.box.lowY <= reach.highY) &
        static_cast<int>(entry.box.highY >= reach.lowY) &
        static_cast<int>(entry.edge - course.joinedFrom >= course.joinedTo - course.joinedFrom));
  };
  const std::size_t before = out.size();
  const auto meet = [&](std::uint32_t number) {
    visitNear(number);
    const Edge& edge = edges_[number];
    const glm::dvec2 across(edge.b - edge.a);
    const glm::dvec2 gap(edge.a - p);
    const double det = cross2(along, across);
    // Most edges are passed over before anything is divided.
    const double sign = std::copysign(1.0, det);
    const double size = sign * det;
    const double sTimes = sign * cross2(gap, across);
    const double uTimes = sign * cross2(gap, along);
    if ((static_cast<int>(sTimes > 0.0) & static_cast<int>(sTimes < size) &
         static_cast<int>(uTimes >= 0.0) & static_cast<int>(uTimes <= size)) == 0)
      return;
    const double s = sTimes / size;
    const double u = uTimes / size;
    if (!(s > kEnd && s < 1.0 - kEnd)) return;
    const double depth = p.z + s * (q.z - p.z);
    const double nearer = depth - (edge.a.z + u * (edge.b.z - edge.a.z));
    if (!(nearer > kBefore)) return;
    // Rows run down: det > 0 is towards the edge's left.
    out.push_back(
        {0.0, s, (det > 0.0) == (edge.side == Surface::kLeft), nearer, edge.face, number});
  };
  std::array<std::uint32_t, kAtOnce> near;
  std::size_t count = 0;
  const auto meetNear = [&] {
    for (std::size_t i = 0; i < count; ++i)
      meet(near[i]);
    count = 0;
  };
  forEachCell([&](std::uint32_t cell) {
    for (std::uint32_t k = cellBegin_[cell]; k < cellBegin_[cell + 1]; ++k) {
      near[count] = cellEdges_[k].edge;
      count += isNear(cellEdges_[k]);
      if (count == kAtOnce) meetNear();
    }
  });
  meetNear();
  if (out.size() < before + 2) return;
  // A pair that shares several cells was found in each, always with the same result.
  const auto begin = out.begin() + static_cast<std::ptrdiff_t>(before);
  std::sort(begin, out.end(), [](const Crossing& x, const Crossing& y) {
    return x.inPicture != y.inPicture ? x.inPicture < y.inPicture : x.face < y.face;
  });
  const auto isSame = [](const Crossing& x, const Crossing& y) {
    return x.inPicture == y.inPicture && x.face == y.face;
  };
  out.erase(std::unique(begin, out.end(), isSame), out.end());
}

bool LineCrossings::isBefore(std::uint32_t edge, const glm::dvec3& place, double reachPx) const {
  const glm::dvec3 off = place - closest(edges_[edge].a, edges_[edge].b, place);
  return off.x * off.x + off.y * off.y <= reachPx * reachPx && off.z > 0.0;
}

bool LineCrossings::isBefore(
    std::uint32_t edge,
    const glm::dvec3& from,
    const glm::dvec3& to,
    double reachPx) const {
  // Most pass by on one side of the edge's straight line.
  const glm::dvec3& a = edges_[edge].a;
  const glm::dvec2 course(edges_[edge].b - a);
  const double fromAside = cross2(course, glm::dvec2(from - a));
  const double toAside = cross2(course, glm::dvec2(to - a));
  const double limit = 1.000001 * reachPx * reachPx * glm::dot(course, course);
  if (fromAside * toAside > 0.0 && std::min(fromAside * fromAside, toAside * toAside) > limit)
    return false;
  // Segments are closest at an end of one of them.
  if (isBefore(edge, from, reachPx) || isBefore(edge, to, reachPx)) return true;
  const auto isEndBefore = [&](const glm::dvec3& end) {
    const glm::dvec3 off = closest(from, to, end) - end;
    return off.x * off.x + off.y * off.y <= reachPx * reachPx && off.z > 0.0;
  };
  return isEndBefore(edges_[edge].a) || isEndBefore(edges_[edge].b);
}

}  // namespace limn
