// SPDX-License-Identifier: Apache-2.0
//
// Based on: P. Felzenszwalb, D. Huttenlocher, "Distance transforms of sampled functions", Theory of
// Computing 2012 (the nearest contour pixel of every pixel). Ours: each contour pixel keeps where
// in it the contour ran, so that errors far below a pixel are told apart.
#include "tests/bench/contour_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace limn::bench {
namespace {

constexpr double kDistance = 3.0;    // of the eye from the centre, radii
constexpr double kHalfAngle = 20.0;  // of the picture, degrees
constexpr float kBias = 2e-3F;       // of depth: contours lie on surfaces seen edge-on
constexpr float kNowhere = -1e9F;

struct Camera {
  glm::dvec3 eye{0.0};
  glm::dmat3 axes{1.0};  // rows right, up, back
  double scale = 1.0;    // pixels a unit of slope
  double middle = 0.0;

  // x, y in pixels, z: 1 / depth.
  [[nodiscard]] glm::vec3 project(const glm::dvec3& p) const {
    const glm::dvec3 v = axes * (p - eye);
    return {middle + scale * v.x / -v.z, middle - scale * v.y / -v.z, 1.0 / -v.z};
  }
};

// One picture: depth, then contour points.
class Picture {
 public:
  explicit Picture(std::uint32_t size)
      : size_(static_cast<int>(size)),
        depth_(size * size, 0.0F),
        contour_(size * size, glm::vec2(kNowhere)) {}

  void fill(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (area == 0.0F) return;
    const int x0 = std::max(0, static_cast<int>(std::floor(std::min({a.x, b.x, c.x}) - 0.5F)));
    const int x1 =
        std::min(size_ - 1, static_cast<int>(std::ceil(std::max({a.x, b.x, c.x}) - 0.5F)));
    const int y0 = std::max(0, static_cast<int>(std::floor(std::min({a.y, b.y, c.y}) - 0.5F)));
    const int y1 =
        std::min(size_ - 1, static_cast<int>(std::ceil(std::max({a.y, b.y, c.y}) - 0.5F)));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const float px = static_cast<float>(x) + 0.5F;
        const float py = static_cast<float>(y) + 0.5F;
        const float wa = ((b.x - px) * (c.y - py) - (b.y - py) * (c.x - px)) / area;
        const float wb = ((c.x - px) * (a.y - py) - (c.y - py) * (a.x - px)) / area;
        const float wc = 1.0F - wa - wb;
        if (wa < 0.0F || wb < 0.0F || wc < 0.0F) continue;
        float& depth = depth_[at(x, y)];
        depth = std::max(depth, wa * a.z + wb * b.z + wc * c.z);
      }
    }
  }

  void line(const glm::vec3& a, const glm::vec3& b) {
    const float length = std::max(std::abs(b.x - a.x), std::abs(b.y - a.y));
    const int steps = static_cast<int>(std::ceil(length)) + 1;
    for (int i = 0; i <= steps; ++i) {
      const glm::vec3 p = glm::mix(a, b, static_cast<float>(i) / static_cast<float>(steps));
      const int x = static_cast<int>(std::floor(p.x));
      const int y = static_cast<int>(std::floor(p.y));
      if (x < 1 || y < 1 || x >= size_ - 1 || y >= size_ - 1) continue;
      if (isVisible(x, y, p.z)) contour_[at(x, y)] = {p.x, p.y};
    }
  }

  [[nodiscard]] const std::vector<glm::vec2>& contour() const { return contour_; }

 private:
  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) +
           static_cast<std::size_t>(x);
  }

  // Of the pixel and its eight neighbours one must not be nearer (papers/004, section 3.4).
  [[nodiscard]] bool isVisible(int x, int y, float z) const {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (z * (1.0F + kBias) >= depth_[at(x + dx, y + dy)]) return true;
      }
    }
    return false;
  }

  int size_;
  std::vector<float> depth_;  // 1 / depth; 0: nothing there
  std::vector<glm::vec2> contour_;
};

// An edge and its two faces; the second is kNoFace on a border. Edges with more are taken pairwise.
struct Edge {
  static constexpr std::uint32_t kNoFace = ~0U;
  std::uint32_t a;
  std::uint32_t b;
  std::uint32_t faces[2];
};

std::vector<Edge> edgesOf(const PlainMesh& mesh) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t low = std::min(t[k], t[(k + 1) % 3]);
      const std::uint64_t high = std::max(t[k], t[(k + 1) % 3]);
      sides.emplace_back(low << 32 | high, f);
    }
  }
  std::sort(sides.begin(), sides.end());
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < sides.size();) {
    const bool isPair = i + 1 < sides.size() && sides[i + 1].first == sides[i].first;
    edges.push_back(
        {static_cast<std::uint32_t>(sides[i].first >> 32),
         static_cast<std::uint32_t>(sides[i].first),
         {sides[i].second, isPair ? sides[i + 1].second : Edge::kNoFace}});
    i += isPair ? 2 : 1;
  }
  return edges;
}

std::vector<glm::vec2> drawContours(
    const PlainMesh& mesh,
    const std::vector<Edge>& edges,
    const Camera& camera,
    std::uint32_t size) {
  std::vector<glm::vec3> projected;
  for (const glm::dvec3& p : mesh.positions)
    projected.push_back(camera.project(p));
  Picture picture(size);
  std::vector<bool> isFront;
  for (const glm::uvec3& t : mesh.triangles) {
    picture.fill(projected[t.x], projected[t.y], projected[t.z]);
    const glm::dvec3& a = mesh.positions[t.x];
    const glm::dvec3 normal = glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
    isFront.push_back(glm::dot(normal, camera.eye - a) > 0.0);
  }
  for (const Edge& edge : edges) {
    if (edge.faces[1] == Edge::kNoFace || isFront[edge.faces[0]] != isFront[edge.faces[1]])
      picture.line(projected[edge.a], projected[edge.b]);
  }
  return picture.contour();
}

