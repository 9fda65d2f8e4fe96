// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/cracks.h"

#include "shared/mesh/segment_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace limn {
namespace {

/// Where along a border edge the other side is looked for.
constexpr std::array<double, 3> kPlaces = {0.2, 0.5, 0.8};
/// Sides whose normals differ by more lie back to back.
constexpr double kBackToBackDegrees = 150.0;
/// Borders that lie along one another over less than this (grid units) only touch at their ends.
constexpr double kLeastPart = 0.25;

/// A border edge with its face.
struct Border : Segment {
  HalfEdgeId edge = kNone;
  double length = 0.0;
  glm::dvec3 normal{0.0};   // unit
  glm::dvec3 inwards{0.0};  // unit, in the face, across the edge
};

class CrackSearch {
 public:
  CrackSearch(
      const HalfEdgeMesh& mesh,
      std::span<const glm::ivec3> positions,
      const CrackOptions& options)
      : mesh_(mesh),
        positions_(positions),
        options_(options),
        cosine_(std::cos(options.sharpDegrees * std::numbers::pi / 180.0)),
        backToBack_(std::cos(kBackToBackDegrees * std::numbers::pi / 180.0)) {}

  Cracks run() {
    Cracks out;
    out.kinds.assign(mesh_.origins.size(), Crack::kNot);
    out.across.assign(mesh_.origins.size(), kNone);
    collect();
    if (borders_.empty()) return out;
    std::vector<Segment> segments;
    segments.reserve(borders_.size());
    for (const Border& border : borders_)
      segments.push_back(border);
    const SegmentCells cells(segments, options_.widest);
    cells_ = &cells;
    std::vector<Side> sides(borders_.size());
    for (std::uint32_t i = 0; i < borders_.size(); ++i)
      sides[i] = sideOf(i, [](std::uint32_t) { return true; });
    for (std::uint32_t i = 0; i < borders_.size(); ++i) {
      Side side = sides[i];
      // Of the borders along one crease the longest ones stay.
      const double own = borders_[i].length;
      const auto isOwner = [&](std::uint32_t other) {
        return sides[other].crack == Crack::kCrease &&
               (borders_[other].length > own || (borders_[other].length == own && other < i));
      };
      if (side.crack == Crack::kCrease && sideOf(i, isOwner).crack != Crack::kNot)
        side.crack = Crack::kInvisible;
      out.kinds[borders_[i].edge] = side.crack;
      if (side.crack == Crack::kCrease)
        out.across[borders_[i].edge] = HalfEdgeMesh::face(borders_[side.border].edge);
    }
    seenBy_.assign(borders_.size(), kNone);
    for (std::uint32_t i = 0; i < borders_.size(); ++i) {
      if (out.kinds[borders_[i].edge] == Crack::kInvisible) appendParts(i, out);
    }
    return out;
  }

 private:
  void collect() {
    for (HalfEdgeId h = 0; h < mesh_.origins.size(); ++h) {
      if (mesh_.twin(h) != kNone) continue;
      Border border;
      border.edge = h;
      border.from = glm::dvec3(positions_[mesh_.origin(h)]);
      border.along = glm::dvec3(positions_[mesh_.target(h)]) - border.from;
      const glm::dvec3 apex = glm::dvec3(positions_[mesh_.origin(HalfEdgeMesh::prev(h))]);
      const glm::dvec3 across = glm::cross(border.along, apex - border.from);
      const double area = glm::length(across);
      if (!(area > 0.0)) continue;
      border.normal = across / area;
      border.inwards = glm::normalize(glm::cross(border.normal, border.along));
      border.length = glm::length(border.along);
      borders_.push_back(border);
    }
  }

  /// What is on the other side of a border: which other one, if any.
  struct Side {
    Crack crack = Crack::kNot;
    std::uint32_t border = kNone;
  };

  /// As much of a crack as its least part, the border at its middle; only those that count.
  template <class Counts>
  [[nodiscard]] Side sideOf(std::uint32_t self, Counts counts) const {
    Side whole{Crack::kInvisible, kNone};
    for (const double t : kPlaces) {
      const Side here = sideAt(self, borders_[self].from + t * borders_[self].along, counts);
      if (here.crack == Crack::kNot) return here;
      if (here.crack == Crack::kCrease) whole.crack = here.crack;
      if (whole.border == kNone || t <= 0.5) whole.border = here.border;
    }
    return whole;
  }

