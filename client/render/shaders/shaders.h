// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Shader sources, `#version 300 es`. Framebuffers have their origin bottom left; everything that
/// comes from the CPU (pixels, samples) has it top left, and the shaders turn it over.
namespace limn::shaders {

/// position: grid units relative to the model's centre. paint: sRGB, where vertices have colours.
inline constexpr std::string_view kMeshVertex = R"(#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 paint;
uniform mat4 clipFromCenter;
out highp vec3 place;
out mediump vec3 paintHere;
void main() {
  place = position;
  paintHere = paint;
  gl_Position = clipFromCenter * vec4(position, 1.0);
}
)";

inline constexpr std::string_view kDepthFragment = R"(#version 300 es
precision highp float;
void main() {}
)";

/// Lambert by face normals.
inline constexpr std::string_view kShadedFragment = R"(#version 300 es
precision highp float;
in highp vec3 place;
in mediump vec3 paintHere;
uniform vec4 light;    // in the mesh's axes; w 0: direction towards it, unit; w 1: its place
uniform vec3 surface;   // colour of what is not painted
uniform float painted;  // 1: vertices have colours
out vec4 color;
void main() {
  vec3 n = normalize(cross(dFdx(place), dFdy(place)));
  vec3 towards = light.w > 0.0 ? normalize(light.xyz - place) : light.xyz;
  float lit = 0.30 + 0.70 * max(dot(n, towards), 0.0);
  color = vec4(mix(surface, paintHere, painted) * lit, 1.0);
}
)";

/// One triangle that covers the framebuffer; no attributes.
inline constexpr std::string_view kScreenVertex = R"(#version 300 es
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

/// The 8-neighbourhood test, one fragment a spine sample: see testSamples in
/// client/stroke/visibility/visibility.cpp, which does the same operations.
inline constexpr std::string_view kVisibilityFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D samples;  // three texels a sample, see SpineSample
uniform highp sampler2D depthMap;
uniform float farther;
out float visible;
int freeAround(vec2 place, vec2 outward, float limit) {
  ivec2 size = textureSize(depthMap, 0);
  ivec2 centre = ivec2(floor(place));
  int free = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dot(vec2(float(dx), float(dy)), outward) < -0.1) continue;
      ivec2 texel = clamp(centre + ivec2(dx, dy), ivec2(0), size - 1);
      if (texelFetch(depthMap, ivec2(texel.x, size.y - 1 - texel.y), 0).r >= limit) ++free;
    }
  }
  return free;
}
void main() {
  ivec2 cell = ivec2(gl_FragCoord.xy);
  vec4 line = texelFetch(samples, ivec2(3 * cell.x, cell.y), 0);
  visible = 0.0;
  if (line.w < 0.0) return;
  vec2 outward = texelFetch(samples, ivec2(3 * cell.x + 1, cell.y), 0).xy;
  float neededFree = texelFetch(samples, ivec2(3 * cell.x + 2, cell.y), 0).z;
  int needed = int(abs(neededFree));
  vec2 size = vec2(textureSize(depthMap, 0));
  vec2 place = line.xy * size;
  float limit = line.z - line.w;
  bool isFree = freeAround(place, outward, limit) >= needed;
  if (!isFree && neededFree < 0.0)
    isFree = freeAround(place + farther * size.y * outward, outward, limit) >= needed;
  visible = isFree ? 1.0 : 0.0;
}
)";

/// The majority in a sample's span: see voteInSpans.
inline constexpr std::string_view kVoteFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D samples;
uniform highp sampler2D tested;
uniform int radius;
out float visible;
void main() {
  ivec2 cell = ivec2(gl_FragCoord.xy);
  int width = textureSize(tested, 0).x;
  int index = cell.y * width + cell.x;
  visible = 0.0;
  if (texelFetch(samples, ivec2(3 * cell.x, cell.y), 0).w < 0.0) return;
  vec2 spine = texelFetch(samples, ivec2(3 * cell.x + 1, cell.y), 0).zw;
  vec2 span = texelFetch(samples, ivec2(3 * cell.x + 2, cell.y), 0).xy;
  int first = int(span.x);
  int last = int(span.y);
  bool isRing = spine.y < 0.0 && span.x == spine.x && span.y == -spine.y;
  int count = max(last - first + 1, 1);
  float sum = 0.0;
  float weight = 0.0;
  for (int step = -radius; step <= radius; ++step) {
    int j = index + step;
    if (isRing) {
      j = first + (j - first + radius * count) % count;  // % is for what is not negative only
    } else if (j < first || j > last) {
      continue;
    }
    sum += texelFetch(tested, ivec2(j % width, j / width), 0).r;
    weight += 1.0;
  }
  visible = 2.0 * sum >= weight ? 1.0 : 0.0;
}
)";

