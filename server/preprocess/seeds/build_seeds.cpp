// SPDX-License-Identifier: Apache-2.0
// Based on: M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 3.2.4
// (silhouettes of a grid of viewpoints, kept as seeds).
// Deviations: a few vertices a loop are kept instead of every face, ranked by what is seen of the
// loop; the viewpoints' grid is in azimuth and elevation, and denser where, half-way between them,
// a client would find least.
#include "server/preprocess/seeds/build_seeds.h"

#include "server/preprocess/seeds/face_image.h"
#include "server/preprocess/seeds/viewpoint_grid.h"
#include "server/preprocess/seeds/visible_loops.h"

#include "shared/core/camera.h"
#include "shared/gl/osmesa_context.h"
#include "shared/mesh/half_edge.h"
#include "shared/silhouette/detector.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace limn {
namespace {

// Visible pixels from which a loop gets all its seeds, and from which it gets two.
constexpr double kLongPx = 40.0;
constexpr double kMediumPx = 10.0;
// Up to so many faces, all extra viewpoints.
constexpr double kFacesForAllExtra = 100'000.0;
// Longer than this in the picture is no segment but a jump past a border.
constexpr float kLongestSegmentPx = 64.0F;

// The part of a loop that seeds may be taken from.
struct RankedLoop {
  double seenPx = 0.0;  // visible length; confirmed parts count twice
  std::size_t segments = 0;
  std::vector<VertexId> vertices;  // confirmed ones, else visible ones, else all
};

RankedLoop rank(std::span<const VertexId> segments, const VisibilityJudge& judge) {
  RankedLoop loop;
  loop.segments = segments.size();
  std::vector<VertexId> visible;
  std::vector<VertexId> confirmed;
  std::optional<glm::vec2> last;
  for (const VertexId v : segments) {
    glm::vec2 pixel(0.0F);
    const Seen seen = judge.judge(v, pixel);
    if (seen != Seen::kHidden) {
      visible.push_back(v);
      const float length = last ? std::min(glm::length(pixel - *last), kLongestSegmentPx) : 0.0F;
      loop.seenPx += length;
      if (seen == Seen::kConfirmed) {
        loop.seenPx += length;
        confirmed.push_back(v);
      }
    }
    last = pixel;
  }
  if (!confirmed.empty()) {
    loop.vertices = std::move(confirmed);
  } else if (!visible.empty()) {
    loop.vertices = std::move(visible);
  } else {
    loop.vertices.assign(segments.begin(), segments.end());
  }
  return loop;
}

std::uint32_t seedsOf(const RankedLoop& loop, const SeedOptions& options) {
  if (loop.seenPx >= kLongPx) return std::max(options.seedsPerLoop, 1U);
  return loop.seenPx >= kMediumPx ? std::min(options.seedsPerLoop, 2U) : 1U;
}

// The seeds of all loops, the most visible loop's first, without repeats.
std::vector<VertexId> chooseSeeds(std::vector<RankedLoop> loops, const SeedOptions& options) {
  std::stable_sort(loops.begin(), loops.end(), [](const RankedLoop& a, const RankedLoop& b) {
    return a.seenPx != b.seenPx ? a.seenPx > b.seenPx : a.segments > b.segments;
  });
  std::vector<VertexId> seeds;
  for (const RankedLoop& loop : loops) {
    const std::uint32_t count = seedsOf(loop, options);
    for (std::uint32_t i = 0; i < count && seeds.size() < options.seedsPerView; ++i) {
      const VertexId v = loop.vertices[(2 * i + 1) * loop.vertices.size() / (2 * count)];
      if (std::find(seeds.begin(), seeds.end(), v) == seeds.end()) seeds.push_back(v);
    }
  }
  return seeds;
}

// What `all` has and `some` has not; whole loops, for a loop is found whole.
SilhouetteResult difference(const SilhouetteResult& all, const SilhouetteResult& some) {
  SilhouetteResult rest;
  rest.kind = all.kind;
  const auto subtract = [](std::vector<std::uint32_t> from, std::vector<std::uint32_t> what) {
    std::sort(from.begin(), from.end());
    std::sort(what.begin(), what.end());
    std::vector<std::uint32_t> left;
    std::set_difference(
        from.begin(),
        from.end(),
        what.begin(),
        what.end(),
        std::back_inserter(left));
    return left;
  };
  rest.edges = subtract(all.edges, some.edges);
  rest.faces = subtract(all.faces, some.faces);
  return rest;
}

// Both kinds of silhouettes of one mesh.
class SeedFinder {
 public:
  SeedFinder(const HalfEdgeMesh& mesh, std::span<const glm::ivec3> positions, double radius)
      : radius_(radius),
        edges_(mesh, positions, SilhouetteKind::kEdges),
        smooth_(mesh, positions, SilhouetteKind::kSmooth),
        edgeDetector_(makeDetector(DetectorMethod::kBrute, edges_)),
        smoothDetector_(makeDetector(DetectorMethod::kBrute, smooth_)) {}

