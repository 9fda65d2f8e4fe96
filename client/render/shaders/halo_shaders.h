// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace limn::shaders {

/// Marks where visible lines run, a point a spine sample: see LineHalo in
/// client/stroke/line_halo.h.
inline constexpr std::string_view kHaloMarkVertex = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D samples;
uniform highp sampler2D visibility;
uniform vec2 cellsInPicture;  // the picture's size in cells, and the map's
uniform vec2 cellsInMap;
void main() {
  int width = textureSize(visibility, 0).x;
  ivec2 at = ivec2(gl_VertexID % width, gl_VertexID / width);
  vec2 place = texelFetch(samples, ivec2(3 * at.x, at.y), 0).xy;
  bool isMarked = texelFetch(visibility, at, 0).r > 0.5;
  isMarked = isMarked && all(greaterThanEqual(place, vec2(0.0))) && all(lessThan(place, vec2(1.0)));
  // Rows of the map run down, as the picture's do.
  vec2 cell = (floor(place * cellsInPicture) + 0.5) / cellsInMap;
  gl_Position = isMarked ? vec4(2.0 * cell - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 0.0, 1.0);
  gl_PointSize = 1.0;
}
)";

inline constexpr std::string_view kHaloMarkFragment = R"(#version 300 es
precision highp float;
out float mark;
void main() { mark = 1.0; }
)";

/// For every sample its visibility, and 1 where a hidden line is clear of visible ones: not
/// LineHalo::isNear.
inline constexpr std::string_view kHaloFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D samples;
uniform highp sampler2D visibility;
uniform sampler2D marks;
uniform vec2 cellsInPicture;
uniform int reach;  // of the halo, cells
out vec2 result;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  result = vec2(texelFetch(visibility, at, 0).r, 1.0);
  if (result.r > 0.5) return;
  vec2 place = texelFetch(samples, ivec2(3 * at.x, at.y), 0).xy;
  ivec2 cell = ivec2(floor(place * cellsInPicture));
  ivec2 size = textureSize(marks, 0);
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      if (dx * dx + dy * dy > reach * reach + 1) continue;
      ivec2 c = cell + ivec2(dx, dy);
      if (any(lessThan(c, ivec2(0))) || any(greaterThanEqual(c, size))) continue;
      if (texelFetch(marks, c, 0).r > 0.5) {
        result.g = 0.0;
        return;
      }
    }
  }
}
)";

}  // namespace limn::shaders
