// SPDX-License-Identifier: Apache-2.0
#include "server/session/target_set.h"

#include "server/session/exact_set.h"
#include "server/session/scheduler.h"
#include "tests/unit/server/session/test_model.h"

#include "shared/mesh/primitives.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace limn {
namespace {

const std::shared_ptr<const Model>& bumpy() {
  static const auto model = modelOf(primitives::bumpySphere(4, 3));
  return model;
}

const std::shared_ptr<const Model>& grid() {
  static const auto model = modelOf(primitives::openGrid(30, 20));
  return model;
}

const std::shared_ptr<const Model>& placed() {
  static const auto model = modelOf(primitives::bumpySphere(4, 3), 1, 60, Placement::kVolume);
  return model;
}

std::vector<glm::dvec3> directions() {
  return {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}, {-1, 2, 0.5}, {3, 1, -2}};
}

/// The first class of each split, from the masks.
std::vector<std::uint8_t> classesOf(const SplitForest& forest, const TargetSet& set) {
  std::vector<std::uint8_t> classes(forest.splitCount(), kNotNeeded);
  for (std::size_t c = 0; c < set.classes.size(); ++c) {
    for (VertexId v = forest.baseVertexCount(); v < forest.vertexCount(); ++v) {
      if ((set.classes[c][v / 64] >> (v % 64) & 1) == 0) continue;
      auto& first = classes[v - forest.baseVertexCount()];
      first = std::min(first, static_cast<std::uint8_t>(c));
      EXPECT_NE(set.all()[v / 64] >> (v % 64) & 1, 0U) << "not among all";
    }
  }
  return classes;
}

HaveSet baseOf(const SplitForest& forest) {
  HaveSet have(forest.vertexCount());
  have.addRange(0, forest.baseVertexCount());
  return have;
}

/// Slow oracle of the closure: the definition, by recursion over what each split needs.
void needs(const SplitForest& forest, VertexId v, std::uint8_t as, std::vector<std::uint8_t>& out) {
  if (v < forest.baseVertexCount() || out[v - forest.baseVertexCount()] <= as) return;
  out[v - forest.baseVertexCount()] = as;
  needs(forest, forest.parent(v), as, out);
  const VertexId level = forest.levelBegin[forest.levelOf(v)];
  const auto stand = [&](VertexId x) {
    // Whatever moved it before this level.
    for (VertexId w = forest.baseVertexCount(); w < level; ++w) {
      if (forest.parent(w) == x && forest.split(w).parentMove != glm::ivec3(0))
        needs(forest, w, as, out);
    }
  };
  if (forest.placement() == Placement::kVolume) stand(forest.parent(v));
  for (const VertexId w : forest.ring(v)) {
    needs(forest, w, as, out);
    if (forest.placement() == Placement::kVolume) stand(w);
  }
}

TEST(TargetSet, ClosureIsWhatTheDefinitionSays) {
  for (const auto& model : {bumpy(), placed()}) {
    const SplitForest& forest = model->forest();
    for (const glm::dvec3& direction : directions()) {
      const View view = viewOfPose(poseAt(model->info(), direction), forest.grid);
      const auto own = classifySplits(forest, view, model->smoothCones());
      std::vector<std::uint8_t> slow(own.size(), kNotNeeded);
      for (std::size_t s = 0; s < own.size(); ++s) {
        if (own[s] != kNotNeeded) {
          needs(forest, static_cast<VertexId>(s) + forest.baseVertexCount(), own[s], slow);
        }
      }
      EXPECT_EQ(closeOverPrerequisites(forest, own), slow);
      EXPECT_EQ(classesOf(forest, selectForView(forest, view, model->smoothCones())), slow);
    }
  }
}

