// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/clip_segment.h"
#include "client/stroke/line_scene.h"

#include <glm/glm.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace limn {

/// Lines as the picture has them: what lies before the near plane or far outside the picture is cut
/// away, so that one line may become several spines. Pixels, origin top left.
struct SpineSet {
  struct Spine {
    LineKind kind = LineKind::kSilhouette;
    bool closed = false;    // the first point is not repeated
    bool freeStart = true;  // a true end of the line, not a cut
    bool freeEnd = true;
    std::uint32_t begin = 0;  // points[begin … end)
    std::uint32_t end = 0;
    std::uint32_t line = 0;  // of the PolylineSet
    glm::vec2 low{0.0F};     // the box around its points
    glm::vec2 high{0.0F};

    /// Of what only joins two spines over a gap (bridgeCusps): where either ends.
    struct Joint {
      std::uint32_t spine = kNone;
      std::uint32_t point = 0;  // of SpineSet::points
      bool isEnd = true;        // what is joined lies before it, not after
    };

    std::array<Joint, 2> joints{};

    /// It is visible where both lines that it joins are.
    [[nodiscard]] bool isBridge() const { return joints[0].spine != kNone; }

    /// Diagonal of its box, pixels.
    [[nodiscard]] float extentPx() const { return glm::distance(low, high); }

    [[nodiscard]] std::uint32_t size() const { return end - begin; }
  };

  std::vector<glm::vec2> points;      // where the stroke is drawn
  std::vector<glm::vec2> exact;       // where the line projects to; differs once smoothed
  std::vector<float> depth;           // window depth in [0, 1], affine along a segment
  std::vector<std::uint32_t> source;  // the point of the PolylineSet whose segment starts here
  std::vector<Spine> spines;

  /// Points begin … end − 1, with all that is known of them, to `to`, which is not after them.
  void movePoints(std::uint32_t begin, std::uint32_t end, std::uint32_t to) {
    if (begin == to) return;
    const auto move = [&](auto& values) {
      for (std::uint32_t i = begin; i < end; ++i)
        values[to + (i - begin)] = values[i];
    };
    move(points);
    move(exact);
    move(depth);
    move(source);
  }

  void resizePoints(std::uint32_t size) {
    points.resize(size);
    exact.resize(size);
    depth.resize(size);
    source.resize(size);
  }
};

/// Whether a line turns by more than a right angle at a point between two others.
[[nodiscard]] inline bool turnsBack(
    const std::vector<glm::vec2>& points,
    std::uint32_t before,
    std::uint32_t at,
    std::uint32_t after) {
  return glm::dot(points[at] - points[before], points[after] - points[at]) < 0.0F;
}

/// Projects and cuts lines. Keeps its working memory from frame to frame.
/// Threads: one caller at a time.
class SpineProjector {
 public:
  /// Fills `out` anew. mergePx: points nearer than this to the one before are left out.
  /// Cost: O(points).
  void project(const PolylineSet& lines, const LineScene& scene, float mergePx, SpineSet& out);

 private:
  std::vector<glm::dvec4> clip_;  // of the line at hand
};

/// Fills `isDrawn`, one entry a point of the PolylineSet: 1 where a spine has the segment that
/// starts there. Cost: O(points).
void markDrawn(const SpineSet& spines, std::size_t points, std::vector<std::uint8_t>& isDrawn);

/// SpineProjector once, with every point that can be told from its neighbour.
[[nodiscard]] SpineSet projectLines(const PolylineSet& lines, const LineScene& scene);

/// Evens out the zig-zag of lines made of short mesh edges: every point moves to the weighted mean
/// (a bell of standard deviation sigmaPx along the line) of its neighbours, so that corners between
/// long segments stay where they are; ends stay. Cost: O(points) for segments of about sigmaPx.
void smoothSpines(float sigmaPx, SpineSet& spines);

/// Distance along each spine from its start to each of its points, in pixels, as drawn; and the
/// whole length (a closed spine's includes its last segment).
struct SpineArcs {
  std::vector<float> arc;     // parallel to SpineSet::points
  std::vector<float> length;  // parallel to SpineSet::spines
};

/// Distance along the spine that a bridge joins, a little before where they meet: what is visible
/// there decides about the bridge.
[[nodiscard]] float
arcBefore(const SpineSet& spines, const SpineArcs& arcs, const SpineSet::Spine::Joint& joint);

[[nodiscard]] SpineArcs measureSpines(const SpineSet& spines);
/// The same into `arcs`, whose memory is used again.
void measureSpines(const SpineSet& spines, SpineArcs& arcs);

}  // namespace limn
