// SPDX-License-Identifier: Apache-2.0
#include "client/view/pick.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(Pick, FindsTheNearestPointOfTheMeshUnderThePointer) {
  const TriangleMesh shape = primitives::bumpySphere(3, 1);
  auto mesh =
      ActiveMesh::fromBase({0, static_cast<std::uint32_t>(shape.positions.size())}, shape, {});
  ASSERT_TRUE(mesh) << mesh.error().message;
  MeshSnapshot snapshot;
  snapshot.mesh = *std::move(mesh);
  snapshot.model.grid = shape.grid;
  const BoundingSphere sphere = boundingSphere(shape.grid, shape.positions);
  const Camera camera = orbitCamera(sphere, 10.0, 15.0);
  const Viewport screen{400, 400};
  const auto hit = pick(snapshot, rayThrough(camera, {200.0, 200.0}, screen));
  ASSERT_TRUE(hit.has_value());
  const double distance = glm::length(camera.eye - sphere.center);
  const double depth = glm::length(*hit - camera.eye);
  EXPECT_LT(depth, distance);  // the front, not the back
  EXPECT_GT(depth, distance - 1.01 * sphere.radius);
  EXPECT_NEAR(glm::length(glm::cross(*hit - camera.eye, camera.forward())), 0.0, 1e-9 * distance);
  EXPECT_FALSE(pick(snapshot, rayThrough(camera, {1.0, 1.0}, screen)).has_value());
}

}  // namespace
}  // namespace limn
