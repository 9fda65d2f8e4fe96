// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/hulls/hulls.h"

#include "server/preprocess/hulls/close_holes.h"

#include <thread>
#include <utility>

namespace limn {
namespace {

double volumeOf(const TriangleMesh& mesh) {
  return volume6(mesh) / 6.0 * mesh.grid.step * mesh.grid.step * mesh.grid.step;
}

}  // namespace

Hulls buildHulls(const TriangleMesh& mesh, const HullOptions& options, unsigned threads) {
  Hulls hulls;
  hulls.extraBits = options.extraBits;
  const auto closed = closeHoles(mesh, {});
  if (!closed) {
    hulls.reason = closed.error().message;
    return hulls;
  }
  hulls.meshVolume = volumeOf(closed->mesh);
  if (!(hulls.meshVolume > 0.0)) {
    hulls.reason = "the mesh encloses no volume";
    return hulls;
  }
  std::optional<Result<BuiltHull>> outer;
  const auto buildOuter = [&] { outer = buildHull(closed->mesh, HullSide::kOuter, options); };
  std::jthread other;
  if (threads > 1) {
    other = std::jthread(buildOuter);
  } else {
    buildOuter();
  }
  auto inner = buildHull(closed->mesh, HullSide::kInner, options);
  if (other.joinable()) other.join();
  if (!*outer || !inner) {
    hulls.reason = (!*outer ? outer->error() : inner.error()).message;
    return hulls;
  }
  hulls.outer = std::move(**outer);
  hulls.inner = std::move(*inner);
  hulls.filledHoles = closed->filledHoles;
  return hulls;
}

double hullVolume(const ProgressiveHull& hull, std::uint32_t faces) {
  const auto level = hullAfter(hull, hull.splitsFor(faces));
  return level ? volumeOf(*level) : 0.0;
}

}  // namespace limn
