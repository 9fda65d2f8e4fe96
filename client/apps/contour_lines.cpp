// SPDX-License-Identifier: Apache-2.0
#include "client/apps/contour_lines.h"

#include <cmath>
#include <utility>

namespace limn {

Result<std::shared_ptr<const MeshSnapshot>> ContourStage::snapshotOf(
    const MeshSnapshot& snapshot,
    std::uint32_t faces) {
  const auto& hull = snapshot.innerHull;
  if (!hull) return fail(ErrorCode::kUnavailable, "the inner hull has not arrived: allow more");
  if (made_ && hull_ == hull && faces_ == faces) return made_;
  auto level = hullAfter(*hull, hull->splitsFor(faces));
  if (!level) return tl::unexpected(level.error());
  const auto vertices = static_cast<std::uint32_t>(level->positions.size());
  auto mesh = ActiveMesh::fromBase({0, vertices}, *level, {});
  if (!mesh) return tl::unexpected(mesh.error());
  auto made = std::make_shared<MeshSnapshot>();
  made->model = snapshot.model;
  made->model.grid = level->grid;
  made->model.closed = true;
  made->mesh = *std::move(mesh);
  made->revision = snapshot.revision;
  hull_ = hull;
  faces_ = faces;
  made_ = std::move(made);
  return made_;
}

PolylineSet linesOf(const ContourLines& contour, int extraBits) {
  PolylineSet set;
  const float scale = std::ldexp(1.0F, extraBits - contour.extraBits);
  set.points.reserve(contour.points.size());
  for (const glm::ivec3& p : contour.points)
    set.points.push_back(scale * glm::vec3(p));
  set.halfEdges.assign(set.points.size(), kNone);
  set.faces.assign(set.points.size(), kNone);
  for (const ContourLines::Line& line : contour.lines)
    set.lines.push_back({LineKind::kSilhouette, line.closed, line.begin, line.end});
  return set;
}

}  // namespace limn
