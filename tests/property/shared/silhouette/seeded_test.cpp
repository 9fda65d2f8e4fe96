// SPDX-License-Identifier: Apache-2.0
// The detectors of [Mohr13]: they may miss silhouettes, but what they find are silhouettes, and
// each of their parameters does what it says.
#include "tests/property/shared/silhouette/views.h"

#include "shared/mesh/primitives.h"
#include "shared/silhouette/coherence.h"
#include "shared/silhouette/detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace limn {
namespace {

constexpr SilhouetteKind kKinds[] = {SilhouetteKind::kEdges, SilhouetteKind::kSmooth};

struct Shape {
  explicit Shape(TriangleMesh shape)
      : triangles(std::move(shape)),
        mesh(*HalfEdgeMesh::build(
            static_cast<std::uint32_t>(triangles.positions.size()),
            triangles.triangles)) {}

  [[nodiscard]] SilhouetteField field(SilhouetteKind kind) const {
    return {mesh, triangles.positions, kind};
  }

  TriangleMesh triangles;
  HalfEdgeMesh mesh;
};

std::vector<std::uint32_t> sorted(const SilhouetteResult& result) {
  std::vector<std::uint32_t> found =
      result.kind == SilhouetteKind::kEdges ? result.edges : result.faces;
  std::sort(found.begin(), found.end());
  return found;
}

struct Tally {
  double mean = 0.0;
  double worst = 1.0;
  std::uint64_t facesVisited = 0;
};

// Runs a detector along views; checks that what it finds are silhouettes, each once.
Tally follow(
    const SilhouetteField& field,
    SilhouetteDetector& detector,
    const std::vector<SilhouetteView>& views) {
  const auto brute = makeDetector(DetectorMethod::kBrute, field);
  Tally tally;
  for (const SilhouetteView& view : views) {
    const SilhouetteResult& found = detector.detect(view);
    const SilhouetteResult& truth = brute->detect(view);
    const auto given = sorted(found);
    const auto wanted = sorted(truth);
    EXPECT_EQ(std::adjacent_find(given.begin(), given.end()), given.end());
    EXPECT_TRUE(std::includes(wanted.begin(), wanted.end(), given.begin(), given.end()));
    EXPECT_EQ(found.stats.segments, given.size());
    const double share = recall(found, truth);
    tally.mean += share / static_cast<double>(views.size());
    tally.worst = std::min(tally.worst, share);
    tally.facesVisited += found.stats.facesVisited;
  }
  return tally;
}

Tally follow(
    const SilhouetteField& field,
    DetectorMethod method,
    const DetectorOptions& options,
    const std::vector<SilhouetteView>& views) {
  return follow(field, *makeDetector(method, field, options), views);
}

TEST(SeededDetectors, FindOnlySilhouettesEachOnceOnClosedAndOpenShapes) {
  for (const auto& triangles : {primitives::bumpySphere(4, 7), primitives::openGrid(30, 20)}) {
    const Shape shape(triangles);
    for (const SilhouetteKind kind : kKinds) {
      const SilhouetteField field = shape.field(kind);
      auto views = testing::randomViews(shape.triangles, 10, 4);
      const auto orbit = testing::orbitViews(shape.triangles, 40, 0.9);
      views.insert(views.end(), orbit.begin(), orbit.end());
      DetectorOptions plain;
      DetectorOptions all;
      all.random = {.fraction = 0.05, .sortByDihedral = true, .searchSteps = 12};
      all.coherence.rings = 2;
      all.coherence.followMotion = true;
      all.coherence.reseedWith = DetectorMethod::kRandom;
      all.coherence.reseedBelow = 0.9;
      for (const DetectorOptions& options : {plain, all}) {
        for (const DetectorMethod method :
             {DetectorMethod::kRandom, DetectorMethod::kCoherenceA, DetectorMethod::kCoherenceB}) {
          SCOPED_TRACE(detectorName(method));
          follow(field, method, options, views);
        }
      }
    }
  }
}

TEST(SeededDetectors, NamesAreTheCommandsNames) {
  for (const DetectorMethod method : allDetectors()) {
    EXPECT_EQ(detectorFromName(detectorName(method)), method);
  }
  EXPECT_EQ(detectorName(DetectorMethod::kCoherenceA), "coherence-a");
  EXPECT_EQ(detectorFromName("guess"), std::nullopt);
}

TEST(RandomSeeds, MoreSeedsFindMore) {
  const Shape shape(primitives::bumpySphere(5, 7));
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field = shape.field(kind);
    const auto views = testing::randomViews(shape.triangles, 30, 5);
    double last = -1.0;
    for (const double fraction : {0.0, 0.002, 0.1, 3.0}) {
      DetectorOptions options;
      options.random.fraction = fraction;
      const Tally tally = follow(field, DetectorMethod::kRandom, options, views);
      EXPECT_GT(tally.mean, last);
      last = tally.mean;
      if (fraction == 0.0) {
        EXPECT_LT(tally.mean, 0.2);  // 1 where there is nothing to find
      }
    }
    EXPECT_GT(last, 0.98);  // a share is at most 1, drawn with repeats
  }
}