TEST(TargetSet, EveryPrefixOfTheOrderIsClosed) {
  for (const auto& model : {bumpy(), grid(), placed()}) {
    const SplitForest& forest = model->forest();
    for (const glm::dvec3& direction : directions()) {
      const View view = viewOfPose(poseAt(model->info(), direction), forest.grid);
      const TargetSet target = selectForView(forest, view);
      HaveSet have = baseOf(forest);
      ScheduleCursor cursor;
      std::size_t total = 0;
      for (std::size_t size = 1;; size = size % 7 + 1) {
        const auto ids = nextSplits(target, have, size, cursor);
        if (ids.empty()) break;
        EXPECT_TRUE(std::ranges::is_sorted(ids));
        for (const VertexId v : ids) {
          forest.forEachPrerequisite(v, [&](VertexId w) {
            ASSERT_TRUE(have.holds(w)) << "split " << v << " before " << w;
          });
          ASSERT_FALSE(have.holds(v)) << "twice";
          have.add(v);
          ++total;
        }
      }
      const auto classes = classesOf(forest, target);
      EXPECT_EQ(total, static_cast<std::size_t>(std::ranges::count_if(classes, [](auto c) {
                  return c != kNotNeeded;
                })));
      EXPECT_TRUE(isClosed(forest, have.words()));
    }
  }
}

TEST(TargetSet, TheMostNeededSplitsComeFirst) {
  const SplitForest& forest = bumpy()->forest();
  const View view = viewOfPose(poseAt(bumpy()->info(), {0, 0, 1}), forest.grid);
  const TargetSet target = selectForView(forest, view);
  const auto classes = classesOf(forest, target);
  HaveSet have = baseOf(forest);
  ScheduleCursor cursor;
  for (std::size_t size = 1;; size = 2 * size % 331 + 1) {
    // Slow oracle: what is missing by class, then id, cut off, sorted.
    std::vector<std::pair<std::uint8_t, VertexId>> missing;
    for (VertexId v = forest.baseVertexCount(); v < forest.vertexCount(); ++v) {
      const std::uint8_t c = classes[v - forest.baseVertexCount()];
      if (c != kNotNeeded && !have.holds(v)) missing.emplace_back(c, v);
    }
    EXPECT_EQ(missingOf(target, have), missing.size());
    std::ranges::sort(missing);
    missing.resize(std::min(size, missing.size()));
    std::vector<VertexId> expected;
    for (const auto& [c, v] : missing)
      expected.push_back(v);
    std::ranges::sort(expected);
    const auto ids = nextSplits(target, have, size, cursor);
    ASSERT_EQ(ids, expected);
    if (ids.empty()) break;
    for (const VertexId v : ids)
      have.add(v);
  }
}

TEST(TargetSet, ASplitBeforeItsPrerequisiteIsNotClosed) {
  const SplitForest& forest = bumpy()->forest();
  HaveSet have = baseOf(forest);
  have.add(forest.vertexCount() - 1);
  EXPECT_FALSE(isClosed(forest, have.words())) << "the finest split alone";
}

/// Slow oracle of the facing test: normals and points sampled over the cone and the sphere. A
/// sample that faces the other way contradicts the answer.
TEST(Facing, IsNeverContradictedByASample) {
  Rng rng(5);
  const auto unit = [&rng] {
    glm::dvec3 d;
    do {
      d = glm::dvec3(rng.uniform(), rng.uniform(), rng.uniform()) * 2.0 - 1.0;
    } while (glm::length(d) > 1.0 || glm::length(d) < 1e-3);
    return glm::normalize(d);
  };
  int front = 0;
  int back = 0;
  for (int round = 0; round < 3000; ++round) {
    View view;
    view.eye = unit() * (3.0 + 10.0 * rng.uniform());
    view.orthographic = rng.below(2) == 0;
    view.forward = unit();
    SplitBounds bounds;
    bounds.center = glm::vec3(unit());
    bounds.radius = static_cast<float>(2.0 * rng.uniform());
    bounds.coneAxis = glm::vec3(unit());
    const double half = rng.uniform() * 1.2;
    bounds.coneCos = static_cast<float>(std::cos(half));
    const Facing facing = facingOf(view, bounds, {bounds.coneAxis, bounds.coneCos});
    if (facing == Facing::kStraddling) continue;
    (facing == Facing::kFront ? front : back) += 1;
    for (int sample = 0; sample < 40; ++sample) {
      const glm::dvec3 axis(bounds.coneAxis);
      const glm::dvec3 side = glm::normalize(glm::cross(axis, unit()));
      const double angle = 0.999 * half * rng.uniform();
      const glm::dvec3 normal = axis * std::cos(angle) + side * std::sin(angle);
      const glm::dvec3 point =
          glm::dvec3(bounds.center) + unit() * (0.999 * bounds.radius * rng.uniform());
      const glm::dvec3 toEye = view.orthographic ? -view.forward : view.eye - point;
      ASSERT_EQ(glm::dot(normal, toEye) > 0.0, facing == Facing::kFront);
    }
  }
  EXPECT_GT(front, 100);
  EXPECT_GT(back, 100);
}