// Index of the nearest contour pixel of every pixel, −1 without any. Two passes of lower envelopes.
class NearestContour {
 public:
  NearestContour(const std::vector<glm::vec2>& contour, std::uint32_t size)
      : size_(static_cast<int>(size)),
        rows_(contour.size(), -1),
        nearest_(contour.size(), -1) {
    for (int y = 0; y < size_; ++y) {
      int last = -1;
      for (int x = 0; x < size_; ++x) {
        if (contour[at(x, y)].x > kNowhere) last = x;
        rows_[at(x, y)] = last;
      }
      last = -1;
      for (int x = size_; x-- > 0;) {
        if (contour[at(x, y)].x > kNowhere) last = x;
        int& best = rows_[at(x, y)];
        if (last >= 0 && (best < 0 || last - x < x - best)) best = last;
      }
    }
    std::vector<int> hull;
    std::vector<double> from;
    for (int x = 0; x < size_; ++x)
      column(x, hull, from);
  }

  [[nodiscard]] int operator[](std::size_t pixel) const { return nearest_[pixel]; }

 private:
  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) +
           static_cast<std::size_t>(x);
  }

  void column(int x, std::vector<int>& hull, std::vector<double>& from) {
    hull.clear();
    from.clear();
    const auto height = [&](int y) {
      const double d = rows_[at(x, y)] - x;
      return d * d + static_cast<double>(y) * y;
    };
    for (int y = 0; y < size_; ++y) {
      if (rows_[at(x, y)] < 0) continue;
      double start = -1e30;
      while (!hull.empty()) {
        start = (height(y) - height(hull.back())) / (2.0 * (y - hull.back()));
        if (start > from.back()) break;
        hull.pop_back();
        from.pop_back();
        start = -1e30;
      }
      hull.push_back(y);
      from.push_back(start);
    }
    if (hull.empty()) return;
    std::size_t k = 0;
    for (int y = 0; y < size_; ++y) {
      while (k + 1 < hull.size() && from[k + 1] < y)
        ++k;
      nearest_[at(x, y)] = static_cast<int>(at(rows_[at(x, hull[k])], hull[k]));
    }
  }

  int size_;
  std::vector<int> rows_;     // nearest in the row, by x
  std::vector<int> nearest_;  // pixel
};

void collect(
    const std::vector<glm::vec2>& from,
    const std::vector<glm::vec2>& to,
    const NearestContour& nearest,
    std::vector<float>& distances) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (from[i].x <= kNowhere) continue;
    const int other = nearest[i];
    const double d = other < 0 ? ContourReference::kFar
                               : glm::distance(from[i], to[static_cast<std::size_t>(other)]);
    distances.push_back(static_cast<float>(std::min(d, ContourReference::kFar)));
  }
}

// View i of n: the golden spiral over the sphere.
Camera cameraOf(const PlainMesh& mesh, std::uint32_t i, std::uint32_t n, std::uint32_t size) {
  glm::dvec3 low(1e300);
  glm::dvec3 high(-1e300);
  for (const glm::dvec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec3 centre = 0.5 * (low + high);
  double radius = 0.0;
  for (const glm::dvec3& p : mesh.positions)
    radius = std::max(radius, glm::distance(centre, p));
  const double z = 1.0 - (2.0 * i + 1.0) / n;
  const double turn = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double flat = std::sqrt(1.0 - z * z);
  const glm::dvec3 back(flat * std::cos(turn), flat * std::sin(turn), z);
  const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0.0, 1.0, 0.0), back));
  const glm::dvec3 up = glm::cross(back, right);
  Camera camera;
  camera.eye = centre + kDistance * radius * back;
  camera.axes = glm::transpose(glm::dmat3(right, up, back));
  camera.middle = 0.5 * size;
  camera.scale = camera.middle / std::tan(kHalfAngle * std::numbers::pi / 180.0);
  return camera;
}

}  // namespace

struct ContourReference::View {
  Camera camera;
  std::vector<glm::vec2> contour;
  NearestContour nearest;
};

ContourReference::ContourReference(const PlainMesh& mesh, std::uint32_t views, std::uint32_t size)
    : size_(size) {
  const std::vector<Edge> edges = edgesOf(mesh);
  for (std::uint32_t i = 0; i < views; ++i) {
    const Camera camera = cameraOf(mesh, i, views, size);
    auto contour = drawContours(mesh, edges, camera, size);
    NearestContour nearest(contour, size);
    views_.push_back({camera, std::move(contour), std::move(nearest)});
  }
}

ContourReference::~ContourReference() = default;

ContourError ContourReference::compare(const PlainMesh& mesh) const {
  std::vector<float> distances;
  const std::vector<Edge> edges = edgesOf(mesh);
  for (const View& view : views_) {
    const auto contour = drawContours(mesh, edges, view.camera, size_);
    const NearestContour nearest(contour, size_);
    collect(view.contour, contour, nearest, distances);
    collect(contour, view.contour, view.nearest, distances);
  }
  ContourError error;
  if (distances.empty()) return error;
  for (const float d : distances) {
    error.mean += d;
    error.rms += static_cast<double>(d) * d;
  }
  error.mean /= static_cast<double>(distances.size());
  error.rms = std::sqrt(error.rms / static_cast<double>(distances.size()));
  const auto at = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() * 95 / 100);
  std::nth_element(distances.begin(), at, distances.end());
  error.p95 = *at;
  return error;
}

}  // namespace limn::bench
