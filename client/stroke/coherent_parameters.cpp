// SPDX-License-Identifier: Apache-2.0
// Based on: R. D. Kalnins, P. L. Davidson, L. Markosian, A. Finkelstein, "Coherent Stylized
// Silhouettes", SIGGRAPH 2003: samples of the last frame's brush paths vote for the parameters of
// the new frame's.
// Deviations: marks are carried by projecting their model points (a contour's old points lie within
// a fraction of a pixel of the new contour); agreement is judged by offset from arc length, modulo
// the texture's period, and votes are used as they are, so that nothing is fitted and a still
// picture stays still.
#include "client/stroke/coherent_parameters.h"

#include "client/stroke/view_distance.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr float kStepPx = 6.0F;    // between marks, and between questions
constexpr float kReachPx = 6.0F;   // how far a line may have moved from its mark
constexpr float kDepthPx = 40.0F;  // and in depth, in pixels' worth of model
constexpr int kCellPx = 8;
constexpr float kMinCosine = 0.6F;  // between the line now and then
/// Votes a step apart agree when the texture between them is stretched by less than this share.
constexpr float kMaxStretch = 0.5F;
/// Runs of fewer votes than this are no more than chance, unless there is nothing else.
constexpr std::uint32_t kShortRun = 3;
/// Stretches beyond this relax towards none, by so much a frame.
constexpr float kEasyStretch = 0.15F;
constexpr float kRelaxation = 0.03F;
constexpr float kMaxSlidePx = 0.5F;

float wrapped(float value, float period) {
  const float turns = value / period;
  return std::abs(turns) < 0.5F ? value : value - period * std::round(turns);
}

/// Walks a spine by arc length.
class Walker {
 public:
  Walker(const SpineSet& spines, const SpineArcs& arcs, std::size_t index)
      : arcs_(arcs),
        spine_(spines.spines[index]),
        length_(arcs.length[index]),
        at_(spine_.begin) {}

  struct Place {
    std::uint32_t from;
    std::uint32_t to;
    float t;
  };

  /// The place at an arc length not below the last one asked for.
  Place at(float arc) {
    const std::uint32_t last = spine_.end - (spine_.closed ? 1 : 2);
    while (at_ < last && arcs_.arc[at_ + 1] < arc)
      ++at_;
    const std::uint32_t to = at_ + 1 < spine_.end ? at_ + 1 : spine_.begin;
    const float end = at_ + 1 < spine_.end ? arcs_.arc[to] : length_;
    const float extent = end - arcs_.arc[at_];
    const float t = extent > 0.0F ? std::clamp((arc - arcs_.arc[at_]) / extent, 0.0F, 1.0F) : 0.0F;
    return {at_, to, t};
  }

  /// Steps of at most kStepPx; both ends of an open spine are among them.
  [[nodiscard]] std::uint32_t steps() const {
    return std::max(1U, static_cast<std::uint32_t>(std::ceil(length_ / kStepPx)));
  }

 private:
  const SpineArcs& arcs_;
  const SpineSet::Spine& spine_;
  float length_;
  std::uint32_t at_;
};

}  // namespace

void CoherentParameters::assign(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const PolylineSet& lines,
    const LineScene& scene,
    float periodPx,
    SpineParameters& out) {
  const glm::dmat4 toClip = clipFromGrid(scene);
  if (toClip == lastClipFromGrid_ && spines.points == lastPoints_) {
    if (periodPx == lastPeriodPx_) {
      out = last_;
      return;
    }
    marks_.clear();  // of textures of another size: as marks they would stretch these
  }
  freshParameters(spines, arcs, lines, periodPx, out);
  if (!marks_.empty()) {
    look(scene, periodPx);
    for (std::size_t s = 0; s < spines.spines.size(); ++s) {
      vote(spines, arcs, s, scene);
      if (votes_.empty()) continue;
      findRuns(periodPx);
      settle(arcs.length[s]);
      write(spines, arcs, s, periodPx, out);
    }
  }
  leaveMarks(spines, arcs, scene, out);
  lastClipFromGrid_ = toClip;
  lastPeriodPx_ = periodPx;
  lastPoints_ = spines.points;
  last_ = out;
}

