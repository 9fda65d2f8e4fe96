// SPDX-License-Identifier: Apache-2.0
//
// Based on: D. Luebke and C. Erikson, "View-dependent simplification of arbitrary polygonal
// environments", SIGGRAPH 1997 (silhouettes decide what is refined). Deviation: not by bounds on
// what may happen but by looking: the contours that the client would draw are found as it finds
// them and compared with the full mesh's (analysis by synthesis).
#include "server/session/contour_search.h"

#include "shared/core/assert.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace limn {
namespace {

constexpr int kMaxPicturePx = 1024;  // of the longer side
constexpr double kSpacingPx = 1.0;   // of compared points, in error bounds
// See noteDetail().
constexpr double kDetailOffFrom = 0.12;
constexpr double kDetailOffTo = 0.2;
constexpr double kDetailRatio = 3.0;
// From this round on every round adds more, so that there is an end.
constexpr int kHurryFrom = 50;
constexpr double kLimitBounds = 4.0;  // distances count up to this many error bounds

bool holds(std::span<const std::uint64_t> words, VertexId v) {
  return (words[v / 64] >> (v % 64) & 1) != 0;
}

std::vector<glm::vec2> pixelsOf(std::span<const ContourPoint> points) {
  std::vector<glm::vec2> pixels;
  pixels.reserve(points.size());
  for (const ContourPoint& p : points)
    pixels.push_back(p.px);
  return pixels;
}

std::vector<float> distances(std::span<const ContourPoint> from, const PixelPoints& to) {
  std::vector<float> result;
  result.reserve(from.size());
  for (const ContourPoint& p : from)
    result.push_back(to.distanceTo(p.px));
  return result;
}

double shareOff(std::span<const ContourPoint> points, std::span<const float> off, double bound) {
  double sum = 0.0;
  double far = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum += points[i].lengthPx;
    if (off[i] > bound) far += points[i].lengthPx;
  }
  return sum > 0.0 ? far / sum : 0.0;
}

}  // namespace

ContourView contourViewOf(const protocol::Pose& pose, const Grid& grid) {
  const double scale =
      std::min(1.0, static_cast<double>(kMaxPicturePx) / std::max(pose.width, pose.height));
  ContourView view;
  PictureView& picture = view.picture;
  picture.width = std::max(1, static_cast<int>(std::lround(pose.width * scale)));
  picture.height = std::max(1, static_cast<int>(std::lround(pose.height * scale)));
  picture.eye = grid.fromModel(pose.eye);
  picture.forward = glm::normalize(pose.forward);
  picture.right = glm::normalize(glm::cross(picture.forward, glm::normalize(pose.up)));
  picture.up = glm::cross(picture.right, picture.forward);
  picture.orthographic = pose.orthoHeight > 0.0;
  picture.pixelsPerUnit =
      picture.orthographic
          ? picture.height / (pose.orthoHeight / grid.step)
          : picture.height / (2.0 * std::tan(static_cast<double>(pose.fovY) / 2.0));
  view.kind = pose.silhouette == protocol::Silhouette::kSmooth ? SilhouetteKind::kSmooth
                                                               : SilhouetteKind::kEdges;
  view.errorPx = pose.errorPx * scale;
  return view;
}

ActiveMesh meshOf(const SplitForest& forest, std::span<const std::uint64_t> held) {
  const std::uint32_t base = forest.baseVertexCount();
  auto mesh = ActiveMesh::fromBase(forest.levelBegin, forest.baseMesh(), forest.baseFeatures);
  LIMN_ASSERT(mesh);
  for (std::size_t word = base / 64; word < held.size(); ++word) {
    for (std::uint64_t bits = held[word]; bits != 0; bits &= bits - 1) {
      const auto v = static_cast<VertexId>(word * 64 + std::countr_zero(bits));
      if (v < base) continue;
      const auto applied = mesh->apply(forest.split(v));
      LIMN_ASSERT(applied);
    }
  }
  return std::move(*mesh);
}

