// SPDX-License-Identifier: Apache-2.0
// Based on: P. J. Schneider, "An Algorithm for Automatically Fitting Digitized Curves", Graphics
// Gems, 1990; D. H. Douglas, T. K. Peucker, "Algorithms for the Reduction of the Number of Points
// Required to Represent a Digitized Line or its Caricature", Cartographica 10(2), 1973.
// Deviations: lines are sampled densely before a curve is fitted, and a curve is also judged
// between samples, so that it cannot bulge where a line has few points.
#include "client/svg/curve_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

using Points = std::vector<glm::dvec2>;

/// Samples along a line are at most this far apart while a curve is fitted.
constexpr double kSamplePx = 1.0;

double distanceToSegment(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 ab = b - a;
  const double length2 = glm::dot(ab, ab);
  const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, ab) / length2, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + t * ab);
}

/// Douglas–Peucker: appends the ends of the lines kept, all but the first point.
void reduce(std::span<const glm::dvec2> points, double tolerance, Points& out) {
  double worst = 0.0;
  std::size_t at = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const double d = distanceToSegment(points[i], points.front(), points.back());
    if (d > worst) {
      worst = d;
      at = i;
    }
  }
  if (worst <= tolerance) {
    out.push_back(points.back());
    return;
  }
  reduce(points.first(at + 1), tolerance, out);
  reduce(points.subspan(at), tolerance, out);
}

using Cubic = std::array<glm::dvec2, 4>;

glm::dvec2 evaluate(const Cubic& c, double u) {
  const double v = 1.0 - u;
  return v * v * v * c[0] + 3.0 * v * v * u * c[1] + 3.0 * v * u * u * c[2] + u * u * u * c[3];
}

/// Fits curves to one smooth stretch.
class CurveFitter {
 public:
  CurveFitter(double tolerance, std::vector<PathStep>& out) : tolerance_(tolerance), out_(out) {}

