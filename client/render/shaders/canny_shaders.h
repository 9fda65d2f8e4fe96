// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Canny's edge detector as passes over textures, `#version 300 es`. Integer arithmetic on bytes,
/// the same as OpenCV's cv::Canny (aperture 3, L1 norm), so that the two can be compared pixel by
/// pixel. Every pass is drawn with shaders::kScreenVertex.
namespace limn::shaders {

/// Corners without an index buffer, so that each knows its face: GLES 3.0 has no primitive id.
inline constexpr std::string_view kSeedVertex = R"(#version 300 es
precision highp float;
layout(location = 0) in vec3 position;  // grid units relative to the model's centre
layout(location = 1) in vec3 normal;
uniform mat4 clipFromCenter;
flat out uint face;
out vec3 direction;
void main() {
  face = uint(gl_VertexID) / 3u + 1u;
  direction = normal;
  gl_Position = clipFromCenter * vec4(position, 1.0);
}
)";

/// The face's number plus one, as four bytes.
inline constexpr std::string_view kFaceIdFragment = R"(#version 300 es
precision highp float;
precision highp int;
flat in uint face;
in vec3 direction;
out vec4 color;
void main() {
  color = vec4(uvec4(face, face >> 8, face >> 16, face >> 24) & 255u) / 255.0;
}
)";

/// Normals in the viewer's axes as colours.
inline constexpr std::string_view kNormalFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform mat4 viewFromWorld;
flat in uint face;
in vec3 direction;
out vec4 color;
void main() {
  vec3 n = mat3(viewFromWorld) * normalize(direction);
  color = vec4(0.5 + 0.5 * n, 1.0);
}
)";

/// Sobel's derivatives of the channel that changes most, plus 1024, as two bytes each.
inline constexpr std::string_view kGradientFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D image;
out vec4 color;
ivec3 at(ivec2 p) {
  ivec2 last = textureSize(image, 0) - 1;
  return ivec3(texelFetch(image, clamp(p, ivec2(0), last), 0).rgb * 255.0 + 0.5);
}
void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  ivec3 a = at(p + ivec2(-1, -1)), b = at(p + ivec2(0, -1)), c = at(p + ivec2(1, -1));
  ivec3 d = at(p + ivec2(-1, 0)), f = at(p + ivec2(1, 0));
  ivec3 g = at(p + ivec2(-1, 1)), h = at(p + ivec2(0, 1)), i = at(p + ivec2(1, 1));
  ivec3 dx = (c + 2 * f + i) - (a + 2 * d + g);
  ivec3 dy = (g + 2 * h + i) - (a + 2 * b + c);
  ivec3 norm = abs(dx) + abs(dy);
  ivec2 best = ivec2(dx.r, dy.r);
  int most = norm.r;
  if (norm.g > most) { most = norm.g; best = ivec2(dx.g, dy.g); }
  if (norm.b > most) { best = ivec2(dx.b, dy.b); }
  best += 1024;
  color = vec4(best.x & 255, best.x >> 8, best.y & 255, best.y >> 8) / 255.0;
}
)";

/// Ridges of the gradient's norm: 1 above the high threshold, ½ above the low one, 0 elsewhere.
inline constexpr std::string_view kRidgeFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D gradient;
uniform int low;
uniform int high;
out float edge;
ivec2 at(ivec2 p) {
  ivec4 bytes = ivec4(texelFetch(gradient, p, 0) * 255.0 + 0.5);
  return ivec2(bytes.x + 256 * bytes.y, bytes.z + 256 * bytes.w) - 1024;
}
int norm(ivec2 p) {
  if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, textureSize(gradient, 0)))) return 0;
  ivec2 g = abs(at(p));
  return g.x + g.y;
}
void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  ivec2 g = at(p);
  ivec2 size = abs(g);
  int m = size.x + size.y;
  edge = 0.0;
  if (m <= low) return;
  // Sectors of 45 degrees: tan 22.5 and tan 67.5 in fixed point, as OpenCV has them.
  int tan22 = size.x * 13573;
  int y = size.y << 15;
  bool isRidge;
  if (y < tan22) {
    isRidge = m > norm(p + ivec2(-1, 0)) && m >= norm(p + ivec2(1, 0));
  } else if (y > tan22 + (size.x << 16)) {
    isRidge = m > norm(p + ivec2(0, -1)) && m >= norm(p + ivec2(0, 1));
  } else {
    int s = (g.x ^ g.y) < 0 ? -1 : 1;
    isRidge = m > norm(p + ivec2(-s, -1)) && m > norm(p + ivec2(s, 1));
  }
  if (isRidge) edge = m > high ? 1.0 : 0.5;
}
)";

/// One step of hysteresis: weak edges beside strong ones become strong.
inline constexpr std::string_view kHysteresisFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D edges;
out float edge;
void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(edges, 0) - 1;
  edge = texelFetch(edges, p, 0).r;
  if (edge < 0.25 || edge > 0.75) return;
  for (int y = -1; y <= 1; ++y) {
    for (int x = -1; x <= 1; ++x) {
      ivec2 q = clamp(p + ivec2(x, y), ivec2(0), last);
      if (texelFetch(edges, q, 0).r > 0.75) edge = 1.0;
    }
  }
}
)";

/// Face numbers under strong edges, or beside them where an edge lies on the background.
inline constexpr std::string_view kFacesUnderEdgesFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D edges;
uniform highp sampler2D faces;
out vec4 color;
void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(edges, 0) - 1;
  color = vec4(0.0);
  if (texelFetch(edges, p, 0).r < 0.75) return;
  color = texelFetch(faces, p, 0);
  for (int k = 0; k < 9 && color == vec4(0.0); ++k) {
    ivec2 q = clamp(p + ivec2(k % 3 - 1, k / 3 - 1), ivec2(0), last);
    color = texelFetch(faces, q, 0);
  }
}
)";

}  // namespace limn::shaders
