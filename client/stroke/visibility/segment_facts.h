// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/line_scene.h"
#include "client/stroke/scene_faces.h"

#include <glm/glm.hpp>

#include <cstdint>

namespace limn {

/// What the mesh says about how one segment of a line, seen from a camera, is to be looked up in a
/// depth image.
struct SegmentFacts {
  float bias = 0.0F;  // window depth that its own surface may rise above it nearby
  /// On which side of the line, seen along it in the picture, its surface ends: 1 right, −1 left,
  /// 0 neither (surface on both sides).
  float openSide = 0.0F;
  /// How far, in pixels to that side, the corners of the line's face stand out beyond the line:
  /// where the mesh's own outline is, of a smooth silhouette inside it.
  float standOutPx = 0.0F;
};

/// A point of a line as the picture has it.
struct LineEnd {
  std::uint32_t point = kNone;  // of the PolylineSet
  bool isInside = false;        // isInPicture()
  glm::dvec4 inClip{0.0};
  glm::dvec3 inPicture{0.0};  // pixels, window depth; means nothing behind the eye
};

/// Works out SegmentFacts for one camera.
class SegmentJudge {
 public:
  SegmentJudge(const PolylineSet& lines, const LineScene& scene);

  /// The segment of `line` on the edge or face of lines.points[point]. Cost: O(1).
  [[nodiscard]] SegmentFacts judge(
      const PolylineSet::Line& line,
      std::uint32_t point,
      const LineEnd& from,
      const LineEnd& to) const;

 private:
  [[nodiscard]] SegmentFacts judgeSmooth(FaceId face, const LineEnd& from, const LineEnd& to) const;
  /// Depth that face may rise within reachPx of a line on it, at most its own depth range.
  [[nodiscard]] float slopeBias(FaceId face, float reachPx) const;
  /// Of the faces across a sliver's edges.
  [[nodiscard]] float biasAround(FaceId face) const;
  [[nodiscard]] glm::dvec4 clipOf(const glm::dvec3& p) const;

  const PolylineSet& lines_;
  LineScene scene_;
  SceneFaces faces_;
  glm::dmat4 clipFromGrid_;
  glm::dmat4 clipRows_;  // the same, row by row
  double floor_;         // window depth
};

}  // namespace limn