/// Slow oracle of the frustum: what lands in the picture is never ruled out.
TEST(View, NeverRulesOutAPointInThePicture) {
  Rng rng(9);
  const auto& info = bumpy()->info();
  int seen = 0;
  int hidden = 0;
  for (int round = 0; round < 4000; ++round) {
    protocol::Pose pose = poseAt(
        info,
        {rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5},
        0.5 + 3.0 * rng.uniform());
    pose.forward += glm::dvec3(rng.uniform(), rng.uniform(), rng.uniform()) - 0.5;
    pose.width = 900;
    pose.height = 300;
    if (rng.below(2) == 0) pose.orthoHeight = info.radius * (0.2 + rng.uniform());
    const View view = viewOfPose(pose, bumpy()->forest().grid);
    const glm::dvec3 point =
        info.center +
        info.radius * (glm::dvec3(rng.uniform(), rng.uniform(), rng.uniform()) * 2.0 - 1.0);
    const glm::dvec3 f = glm::normalize(pose.forward);
    const glm::dvec3 r = glm::normalize(glm::cross(f, pose.up));
    const glm::dvec3 u = glm::cross(r, f);
    const glm::dvec3 d = point - pose.eye;
    const double depth = glm::dot(d, f);
    const double halfY =
        pose.orthoHeight > 0.0 ? pose.orthoHeight / 2.0 : depth * std::tan(pose.fovY / 2.0);
    const bool inside = (pose.orthoHeight > 0.0 || depth > 0.0) &&
                        std::abs(glm::dot(d, u)) <= halfY &&
                        std::abs(glm::dot(d, r)) <= halfY * 3.0;
    const bool may = view.maySee(bumpy()->forest().grid.fromModel(point), 0.0);
    if (inside) {
      ASSERT_TRUE(may);
    }
    if (!may) ++hidden;
    if (inside) ++seen;
  }
  EXPECT_GT(seen, 100);
  EXPECT_GT(hidden, 100);
}

TEST(TargetSet, FinerBoundsNeedMore) {
  const SplitForest& forest = bumpy()->forest();
  protocol::Pose pose = poseAt(bumpy()->info(), {1, 2, 3});
  std::size_t before = 0;
  for (const float errorPx : {16.0F, 4.0F, 1.0F, 0.25F}) {
    pose.errorPx = errorPx;
    const auto classes =
        closeOverPrerequisites(forest, classifySplits(forest, viewOfPose(pose, forest.grid)));
    const auto needed = static_cast<std::size_t>(
        std::ranges::count_if(classes, [](auto c) { return c != kNotNeeded; }));
    EXPECT_GE(needed, before);
    before = needed;
  }
  EXPECT_GT(before, forest.splitCount() / 4);
  EXPECT_LT(before, forest.splitCount()) << "what faces away is not needed";
}