/// Projects the marks and sorts them into cells of the picture.
void CoherentParameters::look(const LineScene& scene, float periodPx) {
  // A picture of another size, or wider strokes: the same place in the texture.
  const float scale = periodPx / lastPeriodPx_;
  const glm::dmat4 toClip = clipFromGrid(scene);
  columns_ = scene.viewport.width / kCellPx + 1;
  rows_ = scene.viewport.height / kCellPx + 1;
  inOrder_.clear();
  std::uint32_t before = kNone;
  for (const Mark& mark : marks_) {
    const glm::dvec4 clip = toClip * glm::dvec4(mark.point, 1.0);
    if (mark.isFirst) before = kNone;
    if (!(clip.w > 0.0)) {
      before = kNone;
      continue;
    }
    const glm::dvec3 pixel = pixelFromClip(clip, scene.viewport);
    Seen seen{glm::vec2(pixel), glm::vec2(0.0F), 0.0F, scale * mark.parameter, 0};
    seen.distance = viewDistance(scene.camera, static_cast<float>(pixel.z));
    if (before != kNone) {
      const glm::vec2 step = seen.point - inOrder_[before].point;
      const float size = glm::length(step);
      if (size > 1e-3F) {
        seen.along = step / size;
        if (inOrder_[before].along == glm::vec2(0.0F)) inOrder_[before].along = seen.along;
      }
    }
    before = seen.number = static_cast<std::uint32_t>(inOrder_.size());
    inOrder_.push_back(seen);
  }
  const auto cellOf = [&](const glm::vec2& p) {
    const int x = std::clamp(static_cast<int>(p.x) / kCellPx, 0, columns_ - 1);
    const int y = std::clamp(static_cast<int>(p.y) / kCellPx, 0, rows_ - 1);
    return static_cast<std::size_t>(y * columns_ + x);
  };
  // First how many, then where each cell ends; filling from the back leaves where it begins.
  cells_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  for (const Seen& seen : inOrder_)
    ++cells_[cellOf(seen.point)];
  for (std::size_t i = 1; i < cells_.size(); ++i)
    cells_[i] += cells_[i - 1];
  seen_.resize(inOrder_.size());
  for (std::size_t i = inOrder_.size(); i-- > 0;)
    seen_[--cells_[cellOf(inOrder_[i].point)]] = inOrder_[i];
}

