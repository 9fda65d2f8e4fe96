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

/// A partly covered pixel: its place, from the bottom left, and how much of what is behind the
/// model shows there.
inline constexpr std::string_view kClipPixelVertex = R"(#version 300 es
layout(location = 0) in highp vec2 pixel;
layout(location = 1) in mediump float coverage;
uniform highp vec2 size;
out mediump float shown;
void main() {
  shown = 1.0 - coverage;
  gl_Position = vec4(2.0 * (pixel + 0.5) / size - 1.0, 0.0, 1.0);
  gl_PointSize = 1.0;
}
)";

inline constexpr std::string_view kClipPixelFragment = R"(#version 300 es
precision mediump float;
in mediump float shown;
uniform vec3 paper;
uniform mediump sampler2D picture;
uniform float isPaper;  // 1: paper is behind the model, 0: what the picture has there
out vec4 color;
void main() {
  vec3 behind = isPaper > 0.0 ? paper : texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb;
  color = vec4(behind, shown);
}
)";

/// The hull by corners: a place, as kMeshVertex, the face's normal and first edge, and where the
/// place is in the map. Fringe: lines along the hull's own silhouette, an instance of them a pixel
/// further to each side, at the far end of depth, give its colours to pixels whose middles it just
/// misses.
inline constexpr std::string_view kHullVertex = R"(#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 faceNormal;
layout(location = 2) in vec3 firstEdge;
layout(location = 3) in vec2 inMap;
layout(location = 4) in vec3 normalAcross;  // fringe: of the face beyond the edge
uniform mat4 clipFromCenter;
uniform vec4 eye;  // as positions; w 0: direction towards it
uniform highp vec2 size;
uniform float fringe;  // 1: the fringe, 0: the hull itself
flat out highp vec3 normal;
flat out highp vec3 along;
out highp vec2 texel;
void main() {
  normal = faceNormal;
  along = firstEdge;
  texel = inMap;
  gl_Position = clipFromCenter * vec4(position, 1.0);
  if (fringe == 0.0) return;
  vec3 towards = eye.xyz - eye.w * position;
  if (dot(faceNormal, towards) <= 0.0 || dot(normalAcross, towards) > 0.0) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  float side = float(gl_InstanceID & 1) * 2.0 - 1.0;
  vec2 away = gl_InstanceID == 4 ? vec2(0.0) : gl_InstanceID < 2 ? vec2(side, 0.0) : vec2(0.0, side);
  gl_Position.xy += 2.0 * away / size * gl_Position.w;
  gl_Position.z = 0.9999995 * gl_Position.w;
}
)";

/// Lambert by the face's normal, or the map's; in one colour, or the map's.
inline constexpr std::string_view kHullFragment = R"(#version 300 es
precision highp float;
flat in highp vec3 normal;
flat in highp vec3 along;
in highp vec2 texel;
uniform highp sampler2D normals;
uniform mediump sampler2D colors;
uniform float mapped;   // 1: by the map of normals
uniform float painted;  // 1: by the map of colours
uniform vec4 light;  // xyz: towards it
uniform vec3 surface;
out vec4 color;
void main() {
  vec3 n = normal;
  if (mapped > 0.0) {
    // As decodeMapNormal.
    vec2 p = (255.0 * texture(normals, texel / vec2(textureSize(normals, 0))).ra - 64.0) / 63.0;
    float z = 1.0 - abs(p.x) - abs(p.y);
    if (z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
    n = normalize(p.x * along + p.y * cross(normal, along) + z * normal);
  }
  vec3 paint = surface;
  if (painted > 0.0) {
    paint = 255.0 / 63.0 * texture(colors, texel / vec2(textureSize(colors, 0))).rgb;
  }
  color = vec4(paint * (0.30 + 0.70 * max(dot(n, light.xyz), 0.0)), 1.0);
}
)";

}  // namespace limn::shaders
