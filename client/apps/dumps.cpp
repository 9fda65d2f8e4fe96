// SPDX-License-Identifier: Apache-2.0
#include "client/apps/dumps.h"

#include "client/pose/camera_file.h"

#include "shared/mesh/ply_writer.h"

#include <nlohmann/json.hpp>

namespace limn {
namespace {

using nlohmann::json;

const char* kindName(LineKind kind) {
  switch (kind) {
    case LineKind::kSilhouette:
      return "silhouette";
    case LineKind::kCrease:
      return "crease";
    case LineKind::kBorder:
      return "border";
    case LineKind::kSeam:
      return "seam";
    case LineKind::kSuggestive:
      return "suggestive";
    case LineKind::kRidge:
      return "ridge";
    case LineKind::kValley:
      return "valley";
    case LineKind::kIntersection:
      return "intersection";
  }
  return "silhouette";
}

json vectorJson(const glm::dvec3& v) {
  return json::array({v.x, v.y, v.z});
}

json cameraJson(const Camera& camera, const Viewport& viewport) {
  const glm::dmat4 clipFromWorld = camera.clipFromWorld(viewport.aspect());
  json matrix = json::array();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column)
      matrix.push_back(clipFromWorld[column][row]);
  }
  json result = json::parse(cameraFileJson(camera));
  result["size"] = {viewport.width, viewport.height};
  result["view_projection"] = matrix;
  return result;
}

}  // namespace

std::string meshPly(const MeshSnapshot& snapshot) {
  return encodePly(
      snapshot.model.grid,
      snapshot.mesh.positions(),
      snapshot.mesh.mesh().triangles(),
      snapshot.mesh.attributes());
}

std::string hullPly(const TriangleMesh& hull) {
  return encodePly(hull.grid, hull.positions, hull.triangles);
}

std::string linesJson(const LineDump& dump) {
  const Grid& grid = dump.snapshot.model.grid;
  const HalfEdgeMesh& mesh = dump.snapshot.mesh.mesh();
  json lines = json::array();
  for (const PolylineSet::Line& line : dump.lines.lines) {
    json points = json::array();
    json visible = json::array();
    json edges = json::array();
    for (std::uint32_t i = line.begin; i < line.end; ++i) {
      points.push_back(vectorJson(grid.origin + grid.step * glm::dvec3(dump.lines.points[i])));
    }
    bool alongEdges = true;
    for (std::uint32_t i = line.begin; i < line.begin + line.segmentCount(); ++i) {
      visible.push_back(dump.visible[i] != 0 ? 1 : 0);
      const HalfEdgeId h = dump.lines.halfEdges[i];
      alongEdges = alongEdges && h != kNone;
      if (alongEdges) edges.push_back({mesh.origin(h), mesh.target(h)});
    }
    json entry = {
        {"kind", kindName(line.kind)},
        {"closed", line.closed},
        {"points", std::move(points)},
        {"visible", std::move(visible)}};
    if (alongEdges) entry["edges"] = std::move(edges);
    lines.push_back(std::move(entry));
  }
  const json root = {
      {"camera", cameraJson(dump.camera, dump.viewport)},
      {"lines", std::move(lines)}};
  return root.dump() + "\n";
}

}  // namespace limn
