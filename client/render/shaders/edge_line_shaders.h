// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Silhouette edges found by shaders [OGLdev39], as quads with round ends. Each quad's vertices
/// know where the edge lies in the picture, so that a fragment can ask the depth image there: the
/// whole width of a line shares the visibility of its middle. Sources are put together with
/// kFaceCommon of back_face_shaders.h.
namespace limn::shaders {

/// Uniforms and functions of both ways.
inline constexpr std::string_view kEdgeCommon = R"(
uniform vec4 light;      // w 1: a place that looks at the mesh instead of the eye; w 0: none
uniform float pixelSize; // at the reference distance, grid units
vec3 toViewer(vec3 p) { return light.w > 0.0 ? light.xyz - p : toEye(p); }
bool facesViewer(vec3 a, vec3 b, vec3 c) {
  return dot(cross(b - a, c - a), toViewer(a)) > 0.0;
}
// Of the edge a b of face a b c, whose neighbour is b a o; o = c: there is none.
bool isLine(vec3 a, vec3 b, vec3 c, vec3 o) {
  if (o == c) return true;
  if (facesViewer(a, b, c) == facesViewer(b, a, o)) return false;
  // What the eye sees of a concave edge, its own faces hide. A light's lines have no such rule.
  return light.w > 0.0 || dot(cross(b - a, c - a), o - a) <= 0.0;
}
)";

/// Puts a quad's corner: 0 and 1 at the edge's start, 2 and 3 at its end. c: the third corner of
/// the face whose side of the edge is not asked for its depth.
inline constexpr std::string_view kEdgeCorner = R"(
flat out highp vec3 start;   // of the line in the picture: pixels from its middle, depth
flat out highp vec3 end;
flat out highp vec4 facts;   // outward direction (or 0 0), half the width, bias of depth
out highp vec2 at;           // pixels along and across
out highp float fade;
bool putCorner(vec3 pa, vec3 pb, vec3 pc, int corner) {
  vec4 a = clipFromCenter * vec4(pa, 1.0);
  vec4 b = clipFromCenter * vec4(pb, 1.0);
  vec4 c = clipFromCenter * vec4(pc, 1.0);
  gl_Position = kNowhere;
  if (max(a.w, b.w) <= 0.0) return false;
  float near = 1e-4 * max(a.w, b.w);
  if (a.w < near) a = mix(a, b, (near - a.w) / (b.w - a.w));
  if (b.w < near) b = mix(b, a, (near - b.w) / (a.w - b.w));
  start = vec3(pixelOf(a), a.z / a.w);
  end = vec3(pixelOf(b), b.z / b.w);
  vec2 along = end.xy - start.xy;
  float l = length(along);
  along = l > 1e-6 ? along / l : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  vec2 outward = vec2(0.0);
  if (light.w == 0.0 && c.w > 0.0) {
    outward = dot(across, pixelOf(c) - start.xy) > 0.0 ? -across : across;
  }
  vec3 here = corner < 2 ? pa : pb;
  float w = 0.5 * widthAt(0.5 * (pa + pb));
  vec4 nearer = clipFromCenter * vec4(pulled(pa, 0.0, 2.0 * pixelSize * pixelGrowth(pa)), 1.0);
  facts = vec4(outward, w, a.z / a.w - nearer.z / nearer.w);
  at = vec2(corner < 2 ? -w : l + w, corner % 2 == 0 ? -w : w);
  fade = fadeAt(here);
  vec2 pixel = start.xy + along * at.x + across * at.y;
  // Not in perspective: `at` and depth are linear in the picture.
  gl_Position = vec4(2.0 * pixel / pictureSize, mix(start.z, end.z, corner < 2 ? 0.0 : 1.0), 1.0);
  return true;
}
)";

/// The geometry shader's way: triangles with adjacency in, up to three quads out.
inline constexpr std::string_view kAdjacencyVertexMain = R"(
out highp vec3 vertex;
void main() {
  vertex = positionAt(uint(gl_VertexID));
  gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
)";

inline constexpr std::string_view kEdgeGeometryLayout = R"(
layout(triangles_adjacency) in;
layout(triangle_strip, max_vertices = 12) out;
in highp vec3 vertex[];
)";

inline constexpr std::string_view kEdgeGeometryMain = R"(
void main() {
  bool front = facesViewer(vertex[0], vertex[2], vertex[4]);
  for (int k = 0; k < 3; ++k) {
    vec3 a = vertex[2 * k];
    vec3 b = vertex[(2 * k + 2) % 6];
    vec3 c = vertex[(2 * k + 4) % 6];
    vec3 o = vertex[2 * k + 1];
    // Of the two faces of an edge the one in front draws it; a border has one.
    if (!(front || o == c) || !isLine(a, b, c, o)) continue;
    for (int corner = 0; corner < 4; ++corner) {
      putCorner(a, b, c, corner);
      EmitVertex();
    }
    EndPrimitive();
  }
}
)";

/// The vertex shader's way, conditional lines: four vertices an edge (FacePattern::kQuad), that
/// stay nowhere unless the edge is a line.
inline constexpr std::string_view kConditionalLineMain = R"(
void main() {
  int edge = firstFace + gl_VertexID / 4;
  vec3 p[4];
  for (int k = 0; k < 4; ++k) p[k] = positionAt(vertexAt(4 * edge + k));
  gl_Position = kNowhere;
  start = end = vec3(0.0);
  facts = vec4(0.0);
  at = vec2(0.0);
  fade = 0.0;
  if (!isLine(p[0], p[1], p[2], p[3])) return;
  vec3 inner = facesViewer(p[0], p[1], p[2]) ? p[2] : p[3];
  putCorner(p[0], p[1], inner, gl_VertexID % 4);
}
)";

inline constexpr std::string_view kEdgeFragment = R"(
precision highp float;
precision highp int;
precision highp sampler2D;
flat in highp vec3 start;
flat in highp vec3 end;
flat in highp vec4 facts;
in highp vec2 at;
in highp float fade;
uniform sampler2D depthMap;
uniform vec2 pictureSize;
uniform vec3 line;
uniform vec3 paper;
uniform float fading;
uniform int freeNeighbours;
out vec4 color;
void main() {
  float l = distance(start.xy, end.xy);
  float past = max(max(-at.x, at.x - l), 0.0);
  if (past * past + at.y * at.y > facts.z * facts.z) discard;
  vec3 spine = mix(start, end, clamp(at.x / max(l, 1e-6), 0.0, 1.0));
  ivec2 size = textureSize(depthMap, 0);
  ivec2 centre = ivec2(floor((spine.xy / pictureSize + 0.5) * vec2(size)));
  float limit = 0.5 * (spine.z - facts.w) + 0.5;
  int free = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dot(vec2(float(dx), float(dy)), facts.xy) < -0.1) continue;
      ivec2 texel = clamp(centre + ivec2(dx, dy), ivec2(0), size - 1);
      if (texelFetch(depthMap, texel, 0).r >= limit) ++free;
    }
  }
  if (free < freeNeighbours) discard;
  color = vec4(mix(line, paper, fading * fade), 1.0);
}
)";

}  // namespace limn::shaders