/// Slow oracle of `exact`: silhouettes found from the definition, face by face, in double.
TEST(ExactSet, NeedsBothFacesOfEverySilhouetteEdge) {
  for (std::size_t i = 0; i < 2 * directions().size(); ++i) {
    const Model& model = i % 2 == 0 ? *bumpy() : *placed();
    const SplitForest& forest = model.forest();
    protocol::Pose pose = poseAt(model.info(), directions()[i / 2], 2.0);
    pose.silhouette = protocol::Silhouette::kEdges;
    const View view = viewOfPose(pose, forest.grid);
    const TargetSet set = selectExact(*model.fullMesh(), view);
    HaveSet have = baseOf(forest);
    ScheduleCursor cursor;
    for (const VertexId v : nextSplits(set, have, forest.splitCount(), cursor))
      have.add(v);
    EXPECT_TRUE(isClosed(forest, have.words()));
    std::map<std::pair<VertexId, VertexId>, std::size_t> faceOf;
    std::vector<double> value(forest.triangles.size());
    for (std::size_t f = 0; f < forest.triangles.size(); ++f) {
      const glm::uvec3 t = forest.triangles[f];
      for (int k = 0; k < 3; ++k)
        faceOf[{t[k], t[(k + 1) % 3]}] = f;
      const glm::dvec3 a(forest.positions[t.x]);
      const glm::dvec3 n =
          glm::cross(glm::dvec3(forest.positions[t.y]) - a, glm::dvec3(forest.positions[t.z]) - a);
      value[f] = glm::dot(glm::normalize(n), view.eye - a);
    }
    std::size_t edges = 0;
    for (const auto& [edge, f] : faceOf) {
      const std::size_t g = faceOf.at({edge.second, edge.first});
      // Faces seen edge-on within rounding may go either way.
      if (std::abs(value[f]) < 0.05 || std::abs(value[g]) < 0.05) continue;
      if ((value[f] > 0.0) == (value[g] > 0.0)) continue;
      ++edges;
      for (const std::size_t face : {f, g}) {
        for (int k = 0; k < 3; ++k)
          ASSERT_TRUE(have.holds(forest.triangles[face][k]));
        forest.forEachSplitOfFace(forest.triangles[face], [&](VertexId v) {
          ASSERT_TRUE(have.holds(v)) << "a corner that will still move";
        });
      }
    }
    EXPECT_GT(edges, 20U);
    EXPECT_LT(have.count(), forest.vertexCount()) << "exact is not everything";
  }
}

TEST(ExactSet, SmoothNeedsTheRingsOfCrossedFaces) {
  const SplitForest& forest = bumpy()->forest();
  const View view = viewOfPose(poseAt(bumpy()->info(), {1, 1, 1}), forest.grid);
  const auto needed = facesOfExact(*bumpy()->fullMesh(), view);
  // A face that shares a corner with a crossed one is needed; crossed ones are found by the faces'
  // being surrounded by needed faces only.
  const auto count = static_cast<std::size_t>(std::ranges::count(needed, 1));
  EXPECT_GT(count, 50U);
  EXPECT_LT(count, needed.size());
  HaveSet have = baseOf(forest);
  ScheduleCursor cursor;
  for (const VertexId v :
       nextSplits(selectExact(*bumpy()->fullMesh(), view), have, forest.splitCount(), cursor))
    have.add(v);
  for (std::size_t f = 0; f < needed.size(); ++f) {
    if (needed[f] == 0) continue;
    for (int k = 0; k < 3; ++k)
      ASSERT_TRUE(have.holds(forest.triangles[f][k]));
  }
}

TEST(Scheduler, EverythingComesOnceInOrderOfId) {
  const SplitForest& forest = grid()->forest();
  HaveSet have = baseOf(forest);
  for (VertexId v = forest.baseVertexCount(); v < forest.levelBegin[2]; v += 2)
    have.add(v);
  ScheduleCursor cursor;
  VertexId last = 0;
  while (true) {
    const auto ids = nextSplitsOfAll(have, 37, cursor);
    if (ids.empty()) break;
    for (const VertexId v : ids) {
      EXPECT_GT(v, last);
      last = v;
      ASSERT_FALSE(have.holds(v));
      have.add(v);
    }
  }
  EXPECT_TRUE(have.complete());
}

TEST(Scheduler, RandomOrderIsLegalCompleteAndNotTheOrderOfIds) {
  const SplitForest& forest = grid()->forest();
  HaveSet have = baseOf(forest);
  Rng rng(11);
  bool jumped = false;
  VertexId highest = 0;
  while (!have.complete()) {
    const auto ids = randomSplits(forest, have, 20, rng);
    ASSERT_FALSE(ids.empty());
    jumped = jumped || ids.front() < highest;
    for (const VertexId v : ids) {
      forest.forEachPrerequisite(v, [&](VertexId w) { ASSERT_TRUE(have.holds(w)); });
      have.add(v);
      highest = std::max(highest, v);
    }
  }
  EXPECT_TRUE(jumped);
}

}  // namespace
}  // namespace limn