TEST(RandomSeeds, WalkingToASilhouetteMakesUpForFewerSeeds) {
  const Shape shape(primitives::bumpySphere(5, 7));
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field = shape.field(kind);
    const auto views = testing::randomViews(shape.triangles, 30, 5);
    DetectorOptions few;
    few.random.fraction = 0.002;
    DetectorOptions walking = few;
    walking.random.searchSteps = 30;
    EXPECT_GT(
        follow(field, DetectorMethod::kRandom, walking, views).mean,
        follow(field, DetectorMethod::kRandom, few, views).mean);
  }
}

TEST(RandomSeeds, SharpFacesFirstHelpWhereOnlySharpEdgesCanBeSilhouettes) {
  // A box's silhouette edges lie on its sharp edges; most of its faces have none.
  const Shape shape(primitives::torus(12, 200));
  const SilhouetteField field = shape.field(SilhouetteKind::kEdges);
  const auto views = testing::randomViews(shape.triangles, 60, 5);
  DetectorOptions uniform;
  uniform.random.fraction = 0.003;
  DetectorOptions sharp = uniform;
  sharp.random.sortByDihedral = true;
  EXPECT_GE(
      follow(field, DetectorMethod::kRandom, sharp, views).mean + 0.05,
      follow(field, DetectorMethod::kRandom, uniform, views).mean);
}

TEST(CoherenceA, EqualsBruteForceInFramesThatStartAfresh) {
  const Shape shape(primitives::bumpySphere(4, 7));
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field = shape.field(kind);
    DetectorOptions options;
    options.coherence.reseedEvery = 1;
    const auto views = testing::randomViews(shape.triangles, 10, 5);
    EXPECT_EQ(follow(field, DetectorMethod::kCoherenceA, options, views).worst, 1.0);
    EXPECT_EQ(follow(field, DetectorMethod::kCoherenceB, options, views).worst, 1.0);
  }
}

TEST(CoherenceA, ReachesFurtherWithMoreRings) {
  const Shape shape(primitives::bumpySphere(5, 7));
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field = shape.field(kind);
    const auto views = testing::orbitViews(shape.triangles, 60, 0.9);
    double last = 0.0;
    for (const int rings : {0, 1, 3}) {
      DetectorOptions options;
      options.coherence.rings = rings;
      options.coherence.reseedEvery = 0;
      const Tally tally = follow(field, DetectorMethod::kCoherenceA, options, views);
      EXPECT_GT(tally.mean, last);
      last = tally.mean;
    }
    EXPECT_GT(last, 0.5);  // nothing new is ever noticed: reseeding is off
  }
}

TEST(CoherenceA, TheCamerasMotionSparesFacesAndLosesLittle) {
  const Shape shape(primitives::bumpySphere(5, 7));
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field = shape.field(kind);
    const auto views = testing::orbitViews(shape.triangles, 60, 0.9);
    DetectorOptions everywhere;
    everywhere.coherence.rings = 2;
    DetectorOptions directed = everywhere;
    directed.coherence.followMotion = true;
    const Tally wide = follow(field, DetectorMethod::kCoherenceA, everywhere, views);
    const Tally narrow = follow(field, DetectorMethod::kCoherenceA, directed, views);
    EXPECT_LT(narrow.facesVisited, wide.facesVisited);
    EXPECT_GT(narrow.mean, wide.mean - 0.05);
  }
}

TEST(CoherenceB, KeepsTheSilhouettesOfASlowOrbit) {
  for (const auto& triangles : {primitives::torus(96, 48), primitives::torusKnot(2, 3, 300, 24)}) {
    const Shape shape(triangles);
    for (const SilhouetteKind kind : kKinds) {
      const SilhouetteField field = shape.field(kind);
      const auto views = testing::orbitViews(shape.triangles, 120, 0.9);
      EXPECT_GT(follow(field, DetectorMethod::kCoherenceB, {}, views).mean, 0.97);
    }
  }
}

TEST(Reseeding, IsDueAtFirstThenEveryFewFramesOrWhenSegmentsAreLost) {
  ReseedTrigger rhythm({.reseedEvery = 3});
  std::vector<bool> due;
  for (int i = 0; i < 7; ++i)
    due.push_back(rhythm.isDue());
  EXPECT_EQ(due, (std::vector<bool>{true, false, false, true, false, false, true}));

  ReseedTrigger loss({.reseedEvery = 0, .reseedBelow = 0.5});
  EXPECT_TRUE(loss.isDue());
  loss.found(100, true);
  EXPECT_FALSE(loss.isDue());
  loss.found(50, false);
  EXPECT_FALSE(loss.isDue());
  loss.found(49, false);
  EXPECT_TRUE(loss.isDue());
  loss.found(90, true);
  EXPECT_FALSE(loss.isDue());
}

TEST(ImageSeeds, LeadFromTheFacesOfAPictureToSilhouettes) {
  const Shape shape(primitives::bumpySphere(4, 7));
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field = shape.field(kind);
    std::vector<FaceId> faces(shape.mesh.faceCount());
    std::iota(faces.begin(), faces.end(), FaceId{0});
    faces.push_back(1'000'000'000);  // a picture of another mesh must not hurt
    DetectorOptions options;
    const auto views = testing::randomViews(shape.triangles, 10, 5);
    EXPECT_LT(follow(field, DetectorMethod::kImage, options, views).mean, 0.2);  // no picture
    options.imageFaces = [&](const SilhouetteView&) { return std::span<const FaceId>(faces); };
    EXPECT_EQ(follow(field, DetectorMethod::kImage, options, views).worst, 1.0);
  }
}

}  // namespace
}  // namespace limn
