// SPDX-License-Identifier: Apache-2.0
//
// Based on: P. Sander, X. Gu, S. Gortler, H. Hoppe, J. Snyder, "Silhouette clipping", SIGGRAPH
// 2000, section 6. Their fans about a centroid, decomposed where loops are large, become the end
// of that decomposition: a loop is halved by a chord again and again, down to single edges, and
// each chord pair leaves one triangle. No centroid, two triangles a loop fewer, and nearly all of
// them are small.
#include "client/render/clip_contours.h"

#include <utility>

namespace limn {
namespace {

/// The least margin, as a cosine, by which the eye must be outside.
constexpr double kMargin = 1e-4;
constexpr int kMostSteps = 200;

/// Triangles between points begin … end, in order, and the chord from end back to begin.
void span(std::uint32_t begin, std::uint32_t end, std::vector<std::uint32_t>& triangles) {
  if (end - begin < 2) return;
  const std::uint32_t middle = begin + (end - begin) / 2;
  triangles.insert(triangles.end(), {begin, middle, end});
  span(begin, middle, triangles);
  span(middle, end, triangles);
}

/// Takes the loops one after another to the screen.
class Builder {
 public:
  Builder(const ClipScreen& screen, std::size_t points, std::size_t lines)
      : clipFromGrid_(screen.clipFromGrid),
        half_(0.5 * glm::dvec2(screen.viewport.width, screen.viewport.height)),
        steps_(1 << screen.subpixelBits) {
    contours_.points.reserve(points + lines);
    contours_.triangles.reserve(3 * points);
  }

  template <class PointOf>
  void append(std::uint32_t count, PointOf pointOf) {
    if (count < 3) return;
    const auto begin = static_cast<std::uint32_t>(contours_.points.size());
    for (std::uint32_t i = 0; i < count; ++i)
      contours_.points.emplace_back(project(pointOf(i)), 1.0F);
    contours_.points.emplace_back(glm::vec2(contours_.points[begin]), 0.0F);
    span(begin, begin + count - 1, contours_.triangles);
  }

  [[nodiscard]] std::optional<ClipContours> finish() && {
    return isInFront_ ? std::optional(std::move(contours_)) : std::nullopt;
  }

 private:
  glm::vec2 project(const glm::dvec3& point) {
    const glm::dvec4 clip = clipFromGrid_ * glm::dvec4(point, 1.0);
    if (!(clip.w > 0.0)) {
      isInFront_ = false;
      return glm::vec2(0.0F);
    }
    const glm::dvec2 px = half_ * (1.0 + glm::dvec2(clip) / clip.w);
    return glm::vec2((2.0 * glm::floor(0.5 * steps_ * px) + 1.0) / steps_);
  }

  glm::dmat4 clipFromGrid_;
  glm::dvec2 half_;
  double steps_;
  bool isInFront_ = true;
  ClipContours contours_;
};

}  // namespace

std::optional<ClipContours> clipContoursOf(const PolylineSet& lines, const ClipScreen& screen) {
  Builder builder(screen, lines.points.size(), lines.lines.size());
  for (const PolylineSet::Line& line : lines.lines) {
    if (line.kind != LineKind::kSilhouette) continue;
    builder.append(line.end - line.begin, [&](std::uint32_t i) {
      return glm::dvec3(lines.points[line.begin + i]);
    });
  }
  return std::move(builder).finish();
}

std::optional<ClipContours> clipContoursOf(const ContourLines& lines, const ClipScreen& screen) {
  const double step = 1.0 / (1 << lines.extraBits);
  Builder builder(screen, lines.points.size(), lines.lines.size());
  for (const ContourLines::Line& line : lines.lines) {
    builder.append(line.end - line.begin, [&](std::uint32_t i) {
      return step * glm::dvec3(lines.points[line.begin + i]);
    });
  }
  return std::move(builder).finish();
}

// The perceptron: a direction that all points lie ahead of, corrected by the one farthest behind.
bool isOutsideConvexHull(const glm::dvec3& eye, std::span<const glm::dvec3> points) {
  glm::dvec3 direction{0.0};
  for (const glm::dvec3& p : points)
    direction += p - eye;
  for (int step = 0; step < kMostSteps; ++step) {
    const double length = glm::length(direction);
    if (!(length > 0.0)) return false;
    direction /= length;
    double least = 2.0;
    glm::dvec3 worst{0.0};
    for (const glm::dvec3& p : points) {
      const double distance = glm::distance(p, eye);
      if (!(distance > 0.0)) return false;
      const double cosine = glm::dot(direction, p - eye) / distance;
      if (cosine >= least) continue;
      least = cosine;
      worst = (p - eye) / distance;
    }
    if (least > kMargin) return true;
    // Just enough to have that point on the margin's far side.
    direction += (2.0 * kMargin - least) * worst;
  }
  return false;
}

}  // namespace limn
