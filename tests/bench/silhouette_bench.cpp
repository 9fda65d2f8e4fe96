// SPDX-License-Identifier: Apache-2.0
// Detection and chaining, timed against brute force and against the loop that everyone writes
// first, in the same run on the same views. One thread.
#include "client/stroke/chain.h"
#include "tests/corpus/corpus.h"
#include "tests/property/shared/silhouette/views.h"

#include "shared/mesh/primitives.h"
#include "shared/silhouette/detector.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Mean over the views, best of a few rounds.
template <class Work>
double timePerView(const std::vector<SilhouetteView>& views, int rounds, Work work) {
  double best = 1e30;
  for (int round = 0; round < rounds; ++round) {
    const auto start = Clock::now();
    for (const SilhouetteView& view : views)
      work(view);
    best = std::min(best, millisecondsSince(start) / static_cast<double>(views.size()));
  }
  return best;
}

// Faces, vertices and edges as structs, one at a time: the classic.
class ClassicDetector {
 public:
  explicit ClassicDetector(const SilhouetteField& field) : field_(&field) {
    const HalfEdgeMesh& mesh = field.mesh();
    for (const glm::vec4& plane : field.planes())
      sites_.push_back({plane, 0.0F});
    for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
      if (mesh.twins[h] != kNone && h < mesh.twins[h]) {
        edges_.push_back({HalfEdgeMesh::face(h), HalfEdgeMesh::face(mesh.twins[h]), h});
      }
    }
  }

  std::size_t detect(const SilhouetteView& view) {
    const glm::vec4 eye = field_->eyeOf(view);
    for (Site& site : sites_)
      site.value = glm::dot(site.plane, eye);
    found_.clear();
    if (field_->kind() == SilhouetteKind::kEdges) {
      for (const Edge& edge : edges_) {
        if ((sites_[edge.a].value > 0.0F) != (sites_[edge.b].value > 0.0F)) {
          found_.push_back(edge.h);
        }
      }
    } else {
      const auto triangles = field_->mesh().triangles();
      for (FaceId f = 0; f < triangles.size(); ++f) {
        const bool a = sites_[triangles[f].x].value > 0.0F;
        if ((sites_[triangles[f].y].value > 0.0F) != a ||
            (sites_[triangles[f].z].value > 0.0F) != a) {
          found_.push_back(f);
        }
      }
    }
    return found_.size();
  }

 private:
  struct Site {
    glm::vec4 plane;
    float value;
  };

  struct Edge {
    FaceId a;
    FaceId b;
    HalfEdgeId h;
  };

  const SilhouetteField* field_;
  std::vector<Site> sites_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> found_;
};

void row(
    const char* what,
    const std::string& mesh,
    double ms,
    double reference,
    double target,
    const char* note) {
  const double ratio = reference / ms;
  std::printf("%-26s %-20s %10.4f ms %10.4f ms  x%-7.2f", what, mesh.c_str(), ms, reference, ratio);
  if (target > 0.0) {
    std::printf("  x%-5.1f %-4s", target, ratio >= target ? "met" : "NOT");
  } else {
    std::printf("  %-11s", "-");
  }
  std::printf("  %s\n", note);
}

// Speed-ups over brute force to reach, by size of the mesh.
double conesTarget(std::size_t faces, SilhouetteKind kind) {
  if (kind == SilhouetteKind::kSmooth && faces > 900'000) return 10.0;
  if (faces > 800'000) return 3.0;
  return faces > 150'000 ? 5.0 : 4.0;
}

void benchMesh(const std::string& name, const TriangleMesh& shape, int viewCount) {
  const auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
  if (!mesh) {
    std::printf("%s: %s\n", name.c_str(), mesh.error().message.c_str());
    return;
  }
  const auto views = testing::randomViews(shape, viewCount, 1);
  for (const SilhouetteKind kind : {SilhouetteKind::kEdges, SilhouetteKind::kSmooth}) {
    const std::string kindName = kind == SilhouetteKind::kEdges ? "edges" : "smooth";
    auto start = Clock::now();
    const SilhouetteField field(*mesh, shape.positions, kind);
    const double fieldMs = millisecondsSince(start);
    start = Clock::now();
    const auto cones = makeDetector(DetectorMethod::kCones, field);
    const double buildMs = millisecondsSince(start);
    const auto brute = makeDetector(DetectorMethod::kBrute, field);
    ClassicDetector classic(field);
    SilhouetteChainer chainer;

    std::size_t segments = 0;
    for (const SilhouetteView& view : views) {
      segments += brute->detect(view).stats.segments;
      if (cones->detect(view).stats.segments != brute->detect(view).stats.segments) {
        std::printf("%s: cones and brute force disagree\n", name.c_str());
      }
    }
    const double perView = static_cast<double>(segments) / static_cast<double>(views.size());
    std::size_t sink = 0;
    constexpr int kRounds = 5;
    const double classicMs =
        timePerView(views, kRounds, [&](const auto& v) { sink += classic.detect(v); });
    const double bruteMs =
        timePerView(views, kRounds, [&](const auto& v) { sink += brute->detect(v).edges.size(); });
    const double conesMs =
        timePerView(views, kRounds, [&](const auto& v) { sink += cones->detect(v).edges.size(); });
    const double allMs = timePerView(views, kRounds, [&](const auto& v) {
      sink += chainer.chain(field, v, cones->detect(v)).points.size();
    });
    char note[160];
    std::snprintf(
        note,
        sizeof note,
        "vs scalar; %u faces, %.0f segments a view",
        mesh->faceCount(),
        perView);
    row(("brute, " + kindName).c_str(), name, bruteMs, classicMs, 0.0, note);
    std::snprintf(
        note,
        sizeof note,
        "vs brute (x%.1f vs scalar); build %.0f + %.0f ms, %.0f B a face",
        classicMs / conesMs,
        fieldMs,
        buildMs,
        static_cast<double>(cones->memoryBytes()) / mesh->faceCount());
    row(("cones, " + kindName).c_str(),
        name,
        conesMs,
        bruteMs,
        conesTarget(mesh->faceCount(), kind),
        note);
    std::snprintf(
        note,
        sizeof note,
        "vs brute alone; chaining %.0f ns a segment%s",
        (allMs - conesMs) * 1e6 / perView,
        sink == 0 ? " (nothing found)" : "");
    row(("cones + chain, " + kindName).c_str(), name, allMs, bruteMs, 0.0, note);
  }
}

int run(int argc, char** argv) {
  const bool isQuick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
  const int viewCount = isQuick ? 20 : 100;
  std::printf(
      "%-26s %-20s %13s %13s  %-8s  %-6s %-4s\n",
      "row",
      "mesh",
      "ours",
      "reference",
      "ratio",
      "target",
      "");
  for (const char* file : {"bunny-closed.ply", "turbine-blade.ply", "dragon.ply"}) {
    if (isQuick && std::strcmp(file, "bunny-closed.ply") != 0) continue;
    if (const corpus::Mesh* mesh = corpus::model(file))
      benchMesh(mesh->name, mesh->mesh, viewCount);
  }
  benchMesh("knot, 69,632 faces", primitives::torusKnot(2, 3, 544, 64), viewCount);
  if (!isQuick) benchMesh("knot, 1 M faces", primitives::torusKnot(2, 3, 4000, 125), viewCount);
  return 0;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(argc, argv);
}
