// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/detector.h"

#include <cstdint>
#include <vector>

namespace limn {

/// Picks up silhouettes at single faces and follows them, each segment once a frame: what every
/// seeded detector does after choosing its seeds. Threads: one caller at a time.
class SilhouetteTracer {
 public:
  explicit SilhouetteTracer(const SilhouetteField& field);

  /// Starts a frame without segments.
  void begin(const SilhouetteView& view);

  /// Whether this is the first visit to face f in this frame; counts it.
  bool visit(FaceId f);

  /// Adds the segments of face f without following them. False when it has none.
  bool take(FaceId f);

  /// Adds the segments of face f and all they lead to. False when it has none.
  bool follow(FaceId f);

  /// Walks from a vertex (or face) downhill in |normal · view| to a silhouette, at most `steps`
  /// sites, and follows it. False when none was met.
  bool walkFromVertex(std::uint32_t vertex, int steps);
  bool walkFromFace(FaceId face, int steps);

  /// Takes or follows faces around f, up to `rings` faces away, that were not visited yet.
  /// before: an earlier eye; then only edges that the silhouette can have crossed since are
  /// crossed: those with a site that changed sides.
  enum class Found : std::uint8_t { kTaken, kFollowed };
  void searchAround(FaceId f, int rings, Found found, const glm::vec4* before = nullptr);

  /// Adds a complete result of another detector of the same field and view.
  void adopt(const SilhouetteResult& complete);

  /// Whether face f holds a segment found in this frame (kEdges: as its front face).
  [[nodiscard]] bool holdsSegment(FaceId f) const {
    return marks_[f] >> kMarkBits == frame_ && (marks_[f] & kSegmentBits) != 0;
  }

  /// The face of segment i of the result.
  [[nodiscard]] FaceId faceOf(std::size_t i) const {
    return result_.kind == SilhouetteKind::kEdges ? HalfEdgeMesh::face(result_.edges[i])
                                                  : result_.faces[i];
  }

  [[nodiscard]] std::size_t segmentCount() const {
    return result_.edges.size() + result_.faces.size();
  }

  [[nodiscard]] const glm::vec4& eye() const { return eye_; }

  [[nodiscard]] DetectionStats& stats() { return result_.stats; }

  /// Ends the frame. Valid until the next begin().
  [[nodiscard]] const SilhouetteResult& finish();

  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  static constexpr std::uint32_t kMarkBits = 4;
  static constexpr std::uint32_t kSegmentBits = 7;  // kEdges: one a half-edge; kSmooth: the first
  static constexpr std::uint32_t kVisitedBit = 3;

  bool mark(FaceId f, std::uint32_t bit);
  bool addEdgesOf(FaceId f, Found found);
  bool addFace(FaceId f, Found found);
  void followEdges(HalfEdgeId first);
  void followSmooth(FaceId first);
  [[nodiscard]] bool hasTurned(HalfEdgeId h, const glm::vec4& before) const;

  const SilhouetteField* field_;
  glm::vec4 eye_{0.0F};
  std::uint32_t frame_ = 0;
  std::vector<std::uint32_t> marks_;  // by face: the frame, above kMarkBits bits
  std::vector<std::uint32_t> path_;   // sites of the present walk
  std::vector<FaceId> ring_;
  std::vector<FaceId> nextRing_;
  SilhouetteResult result_;
};

/// A detector that finds what its seeds lead to: measure it with recall().
class SeededDetector : public SilhouetteDetector {
 public:
  [[nodiscard]] const SilhouetteResult& detect(const SilhouetteView& view) final {
    tracer_.begin(view);
    search(view);
    return tracer_.finish();
  }

 protected:
  explicit SeededDetector(const SilhouetteField& field) : field_(&field), tracer_(field) {}

  [[nodiscard]] const SilhouetteField& field() const { return *field_; }

  [[nodiscard]] SilhouetteTracer& tracer() { return tracer_; }

  [[nodiscard]] std::size_t tracerBytes() const { return tracer_.memoryBytes(); }

 private:
  /// Finds what there is to find of this frame with tracer().
  virtual void search(const SilhouetteView& view) = 0;

  const SilhouetteField* field_;
  SilhouetteTracer tracer_;
};

}  // namespace limn
