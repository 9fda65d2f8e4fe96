// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain/chain.h"
#include "tests/corpus/corpus.h"
#include "tests/property/shared/silhouette/views.h"

#include "shared/mesh/primitives.h"
#include "shared/silhouette/detector.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace limn {
namespace {

constexpr SilhouetteKind kKinds[] = {SilhouetteKind::kEdges, SilhouetteKind::kSmooth};

std::vector<std::uint32_t> sorted(const SilhouetteResult& result) {
  std::vector<std::uint32_t> found =
      result.kind == SilhouetteKind::kEdges ? result.edges : result.faces;
  std::sort(found.begin(), found.end());
  return found;
}

// The definition itself, one half-edge or face at a time.
std::vector<std::uint32_t> byDefinition(const SilhouetteField& field, const SilhouetteView& view) {
  const HalfEdgeMesh& mesh = field.mesh();
  const glm::vec4 eye = field.eyeOf(view);
  std::vector<std::uint32_t> found;
  if (field.kind() == SilhouetteKind::kEdges) {
    for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
      if (mesh.twins[h] != kNone && field.isFront(HalfEdgeMesh::face(h), eye) &&
          !field.isFront(HalfEdgeMesh::face(mesh.twins[h]), eye)) {
        found.push_back(h);
      }
    }
  } else {
    for (FaceId f = 0; f < mesh.faceCount(); ++f) {
      const glm::uvec3& t = mesh.triangles()[f];
      const bool a = field.isFront(t.x, eye);
      if (field.isFront(t.y, eye) != a || field.isFront(t.z, eye) != a) found.push_back(f);
    }
  }
  return found;
}

// Integer predicate for an eye on the grid: no rounding at all.
bool isFrontExactly(const TriangleMesh& mesh, FaceId f, const glm::ivec3& eye) {
  using Long3 = glm::tvec3<std::int64_t>;
  const glm::uvec3& t = mesh.triangles[f];
  const Long3 a(mesh.positions[t.x]);
  const Long3 u = Long3(mesh.positions[t.y]) - a;
  const Long3 v = Long3(mesh.positions[t.z]) - a;
  const Long3 e = Long3(eye) - a;
  const Long3 n(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
  return n.x * e.x + n.y * e.y + n.z * e.z > 0;
}

HalfEdgeMesh link(const TriangleMesh& mesh) {
  auto linked =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  EXPECT_TRUE(linked) << (linked ? "" : linked.error().message);
  return linked ? std::move(*linked) : HalfEdgeMesh{};
}

// Squashed, sheared and collapsed shapes: zero-area faces, opposite faces in one place, a plane.
std::vector<corpus::Mesh> nearlyDegenerate() {
  std::vector<corpus::Mesh> meshes;
  corpus::Mesh flat{"flat-sphere", primitives::icosphere(4), true};
  for (glm::ivec3& p : flat.mesh.positions)
    p.z = 0;
  corpus::Mesh thin{"thin-torus", primitives::torus(60, 30), true};
  for (glm::ivec3& p : thin.mesh.positions)
    p.x /= 1000;
  corpus::Mesh coarse{"coarse-knot", primitives::torusKnot(2, 3, 300, 24), true};
  for (glm::ivec3& p : coarse.mesh.positions)
    p = (p / 256) * 256;
  corpus::Mesh point{"point", primitives::icosphere(2), true};
  for (glm::ivec3& p : point.mesh.positions)
    p = {5, 5, 5};
  corpus::Mesh plane{"plane", primitives::openGrid(20, 20), false};
  for (glm::ivec3& p : plane.mesh.positions)
    p.z = 100;
  meshes.push_back(std::move(flat));
  meshes.push_back(std::move(thin));
  meshes.push_back(std::move(coarse));
  meshes.push_back(std::move(point));
  meshes.push_back(std::move(plane));
  return meshes;
}

void expectConesEqualBrute(const corpus::Mesh& subject, int viewCount) {
  SCOPED_TRACE(subject.name);
  const HalfEdgeMesh mesh = link(subject.mesh);
  const auto views = testing::randomViews(subject.mesh, viewCount, 42);
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field(mesh, subject.mesh.positions, kind);
    const auto brute = makeDetector(DetectorMethod::kBrute, field);
    const auto cones = makeDetector(DetectorMethod::kCones, field);
    const auto exact = makeDetector(DetectorMethod::kExact, field);
    for (const SilhouetteView& view : views) {
      const auto truth = sorted(brute->detect(view));
      ASSERT_EQ(sorted(cones->detect(view)), truth);
      ASSERT_EQ(sorted(exact->detect(view)), truth);
    }
  }
}