  /// How the surface goes on at p, a place on border `self`: smoothly, if on any other's face. Of
  /// several alike: the first that it goes on smoothly to, the last at an angle.
  template <class Counts>
  [[nodiscard]] Side sideAt(std::uint32_t self, const glm::dvec3& p, Counts counts) const {
    Side best;
    for (const std::uint32_t other : cells_->near(p)) {
      if (other == self || !counts(other)) continue;
      const Crack crack = crackTo(borders_[self], borders_[other], p);
      if (crack == Crack::kInvisible) return {crack, other};
      if (crack == Crack::kCrease) best = {crack, other};
    }
    return best;
  }

  /// Where others lie along border `self` and its surface goes on smoothly on theirs; in their
  /// order.
  void appendParts(std::uint32_t self, Cracks& out) {
    const auto begin = static_cast<std::ptrdiff_t>(out.parts.size());
    cells_->visitNear(borders_[self], [&](std::uint32_t other) {
      if (other == self || seenBy_[other] == self) return;
      seenBy_[other] = self;
      if (out.kinds[borders_[other].edge] != Crack::kInvisible) return;
      if (const auto part = partBetween(borders_[self], borders_[other]))
        out.parts.push_back(*part);
    });
    std::sort(
        out.parts.begin() + begin,
        out.parts.end(),
        [](const CrackPart& a, const CrackPart& b) { return a.there < b.there; });
  }

  [[nodiscard]] std::optional<CrackPart> partBetween(const Border& here, const Border& there)
      const {
    const auto shareOf = [](const Border& border, const glm::dvec3& p) {
      return glm::dot(p - border.from, border.along) / (border.length * border.length);
    };
    // Borders that meet run against one another, as their faces lie on either side.
    const double begin = std::max(0.0, shareOf(here, there.from + there.along));
    const double end = std::min(1.0, shareOf(here, there.from));
    if (!((end - begin) * here.length > kLeastPart)) return std::nullopt;
    const auto placeAt = [&](double t) { return here.from + t * here.along; };
    if (crackTo(here, there, placeAt(begin)) != Crack::kInvisible ||
        crackTo(here, there, placeAt(end)) != Crack::kInvisible) {
      return std::nullopt;
    }
    const auto shareThere = [&](double t) {
      return static_cast<float>(std::clamp(shareOf(there, placeAt(t)), 0.0, 1.0));
    };
    return CrackPart{
        here.edge,
        there.edge,
        static_cast<float>(begin),
        static_cast<float>(end),
        shareThere(begin),
        shareThere(end)};
  }

  [[nodiscard]] Crack crackTo(const Border& here, const Border& there, const glm::dvec3& p) const {
    const double t = std::clamp(
        glm::dot(p - there.from, there.along) / glm::dot(there.along, there.along),
        0.0,
        1.0);
    const glm::dvec3 apart = p - (there.from + t * there.along);
    if (glm::dot(apart, apart) > options_.widest * options_.widest) return Crack::kNot;
    const double normals = glm::dot(here.normal, there.normal);
    const double inwards = glm::dot(here.inwards, there.inwards);
    // Faces that lie on one another, back to back or not, do not go on.
    if (normals < backToBack_ || inwards > -backToBack_) return Crack::kNot;
    return normals >= cosine_ && inwards <= -cosine_ ? Crack::kInvisible : Crack::kCrease;
  }

  const HalfEdgeMesh& mesh_;
  std::span<const glm::ivec3> positions_;
  CrackOptions options_;
  double cosine_;
  double backToBack_;
  std::vector<Border> borders_;
  const SegmentCells* cells_ = nullptr;  // of borders_
  std::vector<std::uint32_t> seenBy_;    // of a border: the last one whose parts it was tried for
};

}  // namespace

Cracks findCracks(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    const CrackOptions& options) {
  return CrackSearch(mesh, positions, options).run();
}

}  // namespace limn
