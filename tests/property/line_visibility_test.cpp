// SPDX-License-Identifier: Apache-2.0
// Line visibility from the depth image against exact ray casts: from each silhouette edge's middle
// to the eye, past every face but the edge's own two; concave edges are hidden by their own.
#include "client/render/assets.h"
#include "client/render/renderer.h"
#include "client/stroke/chain/chain.h"
#include "client/stroke/visibility/resolved_visibility.h"
#include "client/stroke/visibility/visibility.h"
#include "tests/corpus/corpus.h"
#include "tests/property/segment_meets.h"

#include "shared/mesh/primitives.h"
#include "shared/silhouette/brute_force.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

namespace limn {
namespace {

MeshSnapshot snapshotOf(const TriangleMesh& shape) {
  MeshSnapshot snapshot;
  const auto vertices = static_cast<std::uint32_t>(shape.positions.size());
  auto mesh = ActiveMesh::fromBase({0, vertices}, shape, {});
  EXPECT_TRUE(mesh) << mesh.error().message;
  if (mesh) snapshot.mesh = *std::move(mesh);
  snapshot.model.grid = shape.grid;
  snapshot.model.sphere = boundingSphere(shape.grid, shape.positions);
  return snapshot;
}

/// Ground truth by brute force over all faces. Cost: O(faces).
bool isVisible(const MeshSnapshot& snapshot, const glm::dvec3& eye, HalfEdgeId h) {
  const HalfEdgeMesh& mesh = snapshot.mesh.mesh();
  const auto at = [&](HalfEdgeId e) {
    return glm::dvec3(snapshot.mesh.positions()[mesh.origin(e)]);
  };
  const HalfEdgeId twin = mesh.twin(h);
  const glm::dvec3 a = at(h);
  const glm::dvec3 n = glm::cross(at(HalfEdgeMesh::next(h)) - a, at(HalfEdgeMesh::prev(h)) - a);
  if (glm::dot(n, at(HalfEdgeMesh::prev(twin)) - a) > 0.0) return false;
  const glm::dvec3 middle = 0.5 * (a + at(HalfEdgeMesh::next(h)));
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    if (f == HalfEdgeMesh::face(h) || f == HalfEdgeMesh::face(twin)) continue;
    const auto t = meets(at(3 * f), at(3 * f + 1), at(3 * f + 2), middle, eye - middle);
    if (t && *t > 0.0 && *t < 1.0) return false;
  }
  return true;
}

struct Errors {
  std::size_t edges = 0;
  std::size_t falseVisible = 0;
  std::size_t falseHidden = 0;
  std::size_t longestRow = 0;  // of wrong samples along lines as they are drawn, a pixel apart
};

/// The longest row of samples, filtered as they are drawn, whose answers are not those of resolved
/// visibility at their places.
std::size_t
longestWrongRow(const PolylineSet& lines, const LineScene& scene, const DepthImage& depth) {
  const VisibilityResolver resolver(scene.mesh, scene.positions);
  const ResolvedLines resolved = resolver.resolve(lines, scene);
  const SpineSet spines = projectLines(lines, scene);
  const SpineSamples samples =
      sampleSpines(spines, measureSpines(spines), findSpans(lines, scene), scene.viewport);
  const std::vector<float> seen = sampleVisibility(samples, depth);
  const glm::dmat4 clipFromWorld = scene.camera.clipFromWorld(scene.viewport.aspect());
  const auto fractionOf = [&](std::uint32_t point) {
    const glm::dvec3 p = scene.grid.toModel(glm::dvec3(lines.points[point]));
    return glm::dvec2(pixelFromClip(clipFromWorld * glm::dvec4(p, 1.0), {1, 1}));
  };
  std::size_t longest = 0;
  std::size_t row = 0;
  for (std::size_t s = 0; s < spines.spines.size(); ++s) {
    const PolylineSet::Line& line = lines.lines[spines.spines[s].line];
    const std::size_t end = s + 1 < samples.begin.size() ? samples.begin[s + 1] : seen.size();
    row = 0;
    for (std::size_t i = samples.begin[s]; i < end; ++i) {
      const std::uint32_t point = samples.source[i];
      const glm::dvec2 a = fractionOf(point);
      const glm::dvec2 ab = fractionOf(point + 1 < line.end ? point + 1 : line.begin) - a;
      const glm::dvec2 at(samples.samples[i].position);
      const double t = glm::dot(at - a, ab) / std::max(glm::dot(ab, ab), 1e-18);
      bool truth = false;
      for (const ResolvedLines::Piece& piece : resolved.piecesOf(point)) {
        truth = piece.visible;
        if (t <= piece.end) break;
      }
      row = truth != (seen[i] >= 0.5F) ? row + 1 : 0;
      longest = std::max(longest, row);
    }
  }
  return longest;
}

Errors compare(Renderer& renderer, const TriangleMesh& shape, double azimuth, double elevation) {
  MeshSnapshot snapshot = snapshotOf(shape);
  static std::uint64_t revision = 0;  // each is another mesh to the renderer's cache
  snapshot.revision = ++revision;
  const Camera camera = orbitCamera(snapshot.model.sphere, azimuth, elevation);
  const SilhouetteField field(
      snapshot.mesh.mesh(),
      snapshot.mesh.positions(),
      SilhouetteKind::kEdges);
  BruteForceDetector detector(field);
  SilhouetteChainer chainer;
  const SilhouetteView view{snapshot.model.grid.fromModel(camera.eye), camera.forward(), false};
  const PolylineSet& lines = chainer.chain(field, view, detector.detect(view));
  RenderOptions options;
  options.viewport = {1024, 1024};
  options.keepDepth = true;
  options.draw = DrawMode::kShaded;
  const auto frame = renderer.render(snapshot, lines, camera, options);
  EXPECT_TRUE(frame) << frame.error().message;
  if (!frame) return {};
  const LineScene scene{
      snapshot.mesh.mesh(),
      snapshot.mesh.positions(),
      snapshot.model.grid,
      camera,
      options.viewport};
  const std::vector<std::uint8_t> visible = segmentVisibility(lines, scene, frame->depth);
  Errors errors;
  errors.longestRow = longestWrongRow(lines, scene, frame->depth);
  for (const PolylineSet::Line& line : lines.lines) {
    for (std::uint32_t k = 0; k < line.segmentCount(); ++k) {
      const std::uint32_t point = line.begin + k;
      const bool truth = isVisible(snapshot, view.eye, lines.halfEdges[point]);
      ++errors.edges;
      errors.falseVisible += !truth && visible[point] != 0 ? 1 : 0;
      errors.falseHidden += truth && visible[point] == 0 ? 1 : 0;
    }
  }
  return errors;
}

std::optional<Renderer> makeRenderer() {
  auto context = createGlContext(GlBackend::kOsmesa);
  EXPECT_TRUE(context) << context.error().message;
  auto assets = findAssets();
  EXPECT_TRUE(assets) << assets.error().message;
  if (!context || !assets) return std::nullopt;
  auto renderer = Renderer::create(*std::move(context), *assets);
  EXPECT_TRUE(renderer) << renderer.error().message;
  if (!renderer) return std::nullopt;
  return *std::move(renderer);
}

void expectFewErrors(const std::string& name, const TriangleMesh& shape) {
  auto renderer = makeRenderer();
  ASSERT_TRUE(renderer);
  Errors all;
  for (const auto& [azimuth, elevation] : {std::pair{30.0, 20.0}, {150.0, -10.0}, {260.0, 50.0}}) {
    const Errors errors = compare(*renderer, shape, azimuth, elevation);
    all.edges += errors.edges;
    all.falseVisible += errors.falseVisible;
    all.falseHidden += errors.falseHidden;
    all.longestRow = std::max(all.longestRow, errors.longestRow);
  }
  ASSERT_GT(all.edges, 0U);
  const double falseVisible =
      100.0 * static_cast<double>(all.falseVisible) / static_cast<double>(all.edges);
  const double falseHidden =
      100.0 * static_cast<double>(all.falseHidden) / static_cast<double>(all.edges);
  std::printf(
      "%s: %zu silhouette edges, %.2f %% false visible, %.2f %% false hidden, at most %zu px\n",
      name.c_str(),
      all.edges,
      falseVisible,
      falseHidden,
      all.longestRow);
  // Short runs are left out (kShortRun), and a place of change falls between two samples.
  EXPECT_LE(all.longestRow, 3U) << name;
  EXPECT_LT(falseVisible, 0.5) << name;
  EXPECT_LT(falseHidden, 0.1) << name;
}

TEST(LineVisibility, AgreesWithRayCastsOnATorusKnot) {
  expectFewErrors("knot", primitives::torusKnot(2, 3, 240, 24));
}

TEST(LineVisibility, AgreesWithRayCastsOnABumpySphere) {
  expectFewErrors("bumpy sphere", primitives::bumpySphere(5, 3));
}

TEST(LineVisibility, AgreesWithRayCastsOnAScan) {
  const char* file = std::getenv("LIMN_VISIBILITY_MODEL");
  const corpus::Mesh* model = corpus::model(file == nullptr ? "bunny-low.off" : file);
  if (model == nullptr) GTEST_SKIP() << corpus::kNoModels;
  expectFewErrors(model->name, model->mesh);
}

}  // namespace
}  // namespace limn
