// SPDX-License-Identifier: Apache-2.0
//
// Lines of a mesh that the client does not hold, on the inner hull that it holds instead: which of
// their parts are taken for visible, against the mesh itself.
#include "client/apps/contour_lines.h"
#include "client/stroke/visibility/resolved_visibility.h"
#include "client/stroke/visibility/visibility.h"
#include "server/preprocess/hulls/build_hull.h"
#include "tests/corpus/corpus.h"
#include "tests/unit/client/render/scene_fixture.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace limn {
namespace {

constexpr Viewport kView{512, 512};

/// Pixels of lines.
struct Lengths {
  double visible = 0.0;  // on the mesh
  double hidden = 0.0;
  double wronglyVisible = 0.0;
  double wronglyHidden = 0.0;
};

/// Each line with the front side to its left, as a server sends it.
PolylineSet orientedAsServers(const PolylineSet& lines, const MeshSnapshot& snapshot) {
  const HalfEdgeMesh& mesh = snapshot.mesh.mesh();
  const auto positions = snapshot.mesh.positions();
  PolylineSet result;
  for (const PolylineSet::Line& line : lines.lines) {
    const HalfEdgeId front = lines.halfEdges[line.begin];
    const bool isFront = HalfEdgeMesh::face(front) == lines.faces[line.begin];
    const glm::vec3 origin(positions[mesh.origin(front)]);
    const bool isAlong = origin == lines.points[line.begin];
    if (isAlong == isFront) {
      appendLine(lines, line, result);
      continue;
    }
    PolylineSet::Line copy = line;
    copy.begin = static_cast<std::uint32_t>(result.points.size());
    const std::uint32_t count = line.end - line.begin;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t segment =
          i + 1 < count ? line.end - 2 - i : (line.closed ? line.end - 1 : kNone);
      result.points.push_back(lines.points[line.end - 1 - i]);
      result.halfEdges.push_back(segment == kNone ? kNone : lines.halfEdges[segment]);
      result.faces.push_back(segment == kNone ? kNone : lines.faces[segment]);
    }
    copy.end = static_cast<std::uint32_t>(result.points.size());
    result.lines.push_back(copy);
  }
  return result;
}

/// The same lines as they would come from a server.
PolylineSet asFromServer(const PolylineSet& lines, int extraBits) {
  ContourLines contour;
  for (const glm::vec3& p : lines.points)
    contour.points.emplace_back(glm::round(p));
  for (const PolylineSet::Line& line : lines.lines)
    contour.lines.push_back({line.begin, line.end, line.closed});
  return linesOf(contour, extraBits);
}

