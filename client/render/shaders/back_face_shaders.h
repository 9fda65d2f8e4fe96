// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Silhouettes from back faces [Raskar99]: vertex shaders that read whole faces from textures by
/// gl_VertexID, so that each corner knows the other two without adjacency. A vertex shader is
/// kEs300, kFaceCommon and one of the mains below; kLineFragment or kGreyFragment goes with it.
namespace limn::shaders {

inline constexpr std::string_view kEs300 = "#version 300 es\n";

/// Rows of the mesh's textures, see client/render/face_textures.h.
inline constexpr std::string_view kFaceCommon = R"(
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
uniform sampler2D positions;  // grid units relative to the model's centre; a texel a vertex
uniform usampler2D corners;   // vertices of half-edges: three a face
uniform sampler2D firstLayer; // a texel a face: 1 where some pixel shows it
uniform int firstFace;        // of this draw call
uniform int useFirstLayer;    // 1: faces of the first layer are the front; 0: winding decides
uniform mat4 clipFromCenter;
uniform vec3 eye;
uniform vec3 forward;         // unit, from the eye into the picture
uniform int orthographic;
uniform vec2 depthRange;      // distance along `forward` where fading begins, and over how much
uniform vec2 pictureSize;     // pixels that widths count in
uniform vec2 width;           // of lines, pixels, at the reference distance; and its falloff
uniform float referenceDistance;
const vec4 kNowhere = vec4(2.0, 2.0, 2.0, 1.0);
ivec2 place(int i) {
  int row = textureSize(positions, 0).x;
  return ivec2(i % row, i / row);
}
uint vertexAt(int corner) { return texelFetch(corners, place(corner), 0).r; }
vec3 positionAt(uint v) { return texelFetch(positions, place(int(v)), 0).xyz; }
vec3 toEye(vec3 p) { return orthographic == 1 ? -forward : eye - p; }
float facing(vec3 a, vec3 b, vec3 c) { return dot(cross(b - a, c - a), toEye(a)); }
bool isFront(int face, float turned) {
  return useFirstLayer == 1 ? texelFetch(firstLayer, place(face), 0).r > 0.5 : turned > 0.0;
}
float distanceOf(vec3 p) { return dot(forward, p - eye); }
float fadeAt(vec3 p) { return clamp((distanceOf(p) - depthRange.x) / depthRange.y, 0.0, 1.0); }
// How much wider than at the reference distance a pixel is there.
float pixelGrowth(vec3 p) { return orthographic == 1 ? 1.0 : distanceOf(p) / referenceDistance; }
// Nearer to the eye by a share of the distance and by grid units, where it was in the picture.
vec3 pulled(vec3 p, float share, float units) {
  vec3 sight = normalize(toEye(p));
  float far = orthographic == 1 ? distanceOf(p) : distance(eye, p);
  return p + sight * (share * far + units);
}
float widthAt(vec3 p) {
  if (orthographic == 1 || width.y == 0.0) return width.x;
  return width.x * clamp(pow(referenceDistance / max(distanceOf(p), 1e-6), width.y), 0.25, 4.0);
}
vec2 pixelOf(vec4 clip) { return (0.5 * clip.xy / clip.w) * pictureSize; }
vec4 movedBy(vec4 clip, vec2 pixels) {
  return clip + vec4(2.0 * pixels / pictureSize * clip.w, 0.0, 0.0);
}
)";

/// Edges of back faces as quads: `width` pixels wide and half as much longer at each end. Four
/// vertices an edge, see FacePattern.
inline constexpr std::string_view kWireframeMain = R"(
out highp float fade;
uniform vec2 pull;
void main() {
  int face = firstFace + gl_VertexID / 12;
  int edge = (gl_VertexID % 12) / 4;
  int corner = gl_VertexID % 4;
  vec3 p[3];
  for (int k = 0; k < 3; ++k) p[k] = positionAt(vertexAt(3 * face + k));
  gl_Position = kNowhere;
  fade = 0.0;
  if (isFront(face, facing(p[0], p[1], p[2]))) return;
  vec3 from = pulled(p[edge], pull.x, pull.y);
  vec3 to = pulled(p[(edge + 1) % 3], pull.x, pull.y);
  vec4 a = clipFromCenter * vec4(from, 1.0);
  vec4 b = clipFromCenter * vec4(to, 1.0);
  float near = 1e-4 * max(a.w, b.w);
  if (max(a.w, b.w) <= 0.0) return;
  if (a.w < near) a = mix(a, b, (near - a.w) / (b.w - a.w));
  if (b.w < near) b = mix(b, a, (near - b.w) / (a.w - b.w));
  vec2 along = pixelOf(b) - pixelOf(a);
  float l = length(along);
  along = l > 1e-6 ? along / l : vec2(1.0, 0.0);
  bool isEnd = corner >= 2;
  vec3 here = isEnd ? to : from;
  float w = 0.5 * widthAt(here);
  fade = fadeAt(here);
  vec2 across = vec2(-along.y, along.x) * (corner % 2 == 0 ? 1.0 : -1.0);
  gl_Position = movedBy(isEnd ? b : a, w * (across + (isEnd ? along : -along)));
}
)";

