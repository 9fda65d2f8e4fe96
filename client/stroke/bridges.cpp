// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/bridges.h"

#include "client/stroke/scene_faces.h"
#include "client/stroke/view_distance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

namespace limn {
namespace {

/// Its direction at a cusp is a line's over this share of a bridge's reach, pixels.
constexpr float kDirectionShare = 0.4F;

/// A bridge leaves either line by at most this angle's cosine.
constexpr float kStraightOn = 0.8F;

/// Along a fold depths differ by at most so many times its length in the picture.
constexpr double kSteepest = 6.0;

/// Where a line goes out of sight behind its own surface, or comes out from it.
struct Cusp {
  /// Along contours the surface is on one side, so that one that comes out goes on what went in.
  enum class Way : std::uint8_t { kIn, kOut, kEither };

  glm::vec2 at{0.0F};
  glm::vec2 onward{0.0F};   // unit vector: where the visible part would go on
  std::uint32_t point = 0;  // of the SpineSet
  std::uint32_t spine = 0;
  std::uint32_t source = 0;  // of the visible segment that ends there
  bool isEnd = true;         // of the visible part, or else its start
  Way way = Way::kEither;
};

bool mayBeOne(const Cusp& a, const Cusp& b) {
  return a.way != b.way || a.way == Cusp::Way::kEither;
}

/// Collects the cusps of a view's contours, and where suggestive contours end at such.
class CuspFinder {
 public:
  CuspFinder(
      const PolylineSet& lines,
      const LineScene& scene,
      float reachPx,
      const SpineSet& spines)
      : lines_(lines),
        faces_(scene),
        directionPx_(kDirectionShare * reachPx),
        spines_(spines) {}

  void add(std::uint32_t index, std::vector<Cusp>& cusps) const {
    const SpineSet::Spine& spine = spines_.spines[index];
    const PolylineSet::Line& line = lines_.lines[spine.line];
    if (line.back == PolylineSet::Back::kSeen) return;
    if (!line.isContour() && spine.kind != LineKind::kSuggestive) return;
    const std::uint32_t ends = spine.closed ? 0 : 1;
    for (std::uint32_t i = spine.begin + ends; i + ends < spine.end; ++i) {
      const std::uint32_t before = beside(spine, i, true);
      // In the picture a contour turns back where its surface does.
      if (line.isContour() && !turnsBack(spines_.points, before, i, beside(spine, i, false)))
        continue;
      const bool wasHidden = isHidden(line, spines_.source[before]);
      const bool isHiddenNow = isHidden(line, spines_.source[i]);
      if (wasHidden != isHiddenNow) addEnd(index, i, isHiddenNow, cusps);
    }
  }

 private:
  /// By its own surface; of edges that is not asked.
  [[nodiscard]] bool isHidden(const PolylineSet::Line& line, std::uint32_t point) const {
    if (line.isContour()) return faces_.hidesSmooth(lines_, line, point);
    const FaceId face = lines_.faces[point];
    return line.back == PolylineSet::Back::kNeverSeen && lines_.halfEdges[point] == kNone &&
           face != kNone && !faces_.isFront(face);
  }

  /// The point before one, or after it; an open spine's last ones are beside themselves.
  static std::uint32_t beside(const SpineSet::Spine& spine, std::uint32_t i, bool isBefore) {
    const std::uint32_t end = isBefore ? spine.begin : spine.end - 1;
    if (i != end) return isBefore ? i - 1 : i + 1;
    return !spine.closed ? i : (isBefore ? spine.end - 1 : spine.begin);
  }

  /// isEnd: the visible part lies before point i, not after it.
  void addEnd(std::uint32_t index, std::uint32_t i, bool isEnd, std::vector<Cusp>& cusps) const {
    const SpineSet::Spine& spine = spines_.spines[index];
    const std::vector<glm::vec2>& p = spines_.points;
    std::uint32_t k = i;
    for (std::uint32_t step = 1; step < spine.size() && glm::distance(p[k], p[i]) < directionPx_;
         ++step)
      k = beside(spine, k, isEnd);
    const glm::vec2 along = p[i] - p[k];
    const float length = glm::length(along);
    if (length < directionPx_) return;  // too short to have one
    const bool isContour = lines_.lines[spine.line].isContour();
    cusps.push_back(
        {p[i],
         along / length,
         i,
         index,
         spines_.source[isEnd ? beside(spine, i, true) : i],
         isEnd,
         !isContour ? Cusp::Way::kEither : (isEnd ? Cusp::Way::kOut : Cusp::Way::kIn)});
  }

