// SPDX-License-Identifier: Apache-2.0
// Based on: S. Rusinkiewicz, "Estimating Curvatures and Their Derivatives on Triangle Meshes",
// 3DPVT 2004: the second fundamental form of each face by least squares from the differences of its
// vertices' normals, averaged at vertices by their share of the face's area; the derivative the
// same way, from differences of the forms. Areas: M. Meyer et al., "Discrete Differential-Geometry
// Operators for Triangulated 2-Manifolds", 2003. Normals: G. Thürmer and C. Wüthrich, 1998. The
// feature size is that of the trimesh2 library.
// Deviations: normals are smoothed by rounds of one-ring means; what touches a sharp edge is left
// out.
#include "shared/silhouette/curvature.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limn {
namespace {

/// Rounds of smoothing, at most: a bell of nearly seven edge lengths.
constexpr int kMostRounds = 100;

struct Frame {
  glm::dvec3 u;
  glm::dvec3 v;
};

/// The frame turned, by the shortest way, so that its plane is perpendicular to `normal`.
Frame turned(const Frame& frame, const glm::dvec3& normal) {
  const glm::dvec3 old = glm::cross(frame.u, frame.v);
  const double cosine = glm::dot(old, normal);
  if (cosine <= -1.0 + 1e-12) return {-frame.u, -frame.v};
  const glm::dvec3 aside = normal - cosine * old;
  const glm::dvec3 step = (old + normal) / (1.0 + cosine);
  return {frame.u - step * glm::dot(frame.u, aside), frame.v - step * glm::dot(frame.v, aside)};
}

/// What the axes of frame `to` are in `from`, once `to` lies in its plane.
struct Change {
  double u1, v1, u2, v2;

  Change(const Frame& from, const Frame& to) {
    const Frame flat = turned(to, glm::cross(from.u, from.v));
    u1 = glm::dot(flat.u, from.u);
    v1 = glm::dot(flat.u, from.v);
    u2 = glm::dot(flat.v, from.u);
    v2 = glm::dot(flat.v, from.v);
  }
};

/// A symmetric form (uu, uv, vv) in another frame.
glm::dvec3 changed(const glm::dvec3& form, const Change& c) {
  return {
      form.x * c.u1 * c.u1 + form.y * 2.0 * c.u1 * c.v1 + form.z * c.v1 * c.v1,
      form.x * c.u1 * c.u2 + form.y * (c.u1 * c.v2 + c.u2 * c.v1) + form.z * c.v1 * c.v2,
      form.x * c.u2 * c.u2 + form.y * 2.0 * c.u2 * c.v2 + form.z * c.v2 * c.v2};
}

/// A symmetric cubic form (uuu, uuv, uvv, vvv) in another frame.
glm::dvec4 changed(const glm::dvec4& d, const Change& c) {
  const auto [u1, v1, u2, v2] = c;
  return {
      d.x * u1 * u1 * u1 + d.y * 3.0 * u1 * u1 * v1 + d.z * 3.0 * u1 * v1 * v1 + d.w * v1 * v1 * v1,
      d.x * u1 * u1 * u2 + d.y * (u1 * u1 * v2 + 2.0 * u2 * u1 * v1) +
          d.z * (u2 * v1 * v1 + 2.0 * u1 * v1 * v2) + d.w * v1 * v1 * v2,
      d.x * u1 * u2 * u2 + d.y * (u2 * u2 * v1 + 2.0 * u1 * u2 * v2) +
          d.z * (u1 * v2 * v2 + 2.0 * u2 * v2 * v1) + d.w * v1 * v2 * v2,
      d.x * u2 * u2 * u2 + d.y * 3.0 * u2 * u2 * v2 + d.z * 3.0 * u2 * v2 * v2 +
          d.w * v2 * v2 * v2};
}

/// Solves A x = b for a symmetric positive matrix (lower half read). False where it is singular.
template <int N>
bool solve(std::array<std::array<double, N>, N> a, std::array<double, N>& b) {
  double largest = 0.0;
  for (int i = 0; i < N; ++i)
    largest = std::max(largest, a[i][i]);
  for (int i = 0; i < N; ++i) {  // L D Lᵀ
    for (int j = 0; j < i; ++j) {
      for (int k = 0; k < j; ++k)
        a[i][j] -= a[i][k] * a[j][k] * a[k][k];
      a[i][j] /= a[j][j];
      b[i] -= a[i][j] * b[j];
    }
    for (int k = 0; k < i; ++k)
      a[i][i] -= a[i][k] * a[i][k] * a[k][k];
    if (!(a[i][i] > 1e-12 * largest)) return false;
  }
  for (int i = N - 1; i >= 0; --i) {
    b[i] /= a[i][i];
    for (int k = i + 1; k < N; ++k)
      b[i] -= a[k][i] * b[k];
  }
  return true;
}

class Estimate {
 public:
  Estimate(
      const HalfEdgeMesh& mesh,
      std::span<const glm::ivec3> positions,
      const CurvatureOptions& options)
      : mesh_(mesh),
        positions_(positions),
        options_(options) {}

