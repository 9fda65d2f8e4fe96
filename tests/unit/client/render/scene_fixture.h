// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"
#include "client/render/gl_context.h"
#include "client/render/renderer.h"
#include "client/stroke/chain/chain.h"

#include "shared/mesh/primitives.h"
#include "shared/silhouette/brute_force.h"

#include <gtest/gtest.h>

#include <optional>
#include <utility>

namespace limn {

/// A complete, never refined snapshot of a generated shape.
inline MeshSnapshot snapshotOf(const TriangleMesh& shape) {
  MeshSnapshot snapshot;
  const auto vertices = static_cast<std::uint32_t>(shape.positions.size());
  auto mesh = ActiveMesh::fromBase({0, vertices}, shape, {});
  EXPECT_TRUE(mesh) << mesh.error().message;
  if (mesh) snapshot.mesh = *std::move(mesh);
  snapshot.model.grid = shape.grid;
  snapshot.model.sphere = boundingSphere(shape.grid, shape.positions);
  snapshot.model.closed = true;
  snapshot.revision = 1;
  // Snapshots of different shapes must look different to a renderer's cache.
  snapshot.model.asset[0] = static_cast<std::uint8_t>(vertices);
  snapshot.model.asset[1] = static_cast<std::uint8_t>(vertices >> 8);
  return snapshot;
}

/// Black lines on white paper, drawn that way, so that dark pixels are lines.
inline RenderOptions blackOnWhite(int size, DrawMode mode) {
  RenderOptions options;
  options.viewport = {size, size};
  options.draw = mode;
  options.style = "technical";
  options.lineColor = glm::vec3(0.0F);
  options.paper = glm::vec3(1.0F);
  return options;
}

inline PolylineSet
silhouetteOf(const MeshSnapshot& snapshot, const Camera& camera, SilhouetteKind kind) {
  const SilhouetteField field(snapshot.mesh.mesh(), snapshot.mesh.positions(), kind);
  BruteForceDetector detector(field);
  SilhouetteChainer chainer;
  const SilhouetteView view{
      snapshot.model.grid.fromModel(camera.eye),
      camera.forward(),
      camera.orthographic};
  return chainer.chain(field, view, detector.detect(view));
}

/// The edges of an axis-aligned box as creases, one line each.
inline PolylineSet boxEdges(const MeshSnapshot& snapshot) {
  const HalfEdgeMesh& mesh = snapshot.mesh.mesh();
  const auto positions = snapshot.mesh.positions();
  PolylineSet lines;
  for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
    if (mesh.twin(h) < h) continue;
    const glm::ivec3 d = positions[mesh.origin(h)] - positions[mesh.target(h)];
    if ((d.x != 0) + (d.y != 0) + (d.z != 0) != 1) continue;  // a face's diagonal
    const auto begin = static_cast<std::uint32_t>(lines.points.size());
    lines.points.emplace_back(positions[mesh.origin(h)]);
    lines.points.emplace_back(positions[mesh.target(h)]);
    lines.halfEdges.insert(lines.halfEdges.end(), {h, kNone});
    lines.faces.insert(lines.faces.end(), {HalfEdgeMesh::face(h), kNone});
    lines.lines.push_back({LineKind::kCrease, false, begin, begin + 2});
  }
  return lines;
}

inline std::optional<Renderer> makeRenderer(GlBackend backend) {
  auto context = createGlContext(backend);
  EXPECT_TRUE(context) << context.error().message;
  if (!context) return std::nullopt;
  auto renderer = Renderer::create(*std::move(context), LIMN_TEST_ASSETS);
  EXPECT_TRUE(renderer) << renderer.error().message;
  if (!renderer) return std::nullopt;
  return *std::move(renderer);
}

/// How dark a pixel is beside white, 0 … 255.
inline int darkness(const Image& image, int x, int y) {
  const std::size_t at = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                              static_cast<std::size_t>(x));
  return 255 - image.rgba[at + 1];
}

}  // namespace limn
