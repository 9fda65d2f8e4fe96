// SPDX-License-Identifier: Apache-2.0
//
// Outlines without gaps: contours of closed meshes are loops, and a drawing has a line wherever the
// depth image of its mesh says that the mesh ends before the paper, or before itself.
#include "tests/unit/client/render/outline_gaps.h"

#include "client/apps/line_finder.h"
#include "client/stroke/chain/crease_contours.h"
#include "client/stroke/chain/crease_noise.h"
#include "tests/corpus/corpus.h"
#include "tests/unit/client/render/scene_fixture.h"

#include "shared/core/rng.h"
#include "shared/mesh/cracks.h"
#include "shared/mesh/feature_edges.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace limn {
namespace {

constexpr double kCreaseDegrees = 40.0;  // limn-prepare's

std::vector<std::uint8_t> creasesOf(const HalfEdgeMesh& mesh, const TriangleMesh& shape) {
  return withoutNoise(mesh, shape.positions, findCreases(mesh, shape.positions, kCreaseDegrees));
}

TEST(Outline, ContoursOfClosedMeshesAreLoopsFromEveryView) {
  int checked = 0;
  int divided = 0;
  for (const corpus::Mesh* model : corpus::closedMeshes()) {
    const TriangleMesh& shape = model->mesh;
    const auto mesh =
        HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
    ASSERT_TRUE(mesh);
    const SilhouetteField field(*mesh, shape.positions, SilhouetteKind::kSmooth);
    CreaseContours contours(field, creasesOf(*mesh, shape));
    divided += contours.isEmpty() ? 0 : 1;
    const auto detector = makeDetector(DetectorMethod::kBrute, field);
    SilhouetteChainer chainer;
    const BoundingSphere sphere = boundingSphere(shape.grid, shape.positions);
    Rng rng(7);
    for (int k = 0; k < 6; ++k) {
      const Camera camera = orbitCamera(
          sphere,
          360.0 * rng.uniform(),
          -80.0 + 160.0 * rng.uniform(),
          k % 2 == 0 ? 1.1 : 4.0);
      const SilhouetteView view{shape.grid.fromModel(camera.eye), camera.forward(), k % 3 == 0};
      const PolylineSet& lines = contours.chain(view, detector->detect(view), chainer);
      for (const PolylineSet::Line& line : lines.lines)
        EXPECT_TRUE(line.closed) << model->name << ", view " << k;
      ++checked;
    }
  }
  EXPECT_GT(checked, 30);
  EXPECT_GT(divided, 1);
}

std::shared_ptr<const MeshSnapshot> creasedSnapshotOf(const corpus::Mesh& model) {
  const auto linked = HalfEdgeMesh::build(
      static_cast<std::uint32_t>(model.mesh.positions.size()),
      model.mesh.triangles);
  EXPECT_TRUE(linked);
  auto snapshot = std::make_shared<MeshSnapshot>(snapshotOf(model.mesh));
  auto mesh = ActiveMesh::fromBase(
      {0, static_cast<std::uint32_t>(model.mesh.positions.size())},
      model.mesh,
      findCreases(*linked, model.mesh.positions, kCreaseDegrees));
  EXPECT_TRUE(mesh);
  if (mesh) snapshot->mesh = *std::move(mesh);
  snapshot->model.closed = model.closed;
  return snapshot;
}

/// Gaps of so many pixels, and what is near their two ends, are none.
constexpr int kMostGapPx = 3;
/// Of open surfaces, where a line ends in the middle of another.
constexpr int kMostOpenGapPx = 8;

/// Draws a model in ink and looks for gaps of its outlines.
void checkOutline(
    Renderer& renderer,
    const corpus::Mesh& model,
    const outline::GapOptions& looking = {.innerOutlines = false}) {
  const auto snapshot = creasedSnapshotOf(model);
  LineFinderOptions finding;
  finding.detector = DetectorMethod::kBrute;
  LineFinder finder(snapshot, finding);
  for (const auto& [azimuth, elevation] : {std::pair(30.0, 20.0), std::pair(200.0, -35.0)}) {
    const Camera camera = orbitCamera(snapshot->model.sphere, azimuth, elevation);
    RenderOptions options;
    options.viewport = {1024, 1024};
    options.style = "ink";
    options.hidden = HiddenLines::kOff;
    options.paper = glm::vec3(1.0F);
    const auto drawing = renderer.render(*snapshot, finder.find(camera).lines, camera, options);
    options.draw = DrawMode::kShaded;
    options.supersample = 1;
    options.keepDepth = true;
    const auto shape = renderer.render(*snapshot, {}, camera, options);
    ASSERT_TRUE(drawing && shape);
    const outline::Gaps found = outline::findGaps(
        drawing->image,
        shape->depth,
        camera,
        snapshot->model.sphere.radius,
        looking);
    EXPECT_GT(found.outlinePixels, 200) << model.name;
    const int most = model.closed ? kMostGapPx : kMostOpenGapPx;
    for (const outline::Gap& gap : found.gaps) {
      EXPECT_LE(gap.extent(), most) << model.name << " from " << azimuth << ", " << elevation
                                    << ": at (" << gap.low.x << ", " << gap.low.y << ")";
    }
  }
}

TEST(Outline, OfGeneratedShapesHasALineAllAlong) {
  auto renderer = makeRenderer(GlBackend::kOsmesa);
  ASSERT_TRUE(renderer);
  for (const corpus::Mesh& model : corpus::generated()) {
    checkOutline(*renderer, model);
  }
}

TEST(Outline, OfModelsHasALineAllAlong) {
  if (!corpus::modelsFolder()) GTEST_SKIP() << corpus::kNoModels;
  auto renderer = makeRenderer(GlBackend::kOsmesa);
  ASSERT_TRUE(renderer);
  for (const char* name : {"fandisk.off", "gears.stl", "casting.off", "rocker-arm.ply"}) {
    const corpus::Mesh* model = corpus::model(name);
    if (model != nullptr) checkOutline(*renderer, *model);
  }
}

TEST(Outline, OfOpenModelsHasALineAllAlongFromInFrontAndFromBehind) {
  if (!corpus::modelsFolder()) GTEST_SKIP() << corpus::kNoModels;
  auto renderer = makeRenderer(GlBackend::kOsmesa);
  ASSERT_TRUE(renderer);
  for (const char* name : {"lion-head.ply", "lego-car.ply"}) {
    const corpus::Mesh* model = corpus::model(name);
    if (model != nullptr) checkOutline(*renderer, *model, {.innerOutlines = true});
  }
}

TEST(Outline, OfAMachineInManyPartsHasALineAcrossTheirCracks) {
  if (!corpus::modelsFolder()) GTEST_SKIP() << corpus::kNoModels;
  auto renderer = makeRenderer(GlBackend::kOsmesa);
  ASSERT_TRUE(renderer);
  const corpus::Mesh* model = corpus::model("engine.glb");
  if (model != nullptr) checkOutline(*renderer, *model, {.innerOutlines = true});
}

}  // namespace
}  // namespace limn