  const PolylineSet& lines_;
  SceneFaces faces_;
  float directionPx_;
  const SpineSet& spines_;
};

struct Match {
  float cost = 0.0F;
  std::uint32_t from = 0;  // of the cusps
  std::uint32_t to = 0;
};

/// Finds which cusps are ends of one line, best ones first. cusps: by their x.
std::vector<Match> matchCusps(
    const std::vector<Cusp>& cusps,
    const SpineSet& spines,
    const LineScene& scene,
    float reachPx) {
  std::vector<Match> matches;
  for (std::uint32_t i = 0; i < cusps.size(); ++i) {
    const Cusp& from = cusps[i];
    for (std::uint32_t j = i + 1; j < cusps.size() && cusps[j].at.x - from.at.x <= reachPx; ++j) {
      const Cusp& to = cusps[j];
      const glm::vec2 gap = to.at - from.at;
      const float length = glm::length(gap);
      if (!mayBeOne(from, to) || length > reachPx || !(length > 0.0F)) continue;
      const float leaves = glm::dot(gap, from.onward) / length;
      const float meets = -glm::dot(gap, to.onward) / length;
      if (leaves < kStraightOn || meets < kStraightOn) continue;
      const double distance = viewDistance(scene.camera, spines.depth[from.point]);
      const double depth = std::abs(distance - viewDistance(scene.camera, spines.depth[to.point]));
      if (depth * pixelsPerUnit(scene.camera, scene.viewport, distance) > kSteepest * length)
        continue;
      matches.push_back({length * (3.0F - leaves - meets), i, j});
    }
  }
  std::sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) {
    return std::tie(a.cost, a.from, a.to) < std::tie(b.cost, b.from, b.to);
  });
  return matches;
}

/// A curve that goes on as either line does.
void appendBridge(const Cusp& from, const Cusp& to, SpineSet& spines) {
  SpineSet::Spine spine;
  // Thin where one of them is.
  spine.kind = std::max(spines.spines[from.spine].kind, spines.spines[to.spine].kind);
  spine.line = spines.spines[from.spine].line;
  spine.freeStart = spine.freeEnd = false;
  spine.joints = {{{from.spine, from.point, from.isEnd}, {to.spine, to.point, to.isEnd}}};
  spine.begin = static_cast<std::uint32_t>(spines.points.size());
  spine.low = glm::min(from.at, to.at);
  spine.high = glm::max(from.at, to.at);
  const float length = glm::distance(from.at, to.at);
  const auto parts = static_cast<int>(std::ceil(std::max(0.5F * length, 1.0F)));
  for (int k = 0; k <= parts; ++k) {
    const float t = static_cast<float>(k) / static_cast<float>(parts);
    const float s = 1.0F - t;
    const glm::vec2 place = s * s * (1.0F + 2.0F * t) * from.at +
                            t * t * (1.0F + 2.0F * s) * to.at +
                            length * s * t * (s * from.onward + t * to.onward);
    spines.points.push_back(place);
    spines.exact.push_back(place);
    spines.depth.push_back(glm::mix(spines.depth[from.point], spines.depth[to.point], t));
    spines.source.push_back(2 * k < parts ? from.source : to.source);
  }
  spine.end = static_cast<std::uint32_t>(spines.points.size());
  spines.spines.push_back(spine);
}

}  // namespace

void bridgeCusps(
    const PolylineSet& lines,
    const LineScene& scene,
    float reachPx,
    SpineSet& spines,
    std::vector<LineFade>& fades) {
  std::vector<Cusp> cusps;
  const CuspFinder finder(lines, scene, reachPx, spines);
  for (std::uint32_t i = 0; i < spines.spines.size(); ++i)
    finder.add(i, cusps);
  std::sort(cusps.begin(), cusps.end(), [](const Cusp& a, const Cusp& b) {
    return std::tie(a.at.x, a.point) < std::tie(b.at.x, b.point);
  });
  std::vector<std::uint8_t> isJoined(cusps.size(), 0);
  for (const Match& match : matchCusps(cusps, spines, scene, reachPx)) {
    if (isJoined[match.from] != 0 || isJoined[match.to] != 0) continue;
    isJoined[match.from] = isJoined[match.to] = 1;
    const Cusp& from = cusps[match.from];
    const Cusp& to = cusps[match.to];
    appendBridge(from, to, spines);
    fades.push_back({std::min(fades[from.spine].visible, fades[to.spine].visible), 0.0F});
  }
}

}  // namespace limn