constexpr VectorCode kVectorCodes[] = {
    VectorCode::kPortable,
    VectorCode::kAvx2,
    VectorCode::kAvx512};

DetectorOptions with(VectorCode code) {
  DetectorOptions options;
  options.vectorCode = code;
  return options;
}

TEST(Silhouette, BruteForceIsTheDefinitionWithAndWithoutVectorCode) {
  for (const corpus::Mesh& subject : corpus::generated()) {
    SCOPED_TRACE(subject.name);
    const HalfEdgeMesh mesh = link(subject.mesh);
    for (const SilhouetteKind kind : kKinds) {
      const SilhouetteField field(mesh, subject.mesh.positions, kind);
      for (const VectorCode code : kVectorCodes) {
        const auto brute = makeDetector(DetectorMethod::kBrute, field, with(code));
        for (const SilhouetteView& view : testing::randomViews(subject.mesh, 20, 1)) {
          ASSERT_EQ(sorted(brute->detect(view)), byDefinition(field, view));
        }
      }
    }
  }
}

TEST(Silhouette, FloatFacingIsExactForEyesOnTheGridUpToItsRounding) {
  const TriangleMesh shape = primitives::bumpySphere(4, 3);
  const HalfEdgeMesh mesh = link(shape);
  const SilhouetteField field(mesh, shape.positions, SilhouetteKind::kEdges);
  Rng rng(9);
  std::size_t wrong = 0;
  for (int i = 0; i < 50; ++i) {
    const glm::ivec3 eye(
        static_cast<int>(rng.below(100000)) - 50000,
        static_cast<int>(rng.below(100000)) - 50000,
        static_cast<int>(rng.below(100000)) - 50000);
    const glm::vec4 at = field.eyeOf({glm::dvec3(eye), {}, false});
    for (FaceId f = 0; f < mesh.faceCount(); ++f) {
      if (field.isFront(f, at) != isFrontExactly(shape, f, eye)) ++wrong;
    }
  }
  // 256,000 tests; a float is off only within 2^-21 of edge-on.
  EXPECT_LE(wrong, 2U);
}

TEST(Silhouette, ConesEqualBruteForceOnGeneratedShapes) {
  for (const corpus::Mesh& subject : corpus::generated())
    expectConesEqualBrute(subject, 200);
}

TEST(Silhouette, ConesEqualBruteForceOnNearlyDegenerateShapes) {
  for (const corpus::Mesh& subject : nearlyDegenerate())
    expectConesEqualBrute(subject, 200);
}

TEST(Silhouette, ConesEqualBruteForceFromInsideAndOnTheSurface) {
  const TriangleMesh shape = primitives::torusKnot(2, 3, 300, 24);
  const HalfEdgeMesh mesh = link(shape);
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field(mesh, shape.positions, kind);
    const auto brute = makeDetector(DetectorMethod::kBrute, field);
    const auto cones = makeDetector(DetectorMethod::kCones, field);
    // So near that 16-bit planes decide nothing, and a little away.
    for (std::size_t v = 0; v < shape.positions.size(); v += 37) {
      for (const double away : {0.0, 0.25, 3.0, 100.0}) {
        const SilhouetteView view{glm::dvec3(shape.positions[v]) + away, {}, false};
        ASSERT_EQ(sorted(cones->detect(view)), sorted(brute->detect(view)));
      }
    }
  }
}

TEST(Silhouette, ExactFindsEverythingAlongAnOrbitAndAfterJumps) {
  const TriangleMesh shape = primitives::bumpySphere(5, 7);
  const HalfEdgeMesh mesh = link(shape);
  auto views = testing::orbitViews(shape, 60, 0.9);
  const auto jumps = testing::randomViews(shape, 60, 8);
  views.insert(views.end(), jumps.begin(), jumps.end());
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field(mesh, shape.positions, kind);
    const auto brute = makeDetector(DetectorMethod::kBrute, field);
    const auto exact = makeDetector(DetectorMethod::kExact, field);
    const auto slow = makeDetector(DetectorMethod::kExact, field, with(VectorCode::kPortable));
    for (const SilhouetteView& view : views) {
      const auto truth = sorted(brute->detect(view));
      ASSERT_EQ(sorted(exact->detect(view)), truth);
      ASSERT_EQ(sorted(slow->detect(view)), truth);
    }
  }
}

TEST(Silhouette, ConesTakeAtMost24BytesAFaceOfALargeMesh) {
  const TriangleMesh shape = primitives::bumpySphere(6, 7);
  const HalfEdgeMesh mesh = link(shape);
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field(mesh, shape.positions, kind);
    const auto cones = makeDetector(DetectorMethod::kCones, field);
    EXPECT_LE(cones->memoryBytes(), 24U * mesh.faceCount());
  }
}

