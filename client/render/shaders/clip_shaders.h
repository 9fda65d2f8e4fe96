// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Shaders of ClipMethod, `#version 300 es`.
namespace limn::shaders {

inline constexpr std::string_view kClipStencilVertex = R"(#version 300 es
layout(location = 0) in highp vec2 place;  // pixels
uniform highp vec2 size;
void main() {
  gl_Position = vec4(2.0 * place / size - 1.0, 0.0, 1.0);
}
)";

inline constexpr std::string_view kLevelFragment = R"(#version 300 es
precision mediump float;
uniform float level;
out vec4 color;
void main() {
  color = vec4(level);
}
)";

/// A strip of four corners that has the middles of all pixels that one contour edge touches.
inline constexpr std::string_view kClipEdgeVertex = R"(#version 300 es
precision highp float;
layout(location = 0) in vec3 from;  // pixels; z: 0 at the end of a loop
layout(location = 1) in vec3 to;
uniform vec2 size;
flat out vec2 a;
flat out vec2 b;
void main() {
  a = from.xy;
  b = to.xy;
  float len = distance(a, b);
  if (from.z == 0.0 || len == 0.0) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  const float kReach = 0.7072;  // from a pixel's middle to its corners
  vec2 along = (b - a) / len;
  vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
  vec2 place = a + mix(-kReach, len + kReach, corner.x) * along +
               mix(-kReach, kReach, corner.y) * vec2(-along.y, along.x);
  gl_Position = vec4(2.0 * place / size - 1.0, 0.0, 1.0);
}
)";

/// What an edge changes of a pixel's mean winding number, which without edges is that of its
/// middle: the area of the pixel that lies behind the edge as seen from the middle. More in red,
/// less in green, in eighths: where a surface is seen edge-on many edges share a pixel.
inline constexpr std::string_view kClipEdgeFragment = R"(#version 300 es
precision highp float;
flat in vec2 a;
flat in vec2 b;
out vec4 change;
/// Where the ray towards v meets the square around the middle, along its border, 8 in all.
float around(vec2 v) {
  vec2 u = v / max(abs(v.x), abs(v.y));
  if (abs(v.x) >= abs(v.y)) return v.x > 0.0 ? u.y : 4.0 - u.y;
  return v.y > 0.0 ? 2.0 - u.x : 6.0 + u.x;
}
void main() {
  vec2 p = a - gl_FragCoord.xy;
  vec2 d = b - a;
  float first = 0.0;
  float last = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    if (d[axis] == 0.0) {
      if (abs(p[axis]) > 0.5) discard;
      continue;
    }
    float s = (-0.5 - p[axis]) / d[axis];
    float t = (0.5 - p[axis]) / d[axis];
    first = max(first, min(s, t));
    last = min(last, max(s, t));
  }
  if (first >= last) discard;
  vec2 from = p + first * d;
  vec2 to = p + last * d;
  float turn = from.x * to.y - from.y * to.x;
  if (turn == 0.0) discard;
  float arc = around(to) - around(from);
  if (turn > 0.0 && arc < 0.0) arc += 8.0;
  if (turn < 0.0 && arc > 0.0) arc -= 8.0;
  float less = arc / 8.0 - turn / 2.0;
  change = vec4(max(-less, 0.0), max(less, 0.0), 0.0, 0.0) / 8.0;
}
)";

/// The hull by corners: a place, as kMeshVertex, and where that is in the map.
inline constexpr std::string_view kHullVertex = R"(#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 inMap;
uniform mat4 clipFromCenter;
out highp vec2 texel;
void main() {
  texel = inMap;
  gl_Position = clipFromCenter * vec4(position, 1.0);
}
)";

/// As kShadedFragment, by the map of normals.
inline constexpr std::string_view kMappedFragment = R"(#version 300 es
precision highp float;
in highp vec2 texel;
uniform highp sampler2D normals;
uniform vec4 light;  // xyz: towards it
uniform vec3 surface;
out vec4 color;
void main() {
  vec3 n = 2.0 * texture(normals, texel / vec2(textureSize(normals, 0))).rgb - 1.0;
  float lit = 0.30 + 0.70 * max(dot(normalize(n), light.xyz), 0.0);
  color = vec4(surface * lit, 1.0);
}
)";

/// The hull over the paper, as far as the outline covers each pixel.
inline constexpr std::string_view kClipFragment = R"(#version 300 es
precision highp float;
uniform highp sampler2D winding;  // of the pixels' middles, up to 4, in quarters
uniform highp sampler2D change;
uniform highp sampler2D surface;  // alpha: whether the hull is there
uniform vec3 paper;
out vec4 color;
void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  vec4 by = texelFetch(change, texel, 0);
  float alpha = clamp(4.0 * texelFetch(winding, texel, 0).r + 8.0 * (by.r - by.g), 0.0, 1.0);
  vec4 lit = texelFetch(surface, texel, 0);
  if (alpha > 0.0 && lit.a < 0.5) {
    // The hull may touch the surface where that ends: its neighbours' colour goes on.
    vec4 sum = vec4(0.0);
    ivec2 last = textureSize(surface, 0) - 1;
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x)
        sum += texelFetch(surface, clamp(texel + ivec2(x, y), ivec2(0), last), 0);
    }
    if (sum.a > 0.0) lit = sum / sum.a;
    else alpha = 0.0;
  }
  color = vec4(mix(paper, lit.rgb, alpha), 1.0);
}
)";

}  // namespace limn::shaders