void CoherentParameters::vote(
    const SpineSet& spines,
    const SpineArcs& arcs,
    std::size_t spine,
    const LineScene& scene) {
  votes_.clear();
  moved_ = 0.0F;
  Walker walker(spines, arcs, spine);
  const std::uint32_t steps = walker.steps();
  const float length = arcs.length[spine];
  const float unit = pixelsPerUnit(
      scene.camera,
      scene.viewport,
      viewDistance(scene.camera, spines.depth[spines.spines[spine].begin]));
  std::uint32_t expected = kNone;  // the mark after the last place's
  for (std::uint32_t k = 0; k <= steps; ++k) {
    const float arc = length * static_cast<float>(k) / static_cast<float>(steps);
    const Walker::Place place = walker.at(arc);
    const glm::vec2 at = glm::mix(spines.exact[place.from], spines.exact[place.to], place.t);
    const glm::vec2 step = spines.points[place.to] - spines.points[place.from];
    const float size = glm::length(step);
    if (!(size > 1e-6F)) continue;
    const glm::vec2 along = step / size;
    const float distance = viewDistance(
        scene.camera,
        glm::mix(spines.depth[place.from], spines.depth[place.to], place.t));
    float best = kReachPx * kReachPx;
    const Seen* mark = nullptr;
    const auto consider = [&](const Seen& candidate) {
      const glm::vec2 away = candidate.point - at;
      // Beside the line counts four times: two lines may run close to one another.
      const float ahead = glm::dot(away, along);
      const float score = 4.0F * glm::dot(away, away) - 3.0F * ahead * ahead;
      if (score >= best) return;
      if (glm::dot(candidate.along, along) < kMinCosine) return;
      if (std::abs(candidate.distance - distance) * unit > kDepthPx) return;
      best = score;
      mark = &candidate;
    };
    // Mostly it is the best, and none farther away than its score says can be better.
    if (expected < inOrder_.size()) consider(inOrder_[expected]);
    const float reach = mark != nullptr ? std::min(std::sqrt(best) + 0.01F, kReachPx) : kReachPx;
    const auto cellAt = [](float p, int count) {
      return std::clamp(static_cast<int>(p) / kCellPx, 0, count - 1);
    };
    const int firstX = cellAt(at.x - reach, columns_);
    const int lastX = cellAt(at.x + reach, columns_);
    const int lastY = cellAt(at.y + reach, rows_);
    for (int cy = cellAt(at.y - reach, rows_); cy <= lastY; ++cy) {
      const auto row = static_cast<std::size_t>(cy * columns_);
      const std::uint32_t end = cells_[row + static_cast<std::size_t>(lastX) + 1];
      for (std::uint32_t i = cells_[row + static_cast<std::size_t>(firstX)]; i < end; ++i)
        consider(seen_[i]);
    }
    if (mark == nullptr) continue;
    expected = mark->number + 1;
    moved_ += std::sqrt(best);
    votes_.push_back({arc, mark->parameter + glm::dot(at - mark->point, along) - arc});
  }
  if (!votes_.empty()) moved_ /= static_cast<float>(votes_.size());
}

/// Joins votes that agree, modulo the period, into runs; chance ones are left out.
void CoherentParameters::findRuns(float periodPx) {
  const auto split = [&] {
    runs_.clear();
    for (std::uint32_t i = 0; i < votes_.size(); ++i) {
      if (i > 0) {
        const float steps = std::max(1.0F, (votes_[i].arc - votes_[i - 1].arc) / kStepPx);
        const float change = wrapped(votes_[i].offset - votes_[i - 1].offset, periodPx);
        if (std::abs(change) < kMaxStretch * kStepPx * std::min(steps, 4.0F)) {
          votes_[i].offset = votes_[i - 1].offset + change;
          runs_.back().end = i + 1;
          continue;
        }
      }
      runs_.push_back({i, i + 1});
    }
  };
  split();
  if (runs_.size() < 2) return;
  std::uint32_t kept = 0;
  std::uint32_t longest = 0;
  for (const Run& run : runs_)
    longest = std::max(longest, run.end - run.begin);
  for (const Run& run : runs_) {
    if (run.end - run.begin < std::min(kShortRun, longest)) continue;
    for (std::uint32_t i = run.begin; i < run.end; ++i)
      votes_[kept++] = votes_[i];
  }
  votes_.resize(kept);
  split();
}

/// Lets runs that are stretched too far relax a little, and evens out what the votes' own noise
/// adds up to; not while nothing moves.
void CoherentParameters::settle(float length) {
  if (moved_ < 0.02F) return;
  for (const Run& run : runs_) {
    const std::uint32_t count = run.end - run.begin;
    if (count < 5) continue;
    Vote* votes = &votes_[run.begin];
    // A short mean: [1 2 1] / 4 of the inner ones.
    float before = votes[0].offset;
    for (std::uint32_t i = 1; i + 1 < count; ++i) {
      const float own = votes[i].offset;
      votes[i].offset = 0.25F * before + 0.5F * own + 0.25F * votes[i + 1].offset;
      before = own;
    }
    const float extent = votes[count - 1].arc - votes[0].arc;
    if (!(extent > 0.0F)) continue;
    const float stretch = (votes[count - 1].offset - votes[0].offset) / extent;
    const float excess = std::abs(stretch) - kEasyStretch;
    if (excess <= 0.0F) continue;
    const float largest = 0.5F * length * excess * kRelaxation;
    const float share = kRelaxation * std::copysign(excess, stretch) *
                        std::min(1.0F, kMaxSlidePx / std::max(largest, 1e-6F));
    const float middle = 0.5F * (votes[0].arc + votes[count - 1].arc);
    for (std::uint32_t i = 0; i < count; ++i)
      votes[i].offset -= share * (votes[i].arc - middle);
  }
}