ContourSearch::ContourSearch(
    const FullMesh& full,
    const ContourView& view,
    std::span<const std::uint64_t> have,
    const ContourSearchOptions& options)
    : full_(full),
      forest_(full.forest()),
      view_(view),
      options_(options),
      start_(have.begin(), have.end()),
      held_(start_),
      client_(meshOf(forest_, held_)),
      votes_(forest_.vertexCount(), 0.0F),
      stamps_(forest_.vertexCount(), 0),
      reach_(forest_.vertexCount(), 0) {
  heldCount_ = static_cast<std::uint32_t>(client_.ids().size());
  truth_ = finder_.find(full.field(view.kind), view.picture, kSpacingPx * view.errorPx);
  truthPixels_.emplace(
      pixelsOf(truth_),
      view.picture.width,
      view.picture.height,
      kLimitBounds * view.errorPx);
  compare();
}

void ContourSearch::compare() {
  const SilhouetteField field(client_.mesh(), client_.positions(), view_.kind);
  mine_ = finder_.find(field, view_.picture, kSpacingPx * view_.errorPx);
  const PixelPoints minePixels(
      pixelsOf(mine_),
      view_.picture.width,
      view_.picture.height,
      kLimitBounds * view_.errorPx);
  truthOff_ = distances(truth_, minePixels);
  mineOff_ = distances(mine_, *truthPixels_);
  off_.full = shareOff(truth_, truthOff_, view_.errorPx);
  off_.client = shareOff(mine_, mineOff_, view_.errorPx);
}

VertexId ContourSearch::nextChildOf(VertexId parent) const {
  // Those held come first.
  const auto children = full_.childrenOf(parent);
  const auto next =
      std::ranges::partition_point(children, [&](VertexId c) { return holds(held_, c); });
  return next == children.end() ? kNone : *next;
}

/// The coarsest split missing on the way from what is held to v; kNone: v is held.
VertexId ContourSearch::nextTowards(VertexId v) const {
  VertexId below = kNone;
  while (!holds(held_, v)) {
    below = v;
    v = forest_.parent(v);
  }
  return below;
}

/// What is left is contours of a few faces that show in the full mesh alone (the noise of a scan):
/// half a way down to them brings nothing.
void ContourSearch::noteDetail() {
  const bool now = off_.client <= share() && off_.full >= kDetailRatio * off_.client &&
                   off_.full >= kDetailOffFrom && off_.full <= kDetailOffTo;
  onlyDetailIsLeft_ = onlyDetailIsLeft_ || now;
}

/// The finest corner that is missing of the full mesh's faces at a segment of its silhouette: with
/// it they are there. kNone: they are.
VertexId ContourSearch::finestMissingAt(std::uint32_t segment) const {
  const HalfEdgeMesh& mesh = full_.mesh();
  const FaceId face =
      view_.kind == SilhouetteKind::kEdges ? HalfEdgeMesh::face(segment) : FaceId{segment};
  VertexId finest = kNone;
  const auto look = [&](FaceId f) {
    for (HalfEdgeId h = 3 * f; h < 3 * f + 3; ++h) {
      const VertexId v = mesh.origins[h];
      if (!holds(held_, v) && (finest == kNone || v > finest)) finest = v;
    }
  };
  look(face);
  if (view_.kind == SilhouetteKind::kEdges) look(HalfEdgeMesh::face(mesh.twin(segment)));
  return finest;
}

void ContourSearch::vote(VertexId v, float weight) {
  if (v == kNone) return;
  if (votes_[v] == 0.0F) voted_.push_back(v);
  votes_[v] += weight;
}

