// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/cracks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace limn {
namespace {

/// Where along a border edge the other side is looked for.
constexpr std::array<double, 3> kPlaces = {0.2, 0.5, 0.8};
/// Sides whose normals differ by more lie back to back.
constexpr double kBackToBackDegrees = 150.0;
/// Cells that one edge is entered in, at most: longer steps leave gaps that only miss cracks.
constexpr int kMostCells = 64;

/// Borders that lie along one another over less than this (grid units) only touch at their ends.
constexpr double kLeastPart = 0.25;

/// A border edge with its face.
struct Border {
  HalfEdgeId edge = kNone;
  glm::dvec3 from{0.0};
  glm::dvec3 along{0.0};
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
    enter();
    std::vector<Side> sides;
    for (std::uint32_t i = 0; i < borders_.size(); ++i)
      sides.push_back(sideOf(i, [](std::uint32_t) { return true; }));
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
    for (std::uint32_t i = 0; i < borders_.size(); ++i) {
      if (out.kinds[borders_[i].edge] == Crack::kInvisible) appendParts(i, out);
    }
    return out;
  }

 private:
  void collect() {
    double sum = 0.0;
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
      sum += border.length;
      borders_.push_back(border);
    }
    if (!borders_.empty())
      cell_ = std::max(sum / static_cast<double>(borders_.size()), 4.0 * options_.widest);
  }

  [[nodiscard]] std::uint64_t cellOf(const glm::dvec3& p) const {
    const glm::i64vec3 c(glm::floor(p / cell_));
    return static_cast<std::uint64_t>(c.x) * 0x9E3779B97F4A7C15ULL ^
           static_cast<std::uint64_t>(c.y) * 0xC2B2AE3D27D4EB4FULL ^
           static_cast<std::uint64_t>(c.z) * 0x165667B19E3779F9ULL;
  }

  /// visit(place) along a border, two in every cell.
  template <class Visit>
  void walk(const Border& border, Visit visit) const {
    const int steps =
        std::clamp(static_cast<int>(std::ceil(2.0 * border.length / cell_)), 1, kMostCells);
    for (int k = 0; k <= steps; ++k)
      visit(border.from + border.along * (double(k) / steps));
  }

  /// Enters every border in the cells along it.
  void enter() {
    for (std::uint32_t i = 0; i < borders_.size(); ++i)
      walk(borders_[i], [&](const glm::dvec3& p) { entries_.emplace_back(cellOf(p), i); });
    std::sort(entries_.begin(), entries_.end());
    entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
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

  /// How the surface goes on at p, a place on border `self`: smoothly, if on any other's face.
  template <class Counts>
  [[nodiscard]] Side sideAt(std::uint32_t self, const glm::dvec3& p, Counts counts) const {
    Side best;
    forNear(p, [&](std::uint32_t other) {
      if (other == self || !counts(other)) return true;
      const Crack crack = crackTo(borders_[self], borders_[other], p);
      if (crack != Crack::kNot) best = {crack, other};
      return crack != Crack::kInvisible;
    });
    return best;
  }

  /// visit(border) for all in the cells around p, while it says true.
  template <class Visit>
  void forNear(const glm::dvec3& p, Visit visit) const {
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dz = -1; dz <= 1; ++dz) {
          const std::uint64_t cell = cellOf(p + cell_ * glm::dvec3(dx, dy, dz));
          auto entry = std::lower_bound(
              entries_.begin(),
              entries_.end(),
              std::pair<std::uint64_t, std::uint32_t>(cell, 0));
          for (; entry != entries_.end() && entry->first == cell; ++entry) {
            if (!visit(entry->second)) return;
          }
        }
      }
    }
  }

  /// Where others lie along border `self` and its surface goes on smoothly on theirs.
  void appendParts(std::uint32_t self, Cracks& out) {
    const Border& here = borders_[self];
    others_.clear();
    walk(here, [&](const glm::dvec3& p) {
      forNear(p, [&](std::uint32_t other) {
        if (other != self && out.kinds[borders_[other].edge] == Crack::kInvisible)
          others_.push_back(other);
        return true;
      });
    });
    std::sort(others_.begin(), others_.end());
    others_.erase(std::unique(others_.begin(), others_.end()), others_.end());
    const auto shareOf = [](const Border& border, const glm::dvec3& p) {
      return glm::dot(p - border.from, border.along) / (border.length * border.length);
    };
    for (const std::uint32_t other : others_) {
      const Border& there = borders_[other];
      // Borders that meet run against one another, as their faces lie on either side.
      const double begin = std::max(0.0, shareOf(here, there.from + there.along));
      const double end = std::min(1.0, shareOf(here, there.from));
      if (!((end - begin) * here.length > kLeastPart)) continue;
      const auto placeAt = [&](double t) { return here.from + t * here.along; };
      if (crackTo(here, there, placeAt(begin)) != Crack::kInvisible ||
          crackTo(here, there, placeAt(end)) != Crack::kInvisible) {
        continue;
      }
      const auto shareThere = [&](double t) {
        return static_cast<float>(std::clamp(shareOf(there, placeAt(t)), 0.0, 1.0));
      };
      out.parts.push_back(
          {here.edge,
           there.edge,
           static_cast<float>(begin),
           static_cast<float>(end),
           shareThere(begin),
           shareThere(end)});
    }
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
  double cell_ = 1.0;
  std::vector<Border> borders_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> entries_;  // cell, border; sorted
  std::vector<std::uint32_t> others_;                             // of one border
};

}  // namespace

Cracks findCracks(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    const CrackOptions& options) {
  return CrackSearch(mesh, positions, options).run();
}

}  // namespace limn