/// Back faces, grown and moved: a fan of four triangles over six corners, two at each corner of the
/// face (see FacePattern).
/// Grown: each edge is pushed outwards in the picture by `grow` widths. What is added lies in the
/// face's plane, but comes nearer to the eye by no more than `steepest` pixels' worth a pixel, or
/// faces seen edge-on would reach through whatever is before them.
/// Moved towards the eye, where it stays in the picture: by `pull`, and by `bySlope` widths times
/// the slope of the face's depth, up to `mostBySlope` widths.
/// Front faces seen at less than `grazing` (the cosine) are drawn, too.
inline constexpr std::string_view kFattenMain = R"(
uniform float grow;
uniform float steepest;
uniform vec2 pull;         // share of the distance; grid units
uniform float bySlope;
uniform float mostBySlope;
uniform float pixelSize;   // at the reference distance, grid units
uniform float grazing;
void main() {
  int face = firstFace + gl_VertexID / 6;
  int outer = gl_VertexID % 6;
  uint v[3];
  vec3 p[3];
  for (int k = 0; k < 3; ++k) {
    v[k] = vertexAt(3 * face + k);
    p[k] = positionAt(v[k]);
  }
  gl_Position = kNowhere;
  finish(v[0], p[0]);
  vec3 n = cross(p[1] - p[0], p[2] - p[0]);
  float turned = dot(n, toEye(p[0]));
  if (isFront(face, turned) && abs(turned) >= grazing * length(n) * length(toEye(p[0]))) return;
  vec3 s[3];  // pixels and depth
  for (int k = 0; k < 3; ++k) {
    vec4 c = clipFromCenter * vec4(p[k], 1.0);
    if (c.w <= 0.0) return;
    s[k] = vec3(pixelOf(c), c.z / c.w);
  }
  // Depth over the picture is d0 + slope · (s - s0).
  vec2 e1 = s[1].xy - s[0].xy;
  vec2 e2 = s[2].xy - s[0].xy;
  float area = e1.x * e2.y - e1.y * e2.x;
  vec2 slope = vec2(0.0);
  if (abs(area) > 1e-9) {
    float d1 = s[1].z - s[0].z;
    float d2 = s[2].z - s[0].z;
    slope = vec2(d1 * e2.y - d2 * e1.y, d2 * e1.x - d1 * e2.x) / area;
  }
  int corner = outer / 2;
  // Two outer corners at each corner: pushed by the edge that ends here, and by the one that begins.
  int from = outer % 2 == 0 ? (corner + 2) % 3 : corner;
  vec2 along = s[(from + 1) % 3].xy - s[from].xy;
  float l = length(along);
  vec2 outward = l > 1e-6 ? sign(area) * vec2(along.y, -along.x) / l : vec2(0.0);
  vec3 here = p[corner];
  float w = widthAt(here);
  vec4 aPixelNearer = clipFromCenter * vec4(pulled(here, 0.0, pixelSize * pixelGrowth(here)), 1.0);
  float pixelsWorth = aPixelNearer.z / aPixelNearer.w - s[corner].z;  // of depth, negative
  float g = grow * w;
  float rise = max(dot(slope, outward) * g, steepest * g * pixelsWorth);
  rise += w * max(-bySlope * max(abs(slope.x), abs(slope.y)), mostBySlope * pixelsWorth);
  vec4 clip = clipFromCenter * vec4(pulled(here, pull.x, pull.y), 1.0);
  gl_Position = movedBy(clip, g * outward);
  gl_Position.z += rise * gl_Position.w;
  finish(v[corner], here);
}
)";

/// What kFattenMain tells the fragment shader, for lines; goes before it.
inline constexpr std::string_view kFattenLine = R"(
out highp float fade;
void finish(uint v, vec3 p) { fade = fadeAt(p); }
)";

/// And for charcoal: the paper's grey, (1 + V·N) / 3; goes before kFattenMain or kGreyMain.
inline constexpr std::string_view kFattenGrey = R"(
out highp float fade;
uniform sampler2D normals;  // a texel a vertex, unit
uniform vec2 tone;          // the grey's factor, and its upper bound
out highp float grey;
void finish(uint v, vec3 p) {
  fade = fadeAt(p);
  float turned = dot(texelFetch(normals, place(int(v)), 0).xyz, normalize(toEye(p)));
  grey = min(tone.x * (1.0 + turned) / 3.0, tone.y);
}
)";

/// The front in the same greys, where charcoal is drawn on.
inline constexpr std::string_view kGreyMain = R"(
void main() {
  uint v = vertexAt(gl_VertexID);
  vec3 p = positionAt(v);
  finish(v, p);
  gl_Position = clipFromCenter * vec4(p, 1.0);
}
)";

inline constexpr std::string_view kLineFragment = R"(#version 300 es
precision highp float;
in highp float fade;
uniform vec3 line;
uniform vec3 paper;
uniform float fading;  // share of the line's darkness that is gone at the far end
out vec4 color;
void main() { color = vec4(mix(line, paper, fading * fade), 1.0); }
)";

inline constexpr std::string_view kGreyFragment = R"(#version 300 es
precision highp float;
in highp float fade;
in highp float grey;
uniform vec3 line;
uniform vec3 paper;
uniform float fading;
out vec4 color;
void main() {
  color = vec4(mix(mix(line, paper, clamp(grey, 0.0, 1.0)), paper, fading * fade), 1.0);
}
)";

/// Numbers of faces, one a pixel, as four bytes; see kFaceIdFragment.
inline constexpr std::string_view kFaceNumberMain = R"(
flat out uint face;
void main() {
  face = uint(gl_VertexID) / 3u + 1u;
  gl_Position = clipFromCenter * vec4(positionAt(vertexAt(gl_VertexID)), 1.0);
}
)";

inline constexpr std::string_view kFaceNumberFragment = R"(#version 300 es
precision highp float;
precision highp int;
flat in uint face;
out vec4 color;
void main() {
  color = vec4(uvec4(face, face >> 8, face >> 16, face >> 24) & 255u) / 255.0;
}
)";

}  // namespace limn::shaders
