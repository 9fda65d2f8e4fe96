// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/line_scene.h"
#include "client/stroke/parameters.h"
#include "client/stroke/spine.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Parameters that stay put from frame to frame: every frame leaves marks along its lines, points
/// on the model with their parameters; the next frame's lines take theirs from the marks beside
/// them in its own picture. Lines that find none start anew (freshParameters).
/// Threads: one caller at a time.
class CoherentParameters {
 public:
  /// Parameters of this frame's spines, after the last call's. A frame with the same camera, lines
  /// and period has the same ones, to the last bit; with another period alone it starts anew. Cost:
  /// O(length in pixels).
  void assign(
      const SpineSet& spines,
      const SpineArcs& arcs,
      const PolylineSet& lines,
      const LineScene& scene,
      float periodPx,
      SpineParameters& out);

 private:
  /// A place on the last frame's lines, a few pixels from the one before.
  struct Mark {
    glm::dvec3 point;  // grid units
    float parameter;
    bool isFirst;  // of its spine, or after a seam
  };

  /// A mark in the new picture.
  struct Seen {
    glm::vec2 point;
    glm::vec2 along;  // unit, 0 when unknown
    float distance;   // from the eye along the view, model units
    float parameter;
    std::uint32_t number;  // in inOrder_
  };

  /// What a mark says about a place on a new line: parameter less arc length.
  struct Vote {
    float arc;
    float offset;
  };

  /// Votes that agree: from a place on, so much is to be added to the arc length.
  struct Run {
    std::uint32_t begin;  // votes_[begin … end)
    std::uint32_t end;
  };

  void look(const LineScene& scene, float periodPx);
  void
  vote(const SpineSet& spines, const SpineArcs& arcs, std::size_t spine, const LineScene& scene);
  void findRuns(float periodPx);
  void settle(float length);
  void write(
      const SpineSet& spines,
      const SpineArcs& arcs,
      std::size_t spine,
      float periodPx,
      SpineParameters& out) const;
  void leaveMarks(
      const SpineSet& spines,
      const SpineArcs& arcs,
      const LineScene& scene,
      const SpineParameters& parameters);

  std::vector<Mark> marks_;
  glm::dmat4 lastClipFromGrid_{0.0};
  float lastPeriodPx_ = 1.0F;
  std::vector<glm::vec2> lastPoints_;
  SpineParameters last_;
  // Of the call.
  std::vector<Seen> inOrder_;         // along the lines, as marks_
  std::vector<Seen> seen_;            // by cell
  std::vector<std::uint32_t> cells_;  // first of each cell in seen_, and one past the last
  int columns_ = 0;
  int rows_ = 0;
  float moved_ = 0.0F;  // mean distance of votes from their marks, pixels
  std::vector<Vote> votes_;
  std::vector<Run> runs_;
};

}  // namespace limn