  /// Seeds of the loops seen from there; of those that the seeds `known` do not lead to.
  std::vector<VertexId> find(
      const GridView& view,
      const FaceImage& image,
      const SeedTable& known,
      const SeedOptions& options) {
    const VisibilityJudge judge(edges_, view, image, radius_);
    std::vector<RankedLoop> ranked;
    const auto add = [&](const SilhouetteField& field, SilhouetteDetector& detector) {
      const SilhouetteResult missing =
          difference(detector.detect(view.silhouette), detectFrom(known, field, view.silhouette));
      const auto loops = traceLoops(field, view.silhouette, missing);
      const std::span<const VertexId> all = loops.vertices;
      for (std::size_t l = 0; l < loops.count(); ++l) {
        ranked.push_back(
            rank(all.subspan(loops.begin[l], loops.begin[l + 1] - loops.begin[l]), judge));
      }
    };
    add(smooth_, *smoothDetector_);
    add(edges_, *edgeDetector_);
    return chooseSeeds(std::move(ranked), options);
  }

  /// The share of both kinds' silhouettes that a client with these seeds and everything refined
  /// would not find from there.
  double lossAt(const SilhouetteView& view, const SeedTable& seeds) {
    const auto recallOf = [&](const SilhouetteField& field, SilhouetteDetector& truth) {
      return recall(detectFrom(seeds, field, view), truth.detect(view));
    };
    return 1.0 - 0.5 * (recallOf(smooth_, *smoothDetector_) + recallOf(edges_, *edgeDetector_));
  }

 private:
  static SilhouetteResult
  detectFrom(const SeedTable& seeds, const SilhouetteField& field, const SilhouetteView& view) {
    DetectorOptions options;
    options.seeds = &seeds;
    return makeDetector(DetectorMethod::kPrecomputed, field, options)->detect(view);
  }