  /// tangents: unit, into the stretch at both of its ends.
  void fit(std::span<const glm::dvec2> points, const glm::dvec2& first, const glm::dvec2& last) {
    if (points.size() == 2) {
      out_.push_back({{}, {}, points.back(), false});
      return;
    }
    std::vector<double> u(points.size(), 0.0);
    for (std::size_t i = 1; i < points.size(); ++i)
      u[i] = u[i - 1] + glm::distance(points[i - 1], points[i]);
    for (double& value : u)
      value /= u.back();
    std::size_t worst = points.size() / 2;
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds; ++round) {
      const Cubic curve = bestCurve(points, u, first, last);
      const double error = errorOf(curve, points, u, worst);
      if (error <= tolerance_) {
        out_.push_back({curve[1], curve[2], curve[3], true});
        return;
      }
      if (error > 8.0 * tolerance_) break;  // no hope: divide
      improve(curve, points, u);
    }
    const std::size_t at = std::clamp<std::size_t>(worst, 1, points.size() - 2);
    const glm::dvec2 across = tangentAt(points, at);
    fit(points.first(at + 1), first, -across);
    fit(points.subspan(at), across, last);
  }

  /// Direction of the line at an inner point, over a few samples.
  static glm::dvec2 tangentAt(std::span<const glm::dvec2> points, std::size_t i) {
    const std::size_t reach = std::min<std::size_t>({2, i, points.size() - 1 - i});
    const glm::dvec2 d = points[i + reach] - points[i - reach];
    const double length = glm::length(d);
    return length > 0.0 ? d / length : glm::dvec2(1.0, 0.0);
  }

 private:
  static Cubic bestCurve(
      std::span<const glm::dvec2> points,
      std::span<const double> u,
      const glm::dvec2& first,
      const glm::dvec2& last) {
    const glm::dvec2 a = points.front();
    const glm::dvec2 b = points.back();
    double c00 = 0.0;
    double c01 = 0.0;
    double c11 = 0.0;
    double x0 = 0.0;
    double x1 = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double v = 1.0 - u[i];
      const double b0 = v * v * v;
      const double b1 = 3.0 * u[i] * v * v;
      const double b2 = 3.0 * u[i] * u[i] * v;
      const double b3 = u[i] * u[i] * u[i];
      const glm::dvec2 a0 = b1 * first;
      const glm::dvec2 a1 = b2 * last;
      c00 += glm::dot(a0, a0);
      c01 += glm::dot(a0, a1);
      c11 += glm::dot(a1, a1);
      const glm::dvec2 rest = points[i] - ((b0 + b1) * a + (b2 + b3) * b);
      x0 += glm::dot(a0, rest);
      x1 += glm::dot(a1, rest);
    }
    const double det = c00 * c11 - c01 * c01;
    const double chord = glm::distance(a, b);
    double alpha0 = 0.0;
    double alpha1 = 0.0;
    if (std::abs(det) > 1e-12 * c00 * c11) {
      alpha0 = (x0 * c11 - x1 * c01) / det;
      alpha1 = (c00 * x1 - c01 * x0) / det;
    }
    // Handles that point backwards or far away make loops: Wu and Barsky's third instead.
    double length = 0.0;
    for (std::size_t i = 1; i < points.size(); ++i)
      length += glm::distance(points[i - 1], points[i]);
    const double least = 1e-3 * chord;
    if (!(alpha0 > least && alpha1 > least && alpha0 < length && alpha1 < length)) {
      alpha0 = length / 3.0;
      alpha1 = alpha0;
    }
    return {a, a + alpha0 * first, b + alpha1 * last, b};
  }

  static double errorOf(
      const Cubic& curve,
      std::span<const glm::dvec2> points,
      std::span<const double> u,
      std::size_t& worst) {
    double most = 0.0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const double atPoint = glm::distance(evaluate(curve, u[i]), points[i]);
      const double between =
          distanceToSegment(evaluate(curve, 0.5 * (u[i - 1] + u[i])), points[i - 1], points[i]);
      const double error = std::max(atPoint, between);
      if (error > most) {
        most = error;
        worst = i;
      }
    }
    return most;
  }

  /// One Newton step of every parameter towards the curve's nearest point.
  static void improve(const Cubic& c, std::span<const glm::dvec2> points, std::vector<double>& u) {
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      const double t = u[i];
      const double v = 1.0 - t;
      const glm::dvec2 d = evaluate(c, t) - points[i];
      const glm::dvec2 d1 =
          3.0 * (v * v * (c[1] - c[0]) + 2.0 * v * t * (c[2] - c[1]) + t * t * (c[3] - c[2]));
      const glm::dvec2 d2 = 6.0 * (v * (c[2] - 2.0 * c[1] + c[0]) + t * (c[3] - 2.0 * c[2] + c[1]));
      const double slope = glm::dot(d1, d1) + glm::dot(d, d2);
      if (std::abs(slope) > 1e-12) u[i] = std::clamp(t - glm::dot(d, d1) / slope, 0.0, 1.0);
    }
    std::sort(u.begin(), u.end());
  }

  double tolerance_;
  std::vector<PathStep>& out_;
};

/// The points and more between them.
Points densify(std::span<const glm::dvec2> points) {
  Points dense{points.front()};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double length = glm::distance(points[i - 1], points[i]);
    const int parts = std::max(1, static_cast<int>(std::ceil(length / kSamplePx)));
    for (int k = 1; k <= parts; ++k)
      dense.push_back(glm::mix(points[i - 1], points[i], static_cast<double>(k) / parts));
  }
  return dense;
}

/// Unit direction from an end into the line, over about `reach` pixels.
glm::dvec2 endDirection(std::span<const glm::dvec2> points, double reach) {
  for (const glm::dvec2& p : points) {
    if (glm::distance(p, points.front()) >= reach) return glm::normalize(p - points.front());
  }
  const glm::dvec2 d = points.back() - points.front();
  const double length = glm::length(d);
  return length > 0.0 ? d / length : glm::dvec2(1.0, 0.0);
}

class PathFitter {
 public:
  explicit PathFitter(const FitOptions& options) : options_(options) {}