/// What is drawn of what is visible, nested contours and bridges: see drawnSamples.
inline constexpr std::string_view kDrawnFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D samples;
uniform highp sampler2D voted;
out float drawn;
int width;
float visibleAt(int i) { return texelFetch(voted, ivec2(i % width, i / width), 0).r; }
vec4 askingAt(int i) { return texelFetch(samples, ivec2(3 * (i % width) + 2, i / width), 0); }
float drawnAt(int i) {
  int outer = int(askingAt(i).w);
  return outer >= 0 && visibleAt(outer) > 0.5 ? 0.0 : visibleAt(i);
}
void main() {
  width = textureSize(voted, 0).x;
  int index = int(gl_FragCoord.y) * width + int(gl_FragCoord.x);
  vec4 asking = askingAt(index);
  bool isBridge = asking.z == 0.0;  // kAsJoined
  drawn = isBridge ? min(drawnAt(int(asking.x)), drawnAt(int(asking.y))) : drawnAt(index);
}
)";

/// Short runs left out, and the distance to a change: see sampleVisibility.
inline constexpr std::string_view kShapeFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D samples;
uniform highp sampler2D drawn;
uniform int ramp;   // samples
uniform int closedGap;
uniform int shortRun;
out float visible;
uint closeGaps(uint bits, int longest) {
  uint grown = bits;
  for (int i = 0; i < longest; ++i) grown |= grown << 1;
  uint closed = grown;
  for (int i = 0; i < longest; ++i) closed &= closed >> 1;
  return closed | bits;
}
void main() {
  ivec2 cell = ivec2(gl_FragCoord.xy);
  int width = textureSize(drawn, 0).x;
  int index = cell.y * width + cell.x;
  vec2 range = texelFetch(samples, ivec2(3 * cell.x + 1, cell.y), 0).zw;
  int first = int(range.x);
  int last = int(abs(range.y));
  int count = max(last - first + 1, 1);
  int middle = ramp + closedGap + shortRun;
  uint bits = 0u;
  for (int k = 0; k <= 2 * middle; ++k) {
    int j = index + k - middle;
    j = range.y < 0.0 ? first + (j - first + middle * count) % count : clamp(j, first, last);
    if (texelFetch(drawn, ivec2(j % width, j / width), 0).r > 0.5) bits |= 1u << k;
  }
  bits = ~closeGaps(~closeGaps(bits, closedGap), shortRun);
  uint here = (bits >> middle) & 1u;
  float reach = float(ramp) + 0.5;
  float distance = reach;
  for (int d = ramp; d >= 1; --d) {
    if (((bits >> (middle + d)) & 1u) != here || ((bits >> (middle - d)) & 1u) != here)
      distance = float(d) - 0.5;
  }
  float away = 0.5 * distance / reach;
  visible = here != 0u ? 0.5 + away : 0.5 - away;
}
)";

/// Counts the lines in cells of the picture, a point a spine sample: see LineDensity in
/// client/stroke/line_density.h. Drawn with additive blending.
inline constexpr std::string_view kDensityVertex = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D samples;
uniform highp sampler2D visibility;
uniform vec2 cellsInPicture;  // the picture's size in cells, and the map's
uniform vec2 cellsInMap;
uniform int hiddenMode;       // of the strokes
flat out vec2 count;
void main() {
  int width = textureSize(visibility, 0).x;
  ivec2 at = ivec2(gl_VertexID % width, gl_VertexID / width);
  vec2 place = texelFetch(samples, ivec2(3 * at.x, at.y), 0).xy;
  bool isVisible = hiddenMode == 2 || texelFetch(visibility, at, 0).r > 0.5;
  count = isVisible ? vec2(1.0 / 255.0, 0.0) : vec2(0.0, 1.0 / 255.0);
  // Rows of the map run down, as the picture's do.
  bool isInside = all(greaterThanEqual(place, vec2(0.0))) && all(lessThan(place, vec2(1.0)));
  vec2 cell = (floor(place * cellsInPicture) + 0.5) / cellsInMap;
  gl_Position = isInside ? vec4(2.0 * cell - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 0.0, 1.0);
  gl_PointSize = 1.0;
}
)";

