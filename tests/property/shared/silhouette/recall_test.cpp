// SPDX-License-Identifier: Apache-2.0
// The complete detectors lose nothing: brute force, cones and exact find the same edges or faces
// and, chained, the same loops, on every good mesh, at the base, at a partial cut and complete.
// A few views of small meshes, or LIMN_ALL_VIEWS=500 for so many of every mesh there is.
#include "client/stroke/chain/chain.h"
#include "server/preprocess/forest/build_forest.h"
#include "tests/corpus/corpus.h"
#include "tests/property/legal_order.h"
#include "tests/property/shared/silhouette/views.h"

#include "shared/progressive/active_mesh.h"
#include "shared/silhouette/detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace limn {
namespace {

std::vector<std::uint32_t> sorted(const SilhouetteResult& result) {
  std::vector<std::uint32_t> found =
      result.kind == SilhouetteKind::kEdges ? result.edges : result.faces;
  std::sort(found.begin(), found.end());
  return found;
}

// A line by its segments, wherever a loop was begun.
struct LineName {
  std::uint64_t sum = 0;  // of a hash of each segment
  std::uint32_t segments = 0;
  bool closed = false;

  auto operator<=>(const LineName&) const = default;
};

std::vector<LineName> namesOf(const PolylineSet& set, SilhouetteKind kind) {
  std::vector<LineName> names;
  for (const PolylineSet::Line& line : set.lines) {
    LineName name{0, line.segmentCount(), line.closed};
    for (std::uint32_t i = line.begin; i < line.begin + name.segments; ++i) {
      std::uint64_t hash = kind == SilhouetteKind::kEdges ? set.halfEdges[i] : set.faces[i];
      hash = (hash + 1) * 0x9E3779B97F4A7C15ULL;
      name.sum += hash ^ hash >> 29;
    }
    names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

struct Tally {
  std::uint64_t views = 0;
  std::uint64_t segments = 0;
  std::uint64_t lines = 0;
};

// Everything that one kind of silhouettes must hold on one mesh.
void expectNothingLost(
    const SilhouetteField& field,
    const std::vector<SilhouetteView>& views,
    bool closed,
    Tally& tally) {
  const SilhouetteKind kind = field.kind();
  const auto brute = makeDetector(DetectorMethod::kBrute, field);
  SilhouetteChainer chainer;
  for (const DetectorMethod method : {DetectorMethod::kCones, DetectorMethod::kExact}) {
    SCOPED_TRACE(detectorName(method));
    const auto detector = makeDetector(method, field);
    for (const SilhouetteView& view : views) {
      const SilhouetteResult& truth = brute->detect(view);
      const SilhouetteResult& found = detector->detect(view);
      ASSERT_EQ(sorted(found), sorted(truth));
      const std::vector<LineName> wanted = namesOf(chainer.chain(field, view, truth), kind);
      ASSERT_EQ(namesOf(chainer.chain(field, view, found), kind), wanted);
      std::uint64_t chained = 0;
      for (const LineName& line : wanted) {
        ASSERT_TRUE(line.closed || !closed);
        chained += line.segments;
      }
      ASSERT_EQ(chained, found.stats.segments);
      ++tally.views;
      tally.segments += chained;
      tally.lines += wanted.size();
    }
  }
}

// One mesh at three cuts.
Tally expectNothingLost(const corpus::Mesh& subject, int viewCount) {
  SCOPED_TRACE(subject.name);
  Tally tally;
  const auto built = buildForest(subject.mesh, {.baseFaces = 200, .threads = 1});
  EXPECT_TRUE(built) << subject.name;
  if (!built) return tally;
  const SplitForest& forest = built->forest;
  auto active = ActiveMesh::fromBase(forest.levelBegin, forest.baseMesh(), forest.baseFeatures);
  EXPECT_TRUE(active) << subject.name;
  if (!active) return tally;
  Rng rng(3);
  const std::vector<VertexId> order = randomLegalOrder(forest, rng, OrderKind::kDepthFirst);
  std::size_t applied = 0;
  for (const double share : {0.0, 0.4, 1.0}) {
    const auto end = static_cast<std::size_t>(share * static_cast<double>(order.size()));
    for (; applied < end; ++applied) {
      const auto split = active->apply(forest.split(order[applied]));
      EXPECT_TRUE(split);
      if (!split) return tally;
    }
    TriangleMesh cut{forest.grid, {}, {}};
    cut.positions.assign(active->positions().begin(), active->positions().end());
    const auto views = testing::randomViews(cut, viewCount, 42);
    for (const SilhouetteKind kind : {SilhouetteKind::kEdges, SilhouetteKind::kSmooth}) {
      const SilhouetteField field(active->mesh(), active->positions(), kind);
      expectNothingLost(field, views, subject.closed, tally);
      if (::testing::Test::HasFatalFailure()) return tally;
    }
  }
  return tally;
}

TEST(Recall, OfEdgesFacesAndLoopsIsCompleteOnEveryGoodMeshAtEveryCut) {
  const char* asked = std::getenv("LIMN_ALL_VIEWS");
  const int viewCount = asked == nullptr ? 6 : std::max(std::atoi(asked), 1);
  Tally total;
  const auto add = [&](const corpus::Mesh& subject) {
    const Tally tally = expectNothingLost(subject, viewCount);
    total.views += tally.views;
    total.segments += tally.segments;
    total.lines += tally.lines;
    if (asked == nullptr) return;
    std::printf(
        "%s: nothing lost in %llu detections, %llu segments, %llu lines\n",
        subject.name.c_str(),
        static_cast<unsigned long long>(tally.views),
        static_cast<unsigned long long>(tally.segments),
        static_cast<unsigned long long>(tally.lines));
    std::fflush(stdout);
  };
  for (const corpus::Mesh& subject : corpus::generated()) {
    add(subject);
    if (HasFatalFailure()) return;
  }
  if (corpus::modelsFolder()) {
    for (const auto& file :
         corpus::modelFiles(asked == nullptr ? corpus::Size::kSmall : corpus::Size::kAll)) {
      const corpus::Mesh* subject = corpus::model(file.filename().string());
      if (subject != nullptr) add(*subject);
      if (HasFatalFailure()) return;
    }
  }
  RecordProperty("segments", std::to_string(total.segments));
  RecordProperty("lines", std::to_string(total.lines));
  EXPECT_GT(total.lines, 0U);
}

}  // namespace
}  // namespace limn