  double radius_;  // of the mesh, grid units
  SilhouetteField edges_;
  SilhouetteField smooth_;
  // Brute force: for forty views, building anything better costs more than it saves.
  std::unique_ptr<SilhouetteDetector> edgeDetector_;
  std::unique_ptr<SilhouetteDetector> smoothDetector_;
};

// Seeds and their ancestors as nodes, by id.
SeedTable makeTable(
    const std::vector<glm::vec3>& directions,
    const std::vector<std::vector<VertexId>>& seedsOfViews,
    std::span<const VertexId> parents,
    std::uint32_t baseVertexCount) {
  SeedTable table;
  table.directions = directions;
  std::vector<VertexId> ids;
  for (const std::vector<VertexId>& seeds : seedsOfViews) {
    for (VertexId v : seeds) {
      ids.push_back(v);
      for (; v >= baseVertexCount; ids.push_back(v))
        v = parents[v - baseVertexCount];
    }
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  const auto nodeOf = [&](VertexId v) {
    return static_cast<std::uint32_t>(std::lower_bound(ids.begin(), ids.end(), v) - ids.begin());
  };
  for (const VertexId v : ids) {
    table.nodes.push_back({v, v < baseVertexCount ? kNone : nodeOf(parents[v - baseVertexCount])});
  }
  table.seedBegin.push_back(0);
  for (const std::vector<VertexId>& seeds : seedsOfViews) {
    for (const VertexId v : seeds)
      table.seeds.push_back(nodeOf(v));
    table.seedBegin.push_back(static_cast<std::uint32_t>(table.seeds.size()));
  }
  return table;
}

Result<void> checkArguments(
    const TriangleMesh& mesh,
    std::span<const VertexId> parents,
    std::uint32_t baseVertexCount,
    const SeedOptions& options) {
  if (options.azimuths < 1 || options.elevations < 1 || options.imageSize < 16) {
    return fail(
        ErrorCode::kInvalidArgument,
        "seeds need at least 1x1 viewpoints and pictures of 16 pixels");
  }
  if (baseVertexCount > mesh.positions.size() ||
      parents.size() != mesh.positions.size() - baseVertexCount) {
    return fail(ErrorCode::kInvalidArgument, "seeds need the parent of every split of the mesh");
  }
  for (std::size_t i = 0; i < parents.size(); ++i) {
    if (parents[i] >= baseVertexCount + i) {
      return fail(ErrorCode::kInvalidArgument, "a split's parent must come before it");
    }
  }
  return {};
}

}  // namespace

Result<SeedTable> buildSeeds(
    const TriangleMesh& mesh,
    std::span<const VertexId> parents,
    std::uint32_t baseVertexCount,
    const SeedOptions& options) {
  if (auto valid = checkArguments(mesh, parents, baseVertexCount, options); !valid) {
    return tl::unexpected(valid.error());
  }
  if (mesh.triangles.empty()) return SeedTable{};
  const auto linked =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  if (!linked) return tl::unexpected(linked.error().within("seeds"));
  const bool isClosed =
      std::find(linked->twins.begin(), linked->twins.end(), kNone) == linked->twins.end();
  const BackFaces backFaces = isClosed ? BackFaces::kLeftOut : BackFaces::kDrawn;
  const auto context = createOsmesaContext();
  if (!context) return tl::unexpected(context.error().within("seeds"));
  const auto renderer = FaceImageRenderer::create(**context, mesh, options.imageSize, backFaces);
  if (!renderer) return tl::unexpected(renderer.error().within("seeds"));

  const BoundingSphere sphere = boundingSphere(mesh.grid, mesh.positions);
  SeedFinder finder(*linked, mesh.positions, sphere.radius / mesh.grid.step);
  const auto cameraAt = [&](const Viewpoint& at) {
    Camera camera = orbitCamera(sphere, at.azimuth, at.elevation, options.distanceRadii);
    fitDepthRange(sphere, camera);
    return camera;
  };
  std::vector<glm::vec3> directions;
  std::vector<std::vector<VertexId>> seeds;
  const auto add = [&](const Viewpoint& at, const SeedTable& known) {
    const Camera camera = cameraAt(at);
    directions.emplace_back(-camera.forward());
    const GridView view = GridView::of(camera, mesh.grid);
    const FaceImage image = renderer->render(view.clipFromGrid);
    seeds.push_back(finder.find(view, image, known, options));
  };
  const std::vector<Viewpoint> grid = viewpointGrid(options.azimuths, options.elevations);
  for (const Viewpoint& at : grid)
    add(at, {});
  const double share =
      options.extraViewpoints *
      std::min(1.0, kFacesForAllExtra / static_cast<double>(mesh.triangles.size()));
  const auto tableSoFar = [&] { return makeTable(directions, seeds, parents, baseVertexCount); };
  const auto lossAt = [&](const Viewpoint& at) {
    return finder.lossAt(GridView::of(cameraAt(at), mesh.grid).silhouette, tableSoFar());
  };
  densify(
      options.azimuths,
      options.elevations,
      {.most = static_cast<std::uint32_t>(share * static_cast<double>(grid.size()))},
      lossAt,
      [&](const Viewpoint& at) { add(at, tableSoFar()); });
  return tableSoFar();
}

}  // namespace limn