/// Every piece of contour that is off votes for the splits next to come where it is. What is off by
/// little is put right sooner, so it counts more.
void ContourSearch::collectVotes() {
  const auto weightOf = [&](const ContourPoint& p, float off) {
    return std::max(p.lengthPx, 1e-3F) * static_cast<float>(view_.errorPx) / off;
  };
  if (off_.full > share()) {
    const HalfEdgeMesh& mesh = full_.mesh();
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      if (truthOff_[i] <= view_.errorPx) continue;
      const float weight = weightOf(truth_[i], truthOff_[i]);
      const std::uint32_t segment = truth_[i].segment;
      if (onlyDetailIsLeft_) {
        vote(finestMissingAt(segment), weight);
      } else if (view_.kind == SilhouetteKind::kEdges) {
        vote(nextTowards(mesh.origin(segment)), weight);
        vote(nextTowards(mesh.target(segment)), weight);
      } else {
        for (std::uint32_t k = 0; k < 3; ++k)
          vote(nextTowards(mesh.origins[3 * segment + k]), weight);
      }
    }
  }
  if (off_.client > share()) {
    const HalfEdgeMesh& mesh = client_.mesh();
    const auto refine = [&](std::uint32_t slot, float weight) {
      vote(nextChildOf(client_.ids()[slot]), weight);
    };
    for (std::size_t i = 0; i < mine_.size(); ++i) {
      if (mineOff_[i] <= view_.errorPx) continue;
      const float weight = weightOf(mine_[i], mineOff_[i]);
      const std::uint32_t segment = mine_[i].segment;
      if (view_.kind == SilhouetteKind::kEdges) {
        refine(mesh.origin(segment), weight);
        refine(mesh.target(segment), weight);
        refine(mesh.origin(HalfEdgeMesh::prev(segment)), 0.5F * weight);
        refine(mesh.origin(HalfEdgeMesh::prev(mesh.twin(segment))), 0.5F * weight);
      } else {
        for (std::uint32_t k = 0; k < 3; ++k)
          refine(mesh.origins[3 * segment + k], weight);
      }
    }
  }
}

/// v and its prerequisites that `held` lacks, into closure_. False when they are more than `most`:
/// then only some of them are there.
bool ContourSearch::findClosure(VertexId v, std::span<const std::uint64_t> held, std::size_t most) {
  ++stamp_;
  closure_.clear();
  open_.assign(1, v);
  stamps_[v] = stamp_;
  const auto want = [&](VertexId w) {
    if (holds(held, w) || stamps_[w] == stamp_) return;
    stamps_[w] = stamp_;
    open_.push_back(w);
  };
  while (!open_.empty()) {
    const VertexId w = open_.back();
    open_.pop_back();
    closure_.push_back(w);
    forest_.forEachPrerequisite(w, want);
    if (closure_.size() + open_.size() > most) return false;
  }
  return true;
}

void ContourSearch::add(VertexId v) {
  const auto applied = client_.apply(forest_.split(v));
  LIMN_ASSERT(applied);
  held_[v / 64] |= std::uint64_t{1} << (v % 64);
  ++heldCount_;
}

/// Those of `open` that are worth at least so much, most worthy first; they are taken out of
/// `open`. held: what the client has, closed; a closure is only followed as far as it may still
/// pay.
std::vector<ContourSearch::Candidate> ContourSearch::rankedFrom(
    double worth,
    std::span<const std::uint64_t> held,
    std::vector<Candidate>& open) {
  std::vector<Candidate> ranked;
  std::erase_if(open, [&](Candidate& candidate) {
    const double most = candidate.votes / worth;
    if (reach_[candidate.vertex] > heldThen_ + most) return false;
    const bool isWhole =
        findClosure(candidate.vertex, held, static_cast<std::size_t>(std::min(most, 1e9)));
    const std::size_t needs = closure_.size() + open_.size();
    reach_[candidate.vertex] = heldThen_ + static_cast<std::uint32_t>(needs);
    if (!isWhole) return false;
    candidate.worth = candidate.votes / static_cast<float>(needs);
    ranked.push_back(candidate);
    return true;
  });
  std::ranges::sort(ranked, [](const Candidate& a, const Candidate& b) {
    return a.worth != b.worth ? a.worth > b.worth : a.vertex < b.vertex;
  });
  return ranked;
}