  SurfaceCurvature run() {
    const std::size_t vertices = mesh_.vertexCount();
    out_.directions1.assign(vertices, glm::vec3(0.0F));
    out_.directions2.assign(vertices, glm::vec3(0.0F));
    out_.curvatures.assign(vertices, glm::vec2(0.0F));
    out_.derivatives.assign(vertices, glm::vec4(0.0F));
    out_.isKnown.assign(vertices, 0);
    findSharp();
    measure();
    smoothNormals();
    out_.normals.assign(normals_.begin(), normals_.end());
    findForms();
    findDerivatives();
    out_.featureSize = featureSize();
    return std::move(out_);
  }

 private:
  [[nodiscard]] glm::dvec3 at(std::uint32_t vertex) const { return glm::dvec3(positions_[vertex]); }

  void findSharp() {
    isSharp_.assign(mesh_.vertexCount(), 0);
    for (HalfEdgeId h = 0; h < options_.sharp.size(); ++h) {
      if (options_.sharp[h] == 0) continue;
      isSharp_[mesh_.origin(h)] = 1;
      isSharp_[mesh_.target(h)] = 1;
    }
  }

  /// Areas of corners and vertices, first normals, mean edge length.
  void measure() {
    const std::uint32_t faces = mesh_.faceCount();
    cornerAreas_.assign(faces, glm::dvec3(0.0));
    areas_.assign(mesh_.vertexCount(), 0.0);
    normals_.assign(mesh_.vertexCount(), glm::dvec3(0.0));
    isFlat_.assign(faces, 0);
    double lengths = 0.0;
    for (FaceId f = 0; f < faces; ++f) {
      std::array<glm::dvec3, 3> edges;  // opposite the corners
      std::array<double, 3> squares{};
      for (std::uint32_t k = 0; k < 3; ++k) {
        edges[k] = at(corner(f, k + 2)) - at(corner(f, k + 1));
        squares[k] = glm::dot(edges[k], edges[k]);
        lengths += std::sqrt(squares[k]);
      }
      const glm::dvec3 across = glm::cross(edges[0], edges[1]);
      const double area = 0.5 * glm::length(across);
      if (!(area > 0.0)) {
        isFlat_[f] = 1;
        continue;
      }
      glm::dvec3& shares = cornerAreas_[f];
      // Voronoi shares; of an obtuse triangle half to the obtuse corner.
      std::array<double, 3> cosines{};
      int obtuse = -1;
      for (int k = 0; k < 3; ++k) {
        cosines[k] = -glm::dot(edges[(k + 1) % 3], edges[(k + 2) % 3]);
        if (cosines[k] <= 0.0) obtuse = k;
      }
      for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        const int last = (k + 2) % 3;
        if (obtuse >= 0) {
          shares[k] = k == obtuse ? 0.5 * area : 0.25 * area;
        } else {
          shares[k] =
              (squares[next] * cosines[next] + squares[last] * cosines[last]) / (16.0 * area);
        }
      }
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t v = corner(f, static_cast<std::uint32_t>(k));
        areas_[v] += shares[k];
        normals_[v] += across * (std::atan2(2.0 * area, cosines[k]) / (2.0 * area));
      }
    }
    meanEdge_ = faces > 0 ? lengths / (3.0 * faces) : 1.0;
    for (glm::dvec3& n : normals_)
      n = unitOr(n, glm::dvec3(0.0));
  }

  [[nodiscard]] std::uint32_t corner(FaceId face, std::uint32_t k) const {
    return mesh_.origins[3 * face + k % 3];
  }

  static glm::dvec3 unitOr(const glm::dvec3& v, const glm::dvec3& otherwise) {
    const double length = glm::length(v);
    return length > 0.0 ? v / length : otherwise;
  }

  [[nodiscard]] double extent() const {
    if (positions_.empty()) return 1.0;
    glm::ivec3 low = positions_.front();
    glm::ivec3 high = low;
    for (const glm::ivec3& p : positions_) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    return std::max(0.5 * glm::length(glm::dvec3(high - low)), 1.0);
  }

  void smoothNormals() {
    const double sigma =
        std::max(options_.smoothing * extent(), options_.smoothingEdges * meanEdge_);
    // A round over rings of six adds 6/7 · edge² / 2 to the variance along each axis.
    const double perRound = 3.0 / 7.0 * meanEdge_ * meanEdge_;
    const int rounds =
        static_cast<int>(std::min<double>(std::lround(sigma * sigma / perRound), kMostRounds));
    std::vector<glm::dvec3> sums(normals_.size());
    for (int round = 0; round < rounds; ++round) {
      for (std::size_t v = 0; v < sums.size(); ++v)
        sums[v] = areas_[v] * normals_[v];
      for (HalfEdgeId h = 0; h < mesh_.origins.size(); ++h) {
        const std::uint32_t from = mesh_.origin(h);
        const std::uint32_t to = mesh_.target(h);
        if (isSharp_[from] != 0 || isSharp_[to] != 0) continue;
        sums[from] += areas_[to] * normals_[to];
        if (mesh_.twin(h) == kNone) sums[to] += areas_[from] * normals_[from];
      }
      for (std::size_t v = 0; v < sums.size(); ++v)
        normals_[v] = unitOr(sums[v], normals_[v]);
    }
  }

  /// Whether a face tells something about curvature, and its own frame.
  [[nodiscard]] bool frameOf(FaceId f, Frame& frame, std::array<glm::dvec3, 3>& edges) const {
    if (isFlat_[f] != 0) return false;
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (isSharp_[corner(f, k)] != 0) return false;
      edges[k] = at(corner(f, k + 2)) - at(corner(f, k + 1));
    }
    frame.u = glm::normalize(edges[0]);
    frame.v = glm::normalize(glm::cross(glm::cross(edges[0], edges[1]), frame.u));
    return true;
  }

  [[nodiscard]] Frame frameAt(std::uint32_t v) const {
    return {glm::dvec3(out_.directions1[v]), glm::dvec3(out_.directions2[v])};
  }

  void findForms() {
    const std::size_t vertices = mesh_.vertexCount();
    for (std::uint32_t v = 0; v < vertices; ++v) {
      // Any frame will do until the principal one is known.
      const glm::dvec3& n = normals_[v];
      const glm::dvec3 axis = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
      const glm::dvec3 u = unitOr(glm::cross(axis, n), glm::dvec3(0, 0, 1));
      out_.directions1[v] = glm::vec3(u);
      out_.directions2[v] = glm::vec3(glm::cross(n, u));
    }
    std::vector<glm::dvec3> forms(vertices, glm::dvec3(0.0));
    std::vector<double> weights(vertices, 0.0);
    Frame frame{};
    std::array<glm::dvec3, 3> edges;
    for (FaceId f = 0; f < mesh_.faceCount(); ++f) {
      if (!frameOf(f, frame, edges)) continue;
      std::array<double, 3> m{};
      std::array<std::array<double, 3>, 3> w{};
      for (std::uint32_t k = 0; k < 3; ++k) {
        const double u = glm::dot(edges[k], frame.u);
        const double v = glm::dot(edges[k], frame.v);
        const glm::dvec3 turn = normals_[corner(f, k + 2)] - normals_[corner(f, k + 1)];
        const double turnU = glm::dot(turn, frame.u);
        const double turnV = glm::dot(turn, frame.v);
        w[0][0] += u * u;
        w[1][0] += u * v;
        w[2][2] += v * v;
        m[0] += turnU * u;
        m[1] += turnU * v + turnV * u;
        m[2] += turnV * v;
      }
      w[1][1] = w[0][0] + w[2][2];
      w[2][1] = w[1][0];
      if (!solve<3>(w, m)) continue;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t v = corner(f, k);
        const double weight = cornerAreas_[f][static_cast<int>(k)];
        forms[v] += weight * changed(glm::dvec3(m[0], m[1], m[2]), Change(frame, frameAt(v)));
        weights[v] += weight;
      }
    }
    for (std::uint32_t v = 0; v < vertices; ++v) {
      if (!(weights[v] > 0.0)) continue;
      out_.isKnown[v] = 1;
      findPrincipal(v, forms[v] / weights[v]);
    }
  }

  /// Diagonalises the form (uu, uv, vv) at v by one Jacobi rotation.
  void findPrincipal(std::uint32_t v, const glm::dvec3& form) {
    double cosine = 1.0;
    double sine = 0.0;
    double tangent = 0.0;
    if (form.y != 0.0) {
      const double h = 0.5 * (form.z - form.x) / form.y;
      const double root = std::sqrt(1.0 + h * h);
      tangent = h < 0.0 ? 1.0 / (h - root) : 1.0 / (h + root);
      cosine = 1.0 / std::sqrt(1.0 + tangent * tangent);
      sine = tangent * cosine;
    }
    double first = form.x - tangent * form.y;
    double second = form.z + tangent * form.y;
    const Frame frame = frameAt(v);
    glm::dvec3 direction = cosine * frame.u - sine * frame.v;
    if (std::abs(first) < std::abs(second)) {
      std::swap(first, second);
      direction = sine * frame.u + cosine * frame.v;
    }
    out_.directions1[v] = glm::vec3(direction);
    out_.directions2[v] = glm::vec3(glm::cross(normals_[v], direction));
    out_.curvatures[v] = glm::vec2(first, second);
  }

  void findDerivatives() {
    const std::size_t vertices = mesh_.vertexCount();
    std::vector<glm::dvec4> sums(vertices, glm::dvec4(0.0));
    std::vector<double> weights(vertices, 0.0);
    Frame frame{};
    std::array<glm::dvec3, 3> edges;
    for (FaceId f = 0; f < mesh_.faceCount(); ++f) {
      if (!frameOf(f, frame, edges)) continue;
      std::array<glm::dvec3, 3> forms;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t v = corner(f, k);
        const glm::dvec2 own(out_.curvatures[v]);
        forms[k] = changed(glm::dvec3(own.x, 0.0, own.y), Change(frameAt(v), frame));
      }
      std::array<double, 4> m{};
      std::array<std::array<double, 4>, 4> w{};
      for (std::uint32_t k = 0; k < 3; ++k) {
        const glm::dvec3 change = forms[(k + 2) % 3] - forms[(k + 1) % 3];
        const double u = glm::dot(edges[k], frame.u);
        const double v = glm::dot(edges[k], frame.v);
        w[0][0] += u * u;
        w[1][0] += u * v;
        w[3][3] += v * v;
        m[0] += u * change.x;
        m[1] += v * change.x + 2.0 * u * change.y;
        m[2] += 2.0 * v * change.y + u * change.z;
        m[3] += v * change.z;
      }
      w[1][1] = 2.0 * w[0][0] + w[3][3];
      w[2][1] = 2.0 * w[1][0];
      w[2][2] = w[0][0] + 2.0 * w[3][3];
      w[3][2] = w[1][0];
      if (!solve<4>(w, m)) continue;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t v = corner(f, k);
        const double weight = cornerAreas_[f][static_cast<int>(k)];
        sums[v] += weight * changed(glm::dvec4(m[0], m[1], m[2], m[3]), Change(frame, frameAt(v)));
        weights[v] += weight;
      }
    }
    for (std::uint32_t v = 0; v < vertices; ++v) {
      if (weights[v] > 0.0) out_.derivatives[v] = glm::vec4(sums[v] / weights[v]);
    }
  }

  /// A hundredth of the radius of curvature where only the flattest tenth bends less, at most a
  /// twentieth of the mesh's extent.
  [[nodiscard]] float featureSize() const {
    const double most = 0.05 * extent();
    std::vector<float> sizes;
    for (std::uint32_t v = 0; v < mesh_.vertexCount(); ++v) {
      if (out_.isKnown[v] == 0) continue;
      sizes.push_back(std::abs(out_.curvatures[v].x));
      sizes.push_back(std::abs(out_.curvatures[v].y));
    }
    if (sizes.empty()) return static_cast<float>(most);
    const auto tenth = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 10);
    std::nth_element(sizes.begin(), tenth, sizes.end());
    return static_cast<float>(std::min(0.01 / std::max<double>(*tenth, 1e-12), most));
  }

  const HalfEdgeMesh& mesh_;
  std::span<const glm::ivec3> positions_;
  CurvatureOptions options_;
  std::vector<std::uint8_t> isSharp_;    // by vertex: on a sharp edge
  std::vector<std::uint8_t> isFlat_;     // by face: without area
  std::vector<glm::dvec3> cornerAreas_;  // by face
  std::vector<double> areas_;            // by vertex
  std::vector<glm::dvec3> normals_;
  double meanEdge_ = 1.0;
  SurfaceCurvature out_;
};

}  // namespace

SurfaceCurvature curvatureOf(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    const CurvatureOptions& options) {
  return Estimate(mesh, positions, options).run();
}

}  // namespace limn