void CoherentParameters::write(
    const SpineSet& spines,
    const SpineArcs& arcs,
    std::size_t spineIndex,
    float periodPx,
    SpineParameters& out) const {
  const SpineSet::Spine& spine = spines.spines[spineIndex];
  // Numbers stay small, however many frames.
  const float base = periodPx * std::floor(votes_.front().offset / periodPx);
  std::size_t run = 0;
  std::uint32_t vote = 0;
  const auto seamAfter = [&](std::size_t r) {
    return 0.5F * (votes_[runs_[r].end - 1].arc + votes_[runs_[r + 1].begin].arc);
  };
  const auto parameterAt = [&](float arc, std::size_t r) {
    const Run& votes = runs_[r];
    vote = std::clamp(vote, votes.begin, votes.end - 1);
    while (vote + 1 < votes.end && votes_[vote + 1].arc <= arc)
      ++vote;
    float offset = votes_[vote].offset;
    if (arc > votes_[vote].arc && vote + 1 < votes.end) {
      const float t = (arc - votes_[vote].arc) / (votes_[vote + 1].arc - votes_[vote].arc);
      offset = glm::mix(offset, votes_[vote + 1].offset, t);
    }
    return arc + offset - base;
  };
  for (std::uint32_t i = spine.begin; i < spine.end; ++i) {
    const float arc = arcs.arc[i];
    if (i > spine.begin) out.to[i - 1] = parameterAt(arc, run);
    // A seam is at the first point after its place.
    while (run + 1 < runs_.size() && seamAfter(run) <= arc)
      ++run;
    out.from[i] = parameterAt(arc, run);
  }
  out.to[spine.end - 1] = parameterAt(arcs.length[spineIndex], run);
}

void CoherentParameters::leaveMarks(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const LineScene& scene,
    const SpineParameters& parameters) {
  const glm::dmat4 gridFromClip = glm::inverse(clipFromGrid(scene));
  marks_.clear();
  for (std::size_t s = 0; s < spines.spines.size(); ++s) {
    Walker walker(spines, arcs, s);
    const std::uint32_t steps = walker.steps();
    std::uint32_t before = kNone;
    bool hasSeam = false;
    for (std::uint32_t k = 0; k <= steps; ++k) {
      const float arc = arcs.length[s] * static_cast<float>(k) / static_cast<float>(steps);
      const Walker::Place place = walker.at(arc);
      for (std::uint32_t i = before; before != kNone && i < place.from; ++i)
        hasSeam = hasSeam || parameters.to[i] != parameters.from[i + 1];
      const glm::dvec2 pixel(glm::mix(spines.exact[place.from], spines.exact[place.to], place.t));
      const double depth = glm::mix(spines.depth[place.from], spines.depth[place.to], place.t);
      const glm::dvec4 clip(
          2.0 * pixel.x / scene.viewport.width - 1.0,
          1.0 - 2.0 * pixel.y / scene.viewport.height,
          2.0 * depth - 1.0,
          1.0);
      const glm::dvec4 point = gridFromClip * clip;
      const float parameter =
          glm::mix(parameters.from[place.from], parameters.to[place.from], place.t);
      marks_.push_back({glm::dvec3(point) / point.w, parameter, k == 0 || hasSeam});
      hasSeam = false;
      before = place.from;
    }
  }
}

}  // namespace limn
