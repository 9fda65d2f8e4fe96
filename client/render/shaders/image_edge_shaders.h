// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Lines where depth or normals of neighbouring pixels do not belong to one smooth surface.
namespace limn::shaders {

/// Normals of faces in the mesh's axes, towards the viewer; alpha 1 where there is a surface. With
/// kMeshVertex.
inline constexpr std::string_view kFaceNormalFragment = R"(#version 300 es
precision highp float;
in highp vec3 place;
out vec4 color;
void main() {
  color = vec4(0.5 + 0.5 * normalize(cross(dFdx(place), dFdy(place))), 1.0);
}
)";

/// One fragment a pixel of the picture. Each of its fine pixels looks at four pairs of opposite
/// pixels, half a line's width away:
/// - depth's second difference is 0 on any plane, in perspective, too, since window depth is linear
///   in the picture; `jump` pixels' worth a pixel of it is a step [Saito90];
/// - normals of a pair that differ by more than creases[1 … 0] (cosines) are a crease
/// [Hertzmann99];
/// - background beside a surface is an outline.
inline constexpr std::string_view kImageEdgeFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D depthMap;
uniform highp sampler2D normalMap;
uniform int supersample;
uniform vec2 width;        // pixels of the picture, at the reference distance; and its falloff
uniform float referenceDistance;
uniform vec2 planes;       // near and far
uniform int orthographic;
uniform float pixelSize;   // of a fine pixel at the reference distance, same unit as planes
uniform float jump;
uniform vec2 creases;
uniform vec2 depthRange;   // where fading begins, and over how much
uniform float fading;
uniform vec3 line;
uniform vec3 paper;
out vec4 color;
float distanceOf(float depth) {
  return orthographic == 1
      ? mix(planes.x, planes.y, depth)
      : planes.x * planes.y / (planes.y - depth * (planes.y - planes.x));
}
float depthAt(ivec2 p, ivec2 last) {
  return texelFetch(depthMap, clamp(p, ivec2(0), last), 0).r;
}
vec4 normalAt(ivec2 p, ivec2 last) {
  return texelFetch(normalMap, clamp(p, ivec2(0), last), 0);
}
// x: ink, y: distance of the nearest surface around.
vec2 edgeAt(ivec2 p, ivec2 last) {
  float here = depthAt(p, last);
  float far = distanceOf(here);
  float growth = orthographic == 1 ? 1.0 : far / referenceDistance;
  float reach = 0.5 * width.x * float(supersample);
  if (width.y > 0.0 && here < 1.0) reach *= clamp(pow(1.0 / growth, width.y), 0.25, 4.0);
  reach = max(reach, 1.0);
  // Window depth that a fine pixel's side is worth.
  float slope = orthographic == 1 ? planes.y - planes.x
                                  : far * far * (planes.y - planes.x) / (planes.x * planes.y);
  float limit = jump * reach * pixelSize * growth / slope;
  float ink = 0.0;
  float nearest = here;
  for (int k = 0; k < 4; ++k) {
    vec2 direction = k == 0 ? vec2(1.0, 0.0) : k == 1 ? vec2(0.0, 1.0)
                   : k == 2 ? vec2(0.7071, 0.7071) : vec2(0.7071, -0.7071);
    ivec2 step = ivec2(round(direction * reach));
    float a = depthAt(p + step, last);
    float b = depthAt(p - step, last);
    nearest = min(nearest, min(a, b));
    float most = max(max(a, b), here);
    if (most >= 1.0) {
      if (min(min(a, b), here) < 1.0) ink = 1.0;
      continue;
    }
    if (abs(a + b - 2.0 * here) > limit) ink = 1.0;
    vec3 n = 2.0 * normalAt(p + step, last).xyz - 1.0;
    vec3 m = 2.0 * normalAt(p - step, last).xyz - 1.0;
    ink = max(ink, 1.0 - smoothstep(creases.x, creases.y, dot(n, m)));
  }
  return vec2(ink, distanceOf(nearest));
}
void main() {
  ivec2 last = textureSize(depthMap, 0) - 1;
  ivec2 first = ivec2(gl_FragCoord.xy) * supersample;
  vec3 sum = vec3(0.0);
  for (int y = 0; y < supersample; ++y) {
    for (int x = 0; x < supersample; ++x) {
      vec2 edge = edgeAt(first + ivec2(x, y), last);
      float fade = clamp((edge.y - depthRange.x) / depthRange.y, 0.0, 1.0);
      sum += mix(paper, line, edge.x * (1.0 - fading * fade));
    }
  }
  color = vec4(sum / float(supersample * supersample), 1.0);
}
)";

}  // namespace limn::shaders