inline constexpr std::string_view kDensityFragment = R"(#version 300 es
precision highp float;
flat in vec2 count;
out vec2 density;
void main() { density = count; }
)";

/// Strips on their way to the picture; what crowds or fades is thinner or paler: see
/// line_density.cpp, which does the same operations.
inline constexpr std::string_view kStrokeVertex = R"(#version 300 es
precision highp float;
precision highp int;
layout(location = 0) in vec2 position;   // pixels from the top left
layout(location = 1) in vec2 place;      // across, sample
layout(location = 2) in vec2 repeats;    // of the visible and the hidden texture
layout(location = 3) in vec2 fades;      // of the visible and the hidden parts
layout(location = 4) in float margin;    // half the strip's width, pixels
uniform vec2 pictureSize;
uniform highp sampler2D densityMap;
uniform float cellPx;        // of the density map
uniform float perCount;      // pixels of line a square pixel for each sample in a cell
uniform float inkShare;      // of the strip's width
uniform float inkPx;         // the width of an ordinary stroke
uniform vec3 crowding;       // kLargestShare, kLeastWidth, kLeastOpacity (line_density.h)
uniform vec2 paling;         // kPaleFrom, kPalest
out highp vec2 spine;
out highp vec2 along;
out mediump vec2 opacity;
out highp float halfWidth;
out highp float widthShare;  // of its own width that the stroke has here
vec2 densityAt(vec2 pixel) {
  ivec2 last = textureSize(densityMap, 0) - 1;
  vec2 at = pixel / cellPx - 0.5;
  ivec2 low = ivec2(floor(at));
  vec2 f = at - floor(at);
  vec2 sum = vec2(0.0);
  for (int y = -1; y <= 2; ++y) {
    for (int x = -1; x <= 2; ++x) {
      vec2 w = max(vec2(0.0), 1.0 - abs(vec2(float(x), float(y)) - f) / 2.0) / 2.0;
      sum += w.x * w.y * texelFetch(densityMap, clamp(low + ivec2(x, y), ivec2(0), last), 0).rg;
    }
  }
  return sum * 255.0 * perCount;
}
void main() {
  vec2 density = densityAt(position);
  float others = max(density.r - 0.5 / cellPx, 1e-6);
  float share = crowding.x / (others * max(2.0 * margin * inkShare, 1e-3));
  float full = clamp(share, crowding.y, 1.0) * fades.x;
  widthShare = max(full, crowding.y);
  float few = paling.x / max(density.g * inkPx, 1e-6);
  float pale = clamp(few * sqrt(few), paling.y, 1.0);
  spine = place;
  along = repeats;
  float faded = min(full / crowding.y, 1.0);
  opacity = vec2(clamp(share / crowding.y, crowding.z, 1.0) * faded, fades.y * pale);
  halfWidth = margin * widthShare;
  vec2 ndc = 2.0 * position / pictureSize - 1.0;
  gl_Position = vec4(ndc.x, -ndc.y, 0.0, 1.0);
}
)";