TEST(Silhouette, ConesAndExactFindTheSameWithAndWithoutVectorCode) {
  const TriangleMesh shape = primitives::bumpySphere(5, 7);
  const HalfEdgeMesh mesh = link(shape);
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field(mesh, shape.positions, kind);
    const auto brute = makeDetector(DetectorMethod::kBrute, field);
    for (const VectorCode code : kVectorCodes) {
      const auto cones = makeDetector(DetectorMethod::kCones, field, with(code));
      const auto exact = makeDetector(DetectorMethod::kExact, field, with(code));
      for (const SilhouetteView& view : testing::randomViews(shape, 50, 5)) {
        ASSERT_EQ(sorted(cones->detect(view)), sorted(brute->detect(view)));
        ASSERT_EQ(sorted(exact->detect(view)), sorted(brute->detect(view)));
      }
    }
  }
}

// The negative control: were the comparison blind, or the cones never used, this would pass too.
TEST(Silhouette, ConesShrunkByATenthLoseSilhouettes) {
  DetectorOptions shrunk;
  shrunk.coneTangentScale = 0.9;
  const TriangleMesh shape = primitives::bumpySphere(5, 7);
  const HalfEdgeMesh mesh = link(shape);
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field(mesh, shape.positions, kind);
    const auto brute = makeDetector(DetectorMethod::kBrute, field);
    const auto cones = makeDetector(DetectorMethod::kCones, field, shrunk);
    std::size_t missed = 0;
    for (const SilhouetteView& view : testing::randomViews(shape, 200, 42)) {
      missed += brute->detect(view).stats.segments;
      missed -= cones->detect(view).stats.segments;
    }
    EXPECT_GT(missed, 0U);
  }
}

TEST(Silhouette, ConesVisitLessThanHalfTheFacesOfASmoothShape) {
  const TriangleMesh shape = primitives::torusKnot(2, 3, 600, 48);
  const HalfEdgeMesh mesh = link(shape);
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field(mesh, shape.positions, kind);
    const auto cones = makeDetector(DetectorMethod::kCones, field);
    std::uint64_t visited = 0;
    for (const SilhouetteView& view : testing::randomViews(shape, 50, 3)) {
      visited += cones->detect(view).stats.facesVisited;
    }
    EXPECT_LT(visited, 50ULL * mesh.faceCount() / 2);
  }
}

// Chaining
// -----------------------------------------------------------------------------------------

void expectWellChained(
    const SilhouetteField& field,
    const SilhouetteView& view,
    const SilhouetteResult& found,
    const PolylineSet& set) {
  const HalfEdgeMesh& mesh = field.mesh();
  ASSERT_EQ(set.points.size(), set.halfEdges.size());
  ASSERT_EQ(set.points.size(), set.faces.size());
  const glm::vec4 eye = field.eyeOf(view);
  std::vector<std::uint32_t> segments;
  std::uint32_t expectedBegin = 0;
  for (const PolylineSet::Line& line : set.lines) {
    ASSERT_EQ(line.begin, expectedBegin);
    expectedBegin = line.end;
    ASSERT_GE(line.segmentCount(), 1U);
    for (std::uint32_t i = line.begin; i < line.begin + line.segmentCount(); ++i) {
      const FaceId f = set.faces[i];
      const std::uint32_t past = i + 1 == line.end ? line.begin : i + 1;
      if (found.kind == SilhouetteKind::kEdges) {
        const HalfEdgeId h = set.halfEdges[i];
        segments.push_back(h);
        // Front to the left, and points where the half-edge says.
        ASSERT_EQ(HalfEdgeMesh::face(h), f);
        ASSERT_TRUE(field.isFront(f, eye));
        ASSERT_EQ(set.points[i], glm::vec3(field.positions()[mesh.origin(h)]));
        ASSERT_EQ(set.points[past], glm::vec3(field.positions()[mesh.target(h)]));
      } else {
        segments.push_back(f);
        // A neighbour continues in a face across one of this face's edges.
        if (past != line.end - 1 || line.closed) {
          const FaceId g = set.faces[past];
          bool isNeighbour = false;
          for (std::uint32_t k = 0; k < 3; ++k) {
            const HalfEdgeId twin = mesh.twins[3 * f + k];
            isNeighbour |= twin != kNone && HalfEdgeMesh::face(twin) == g;
          }
          ASSERT_TRUE(isNeighbour);
        }
      }
    }
    if (!line.closed) {
      ASSERT_EQ(set.halfEdges[line.end - 1], kNone);
      ASSERT_EQ(set.faces[line.end - 1], kNone);
    }
  }
  ASSERT_EQ(expectedBegin, set.points.size());
  std::sort(segments.begin(), segments.end());
  ASSERT_EQ(segments, sorted(found));  // every one, each once
}

