// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"

#include <glm/glm.hpp>

#include <cstdint>

namespace limn {

/// A segment of a line as the picture has it. Internal to LineSpanFinder.
struct SpanSegment {
  glm::dvec3 from{0.0};  // pixels, window depth
  glm::dvec3 to{0.0};
  std::uint32_t begin = 0;  // points: where it starts, whose answers it has, where it ends
  std::uint32_t point = 0;
  std::uint32_t next = 0;
  FaceId face = kNone;
  FaceId other = kNone;   // across its edge, if it is one with two faces
  bool isSmooth = false;  // on no edge
  bool isInPicture = false;
  bool isHidden = false;    // by its own surface, all along it
  bool isDoubtful = false;  // hidden so if the back side of its surface cannot be seen
  bool isHiddenAtStart = false;
  bool isHiddenAtEnd = false;
  /// Where in the picture its surface ends: 1 right of it, −1 left, 0 nowhere.
  std::int8_t openSide = 0;
  std::uint32_t edge = 0;  // its number among LineCrossings' edges, where a surface ends at it
  /// Shares of it in the picture, from its start and from its end, that the faces around these
  /// cover. Only where silhouettes are smooth.
  float coveredFromStart = 0.0F;
  float coveredFromEnd = 0.0F;
  std::uint32_t nearBegin = 0;  // into the numbers of edges beside it
  std::uint32_t nearEnd = 0;
};

}  // namespace limn