Lengths measure(Renderer& renderer, const TriangleMesh& mesh, std::uint32_t faces, int views) {
  MeshSnapshot snapshot = snapshotOf(mesh);
  const auto built = buildHull(mesh, HullSide::kInner, {.baseFaces = 200});
  EXPECT_TRUE(built) << built.error().message;
  if (!built) return {};
  snapshot.innerHull = std::make_shared<const ProgressiveHull>(built->hull);
  ContourStage stage;
  const auto standIn = stage.snapshotOf(snapshot, faces);
  EXPECT_TRUE(standIn) << standIn.error().message;
  if (!standIn) return {};
  const MeshSnapshot& on = **standIn;
  const int extraBits = on.model.grid.bits - snapshot.model.grid.bits;
  const VisibilityResolver resolver(snapshot.mesh.mesh(), snapshot.mesh.positions());
  Lengths lengths;
  for (int view = 0; view < views; ++view) {
    const Camera camera = orbitCamera(
        snapshot.model.sphere,
        360.0 * view / views + 11.0,
        -60.0 + 37.0 * (view % 4),
        3.0,
        40.0);
    const PolylineSet lines =
        orientedAsServers(silhouetteOf(snapshot, camera, SilhouetteKind::kEdges), snapshot);
    const LineScene truthScene{
        snapshot.mesh.mesh(),
        snapshot.mesh.positions(),
        snapshot.model.grid,
        camera,
        kView};
    const ResolvedLines truth = resolver.resolve(lines, truthScene);
    RenderOptions options;
    options.viewport = kView;
    options.draw = DrawMode::kShaded;
    options.keepDepth = true;
    const auto frame = renderer.render(on, {}, camera, options);
    EXPECT_TRUE(frame);
    if (!frame) return lengths;
    const PolylineSet theirs = asFromServer(lines, extraBits);
    const auto seen = segmentVisibility(
        theirs,
        {on.mesh.mesh(), on.mesh.positions(), on.model.grid, camera, kView},
        frame->depth);
    const glm::dmat4 clip = camera.clipFromWorld(kView.aspect());
    const auto pixel = [&](std::uint32_t point) {
      const glm::dvec3 place =
          snapshot.model.grid.origin + snapshot.model.grid.step * glm::dvec3(lines.points[point]);
      return glm::dvec2(pixelFromClip(clip * glm::dvec4(place, 1.0), kView));
    };
    for (const PolylineSet::Line& line : lines.lines) {
      for (std::uint32_t i = line.begin; i < line.begin + line.segmentCount(); ++i) {
        const std::uint32_t next = i + 1 < line.end ? i + 1 : line.begin;
        const double length = glm::distance(pixel(i), pixel(next));
        double from = 0.0;
        for (const ResolvedLines::Piece& piece : truth.piecesOf(i)) {
          const double part = (piece.end - from) * length;
          from = piece.end;
          (piece.visible ? lengths.visible : lengths.hidden) += part;
          if (piece.visible && seen[i] == 0) lengths.wronglyHidden += part;
          if (!piece.visible && seen[i] != 0) lengths.wronglyVisible += part;
        }
      }
    }
  }
  return lengths;
}

class ContourStrokes : public ::testing::Test {
 protected:
  Lengths check(const std::string& name, const TriangleMesh& mesh, std::uint32_t faces, int views) {
    const Lengths l = measure(*renderer_, mesh, faces, views);
    std::printf(
        "%s, inner hull of %u faces: of %.0f px visible %.2f %% taken for hidden; of %.0f px "
        "hidden %.2f %% taken for visible\n",
        name.c_str(),
        faces,
        l.visible,
        100.0 * l.wronglyHidden / l.visible,
        l.hidden,
        100.0 * l.wronglyVisible / l.hidden);
    return l;
  }

  std::optional<Renderer> renderer_ = makeRenderer(GlBackend::kOsmesa);
};

TEST_F(ContourStrokes, AreVisibleWhereTheMeshShowsThem) {
  ASSERT_TRUE(renderer_);
  for (const auto& [name, mesh] :
       {std::pair("torus", primitives::torus(60, 30)),
        std::pair("bumpy sphere", primitives::bumpySphere(4, 3))}) {
    const Lengths l = check(name, mesh, kStageFaces, 6);
    EXPECT_LT(l.wronglyHidden, 0.02 * l.visible) << name;
    EXPECT_LT(l.wronglyVisible, 0.25 * l.hidden) << name;
  }
}

/// For the README's numbers: LIMN_MEASURE="bunny-closed.ply turbine-blade.ply".
TEST_F(ContourStrokes, OfModelsWhenAsked) {
  const char* names = std::getenv("LIMN_MEASURE");
  if (names == nullptr) GTEST_SKIP() << "LIMN_MEASURE names no models";
  std::istringstream list(names);
  for (std::string name; list >> name;) {
    const corpus::Mesh* mesh = corpus::model(name);
    ASSERT_TRUE(mesh != nullptr) << name;
    for (const std::uint32_t faces : {500U, 2000U, 8000U})
      check(name, mesh->mesh, faces, 8);
  }
}

}  // namespace
}  // namespace limn