/// Adds the most worthy. False when there is nothing to add.
bool ContourSearch::addRound() {
  collectVotes();
  std::vector<Candidate> open;
  for (const VertexId v : voted_) {
    open.push_back({v, votes_[v], 0.0F});
    votes_[v] = 0.0F;
  }
  voted_.clear();
  if (open.empty()) return false;
  const double hurry = 1.0 + std::max(0, rounds_ - kHurryFrom) / 10.0;
  const double greed = hurry * std::max(options_.leastGreed, options_.greed * off_.worst());
  const auto room = static_cast<std::uint32_t>(std::max(8.0, greed * heldCount_));
  const std::uint32_t end = heldCount_ + room;
  // All are ranked by what they needed when the round began.
  const std::vector<std::uint64_t> held = held_;
  heldThen_ = heldCount_;
  for (double worth = worthLast_; !open.empty() && heldCount_ < end; worth /= 4.0) {
    for (const Candidate& candidate : rankedFrom(worth, held, open)) {
      if (heldCount_ >= end) break;
      if (holds(held_, candidate.vertex)) continue;
      worthLast_ = candidate.worth;
      findClosure(candidate.vertex, held_, forest_.vertexCount());
      std::ranges::sort(closure_);
      for (const VertexId v : closure_)
        add(v);
    }
  }
  return true;
}

/// Takes away that part of the splits that nothing needs and the contour needs least, unless they
/// are missed. False when they are.
bool ContourSearch::pruneRound(double part) {
  const std::uint32_t base = forest_.baseVertexCount();
  ++stamp_;
  for (const VertexId v : client_.ids()) {
    if (v < base) continue;
    forest_.forEachPrerequisite(v, [this](VertexId w) { stamps_[w] = stamp_; });
  }
  const HalfEdgeMesh& mesh = client_.mesh();
  const auto carry = [&](std::uint32_t slot, float length) {
    votes_[client_.ids()[slot]] += length;
  };
  for (const ContourPoint& p : mine_) {
    if (view_.kind == SilhouetteKind::kEdges) {
      carry(mesh.origin(p.segment), p.lengthPx);
      carry(mesh.target(p.segment), p.lengthPx);
    } else {
      for (std::uint32_t k = 0; k < 3; ++k)
        carry(mesh.origins[3 * p.segment + k], p.lengthPx);
    }
  }
  std::vector<Candidate> leaves;
  for (const VertexId v : client_.ids()) {
    if (stamps_[v] != stamp_ && !holds(start_, v)) leaves.push_back({v, votes_[v], votes_[v]});
    votes_[v] = 0.0F;
  }
  const auto count = static_cast<std::size_t>(std::ceil(part * static_cast<double>(leaves.size())));
  if (count == 0) return false;
  std::ranges::sort(leaves, [](const Candidate& a, const Candidate& b) {
    return a.worth != b.worth ? a.worth < b.worth : a.vertex > b.vertex;
  });
  leaves.resize(count);
  for (const Candidate& leaf : leaves)
    held_[leaf.vertex / 64] &= ~(std::uint64_t{1} << (leaf.vertex % 64));
  ActiveMesh before = std::exchange(client_, meshOf(forest_, held_));
  const ContourOff offBefore = off_;
  auto mineBefore = mine_;
  compare();
  if (satisfied()) {
    heldCount_ -= static_cast<std::uint32_t>(count);
    return true;
  }
  for (const Candidate& leaf : leaves)
    held_[leaf.vertex / 64] |= std::uint64_t{1} << (leaf.vertex % 64);
  client_ = std::move(before);
  mine_ = std::move(mineBefore);
  off_ = offBefore;
  return false;
}

bool ContourSearch::run(const std::function<bool()>& isUnwanted) {
  while (!satisfied() && rounds_ < options_.maxRounds) {
    if (isUnwanted() || !addRound()) break;
    compare();
    noteDetail();
    ++rounds_;
  }
  if (!satisfied()) return false;
  double part = 0.5;
  for (int round = 0; round < options_.pruneRounds && part > 0.02; ++round, ++rounds_) {
    if (isUnwanted()) break;
    if (!pruneRound(part)) part *= 0.5;
  }
  return true;
}

TargetSet ContourSearch::target() const {
  TargetSet set;
  set.classes.resize(1);
  set.classes[0].resize(held_.size());
  for (std::size_t word = 0; word < held_.size(); ++word)
    set.classes[0][word] = held_[word] & ~start_[word];
  return set;
}

}  // namespace limn