void expectWellChained(const corpus::Mesh& subject, int viewCount) {
  SCOPED_TRACE(subject.name);
  const HalfEdgeMesh mesh = link(subject.mesh);
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field(mesh, subject.mesh.positions, kind);
    const auto cones = makeDetector(DetectorMethod::kCones, field);
    SilhouetteChainer chainer;
    for (const SilhouetteView& view : testing::randomViews(subject.mesh, viewCount, 11)) {
      const SilhouetteResult& found = cones->detect(view);
      const PolylineSet& lines = chainer.chain(field, view, found);
      ASSERT_NO_FATAL_FAILURE(expectWellChained(field, view, found, lines));
      if (!subject.closed) continue;
      for (const PolylineSet::Line& line : lines.lines)
        ASSERT_TRUE(line.closed);
    }
  }
}

TEST(Chain, EverySegmentIsChainedOnceAndClosedMeshesGiveLoops) {
  for (const corpus::Mesh& subject : corpus::generated())
    expectWellChained(subject, 30);
  for (const corpus::Mesh& subject : nearlyDegenerate())
    expectWellChained(subject, 30);
}

TEST(Chain, GivesTheSameLinesWithAndWithoutVectorCode) {
  const TriangleMesh shape = primitives::bumpySphere(4, 9);
  const HalfEdgeMesh mesh = link(shape);
  const SilhouetteField field(mesh, shape.positions, SilhouetteKind::kSmooth);
  const auto cones = makeDetector(DetectorMethod::kCones, field);
  SilhouetteChainer portable(VectorCode::kPortable);
  for (const VectorCode code : kVectorCodes) {
    SilhouetteChainer vectorised(code);
    for (const SilhouetteView& view : testing::randomViews(shape, 50, 12)) {
      const SilhouetteResult& found = cones->detect(view);
      const PolylineSet& expected = portable.chain(field, view, found);
      const PolylineSet& lines = vectorised.chain(field, view, found);
      ASSERT_EQ(lines.points, expected.points);
      ASSERT_EQ(lines.faces, expected.faces);
      ASSERT_EQ(lines.lines.size(), expected.lines.size());
      for (std::size_t l = 0; l < lines.lines.size(); ++l) {
        ASSERT_EQ(lines.lines[l].begin, expected.lines[l].begin);
        ASSERT_EQ(lines.lines[l].end, expected.lines[l].end);
        ASSERT_EQ(lines.lines[l].closed, expected.lines[l].closed);
      }
    }
  }
}

TEST(Chain, EverySegmentIsChainedOnceOnRealModels) {
  if (!corpus::modelsFolder()) GTEST_SKIP() << corpus::kNoModels;
  for (const auto& file : corpus::modelFiles(corpus::Size::kSmall)) {
    const corpus::Mesh* subject = corpus::model(file.filename().string());
    if (subject != nullptr) expectWellChained(*subject, 10);
  }
}

TEST(Chain, SmoothPointsLieWhereTheFieldVanishes) {
  const TriangleMesh shape = primitives::torus(48, 24);
  const HalfEdgeMesh mesh = link(shape);
  const SilhouetteField field(mesh, shape.positions, SilhouetteKind::kSmooth);
  const auto brute = makeDetector(DetectorMethod::kBrute, field);
  SilhouetteChainer chainer;
  for (const SilhouetteView& view : testing::randomViews(shape, 20, 2)) {
    const glm::vec4 eye = field.eyeOf(view);
    const PolylineSet& set = chainer.chain(field, view, brute->detect(view));
    for (std::size_t i = 0; i < set.points.size(); ++i) {
      // On one of the face's edges, where the linear interpolation of the corners' values is 0.
      float best = 1e30F;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const HalfEdgeId h = 3 * set.faces[i] + k;
        const float a = field.value(mesh.origin(h), eye);
        const float b = field.value(mesh.target(h), eye);
        if ((a > 0.0F) == (b > 0.0F)) continue;
        const glm::dvec3 p(shape.positions[mesh.origin(h)]);
        const glm::dvec3 q(shape.positions[mesh.target(h)]);
        const glm::dvec3 zero = p + (q - p) * (a / (static_cast<double>(a) - b));
        best = std::min(best, static_cast<float>(glm::length(zero - glm::dvec3(set.points[i]))));
      }
      ASSERT_LT(best, 0.02F);
    }
  }
}

}  // namespace
}  // namespace limn