  FittedPath fit(std::span<const glm::vec2> given, PathEnds ends) {
    Points points;
    for (const glm::vec2& p : given) {
      if (points.empty() || glm::distance(points.back(), glm::dvec2(p)) > 1e-6)
        points.emplace_back(p);
    }
    const bool closed = ends == PathEnds::kClosed && points.size() > 2;
    std::vector<std::size_t> corners = findCorners(points, closed);
    if (closed) {
      // A loop begins at a corner if it has one, and comes back to where it began.
      const std::size_t shift = corners.empty() ? 0 : corners.front();
      std::rotate(
          points.begin(),
          points.begin() + static_cast<std::ptrdiff_t>(shift),
          points.end());
      for (std::size_t& corner : corners)
        corner -= shift;
      points.push_back(points.front());
    }
    FittedPath path;
    path.start = points.front();
    const bool isSmoothLoop = closed && corners.empty();
    if (corners.empty() || corners.front() != 0) corners.insert(corners.begin(), 0);
    corners.push_back(points.size() - 1);
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      const std::span<const glm::dvec2> stretch =
          std::span<const glm::dvec2>(points).subspan(corners[i], corners[i + 1] - corners[i] + 1);
      if (stretch.size() > 1) fitStretch(stretch, isSmoothLoop, path.steps);
    }
    return path;
  }

 private:
  /// How much the line turns at point i, seen over the reach: cosine.
  [[nodiscard]] double cosTurn(const Points& points, std::size_t i, bool closed) const {
    const std::size_t count = points.size();
    const auto walk = [&](std::size_t step) {  // 1: on; count − 1: back
      std::size_t j = i;
      for (std::size_t k = 0; k < count; ++k) {
        if (!closed && ((step == 1 && j + 1 == count) || (step != 1 && j == 0))) break;
        j = (j + step) % count;
        if (glm::distance(points[j], points[i]) >= options_.cornerReachPx) break;
      }
      return points[j];
    };
    const glm::dvec2 in = points[i] - walk(count - 1);
    const glm::dvec2 out = walk(1) - points[i];
    const double lengths = glm::length(in) * glm::length(out);
    return lengths > 0.0 ? glm::dot(in, out) / lengths : 1.0;
  }

  [[nodiscard]] std::vector<std::size_t> findCorners(const Points& points, bool closed) const {
    const double limit = std::cos(options_.cornerAngleDegrees * std::numbers::pi / 180.0);
    std::vector<std::size_t> corners;
    double sharpest = 1.0;
    for (std::size_t i = closed ? 0 : 1; i + (closed ? 0 : 1) < points.size(); ++i) {
      const double turn = cosTurn(points, i, closed);
      if (turn > limit) continue;
      // Of corners close together only the sharpest is one.
      const bool isNear = !corners.empty() &&
                          glm::distance(points[corners.back()], points[i]) < options_.cornerReachPx;
      if (!isNear) {
        corners.push_back(i);
        sharpest = turn;
      } else if (turn < sharpest) {
        corners.back() = i;
        sharpest = turn;
      }
    }
    return corners;
  }

  void fitStretch(
      std::span<const glm::dvec2> points,
      bool isSmoothLoop,
      std::vector<PathStep>& steps) const {
    Points straight;
    if (isSmoothLoop) {  // its ends are one point: no chord to measure from
      const std::size_t half = points.size() / 2;
      reduce(points.first(half + 1), options_.tolerancePx, straight);
      reduce(points.subspan(half), options_.tolerancePx, straight);
    } else {
      reduce(points, options_.tolerancePx, straight);
    }
    std::vector<PathStep> curved;
    if (straight.size() > 3) {
      const Points dense = densify(points);
      const std::vector<glm::dvec2> reversed(dense.rbegin(), dense.rend());
      glm::dvec2 first = endDirection(dense, 1.5);
      glm::dvec2 last = endDirection(reversed, 1.5);
      if (isSmoothLoop) {
        const glm::dvec2 through = first - last;
        if (glm::length(through) > 1e-9) {
          first = glm::normalize(through);
          last = -first;
        }
      }
      CurveFitter(options_.tolerancePx, curved).fit(dense, first, last);
    }
    std::size_t numbers = 0;
    for (const PathStep& step : curved)
      numbers += step.isCurve ? 3 : 1;
    if (!curved.empty() && numbers < straight.size()) {
      steps.insert(steps.end(), curved.begin(), curved.end());
      return;
    }
    for (const glm::dvec2& p : straight)
      steps.push_back({{}, {}, p, false});
  }

  FitOptions options_;
};

}  // namespace

FittedPath fitPath(std::span<const glm::vec2> points, PathEnds ends, const FitOptions& options) {
  return PathFitter(options).fit(points, ends);
}

}  // namespace limn