/// Ink, visible in red and hidden in green. Drawn with "maximum" blending: where a stroke crosses
/// itself or another, ink is not laid on twice.
inline constexpr std::string_view kStrokeFragment = R"(#version 300 es
precision highp float;
precision highp int;
in highp vec2 spine;
in highp vec2 along;
in mediump vec2 opacity;
in highp float halfWidth;
in highp float widthShare;
uniform highp sampler2D visibility;  // green: clear of visible lines, if there are hidden ones
uniform sampler2D visibleStroke;
uniform sampler2D hiddenStroke;
uniform int hiddenMode;          // 0 its style, 1 not drawn, 2 as visible
uniform float body;              // share of the strip that is ink
uniform float rampPx;            // distance along the line over which visibility goes from 0 to 1
out vec2 ink;
vec2 visibilityAt(int index) {
  int width = textureSize(visibility, 0).x;
  return texelFetch(visibility, ivec2(index % width, index / width), 0).rg;
}
void main() {
  float base = floor(spine.y);
  vec2 here = mix(visibilityAt(int(base)), visibilityAt(int(base) + 1), spine.y - base);
  float seen = here.r;
  // Distance past the place where the line goes hidden, and a round end for the visible part there.
  // It reaches past the change, as far as what hides it covers that by its own line, so that two
  // that end at one place meet.
  float radius = min(halfWidth * body, 0.45 * rampPx);
  float past = (seen - 0.5) * rampPx + 0.7 * radius;
  float across = spine.x / widthShare;
  float t = min(abs(across) / body, 1.0);
  float end = radius * (1.0 - sqrt(1.0 - t * t));
  float share = hiddenMode == 2 ? 1.0 : smoothstep(-0.5, 0.5, past - end);
  if (seen >= 0.97) share = 1.0;
  float dark = abs(across) < 1.0 ? texture(visibleStroke, vec2(along.x, 0.5 + 0.5 * across)).r : 0.0;
  float faint = hiddenMode == 0 ? texture(hiddenStroke, vec2(along.y, 0.5 + 0.5 * spine.x)).r : 0.0;
  faint *= smoothstep(0.25, 0.75, here.g);
  ink = vec2(dark * share * opacity.x, faint * (1.0 - share) * opacity.y);
}
)";

/// Ink on paper, and the reduction from the supersampled framebuffer.
inline constexpr std::string_view kPaperFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D inkMap;
uniform int supersample;
uniform vec3 paper;
uniform vec3 visibleColor;
uniform vec3 hiddenColor;
uniform vec2 opacities;
uniform float grain;
uniform int pictureHeight;
out vec4 color;
uint scramble(uint h) {
  h ^= h >> 16; h *= 0x7feb352du; h ^= h >> 15; h *= 0x846ca68bu; h ^= h >> 16;
  return h;
}
float lattice(ivec2 p) {
  return float(scramble(uint(p.x) * 0x9e3779b9u + scramble(uint(p.y))) >> 8) / 16777216.0;
}
// Value noise, the paper's tooth.
float tooth(vec2 p) {
  ivec2 cell = ivec2(floor(p));
  vec2 f = p - floor(p);
  f = f * f * (3.0 - 2.0 * f);
  return mix(
      mix(lattice(cell), lattice(cell + ivec2(1, 0)), f.x),
      mix(lattice(cell + ivec2(0, 1)), lattice(cell + ivec2(1, 1)), f.x), f.y);
}
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec2 ink = vec2(0.0);
  for (int y = 0; y < supersample; ++y) {
    for (int x = 0; x < supersample; ++x) {
      ink += texelFetch(inkMap, pixel * supersample + ivec2(x, y), 0).rg;
    }
  }
  ink /= float(supersample * supersample);
  if (grain > 0.0 && max(ink.r, ink.g) > 0.0) {
    vec2 p = vec2(float(pixel.x), float(pictureHeight - 1 - pixel.y));
    float n = 0.65 * tooth(p / 1.3) + 0.35 * tooth(p / 2.9 + 17.0);
    // Ink reaches the hollows of the paper only where it is laid on thickly.
    ink *= mix(vec2(1.0), smoothstep(vec2(-0.35), vec2(0.30), ink - n * 0.9 + 0.25), grain);
  }
  vec3 result = mix(paper, hiddenColor, ink.g * opacities.y);
  result = mix(result, visibleColor, ink.r * opacities.x);
  color = vec4(result, 1.0);
}
)";

inline constexpr std::string_view kReduceFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D picture;
uniform int supersample;
out vec4 color;
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 sum = vec4(0.0);
  for (int y = 0; y < supersample; ++y) {
    for (int x = 0; x < supersample; ++x) {
      sum += texelFetch(picture, pixel * supersample + ivec2(x, y), 0);
    }
  }
  color = sum / float(supersample * supersample);
}
)";

/// Depth as its bits, to be read back: GLES reads no depth textures.
inline constexpr std::string_view kDepthBitsFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D depthMap;
out uvec4 bits;
void main() {
  bits = uvec4(floatBitsToUint(texelFetch(depthMap, ivec2(gl_FragCoord.xy), 0).r), 0u, 0u, 0u);
}
)";

}  // namespace limn::shaders
