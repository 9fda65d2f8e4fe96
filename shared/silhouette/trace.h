// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/field.h"

#include <glm/glm.hpp>

/// Walking along silhouettes, one segment at a time, by the field's predicate alone. Front lies to
/// the left of every walk.
namespace limn {

/// The silhouette half-edge that goes on from silhouette half-edge h: the next one clockwise round
/// its target through faces that are front. One to one, so walks never merge. kNone: the front
/// sector ends at a border. Cost: O(valence).
[[nodiscard]] HalfEdgeId
nextSilhouetteEdge(const SilhouetteField& field, const glm::vec4& eye, HalfEdgeId h);

/// The inverse of nextSilhouetteEdge.
[[nodiscard]] HalfEdgeId
previousSilhouetteEdge(const SilhouetteField& field, const glm::vec4& eye, HalfEdgeId h);

/// A place on the smooth silhouette: one crossed face, the edge it is entered through (from a front
/// to a back vertex) and the one it is left through (from a back to a front vertex). Each step
/// costs one vertex value.
class SmoothWalk {
 public:
  SmoothWalk(const SilhouetteField& field, const glm::vec4& eye)
      : field_(&field),
        mesh_(&field.mesh()),
        eye_(eye) {}

  /// Puts the walk into face f. False when the silhouette does not cross it.
  bool start(FaceId f) {
    entry_ = kNone;
    exit_ = kNone;
    float values[3];
    for (std::uint32_t k = 0; k < 3; ++k)
      values[k] = valueAt(3 * f + k);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const float a = values[k];
      const float b = values[(k + 1) % 3];
      if (a > 0.0F && !(b > 0.0F)) {
        entry_ = 3 * f + k;
        entryFront_ = a;
        entryBack_ = b;
      } else if (!(a > 0.0F) && b > 0.0F) {
        exit_ = 3 * f + k;
        exitFront_ = b;
        exitBack_ = a;
      }
    }
    return entry_ != kNone;
  }

  /// Into the face across the exit. False at a border: the walk stays.
  bool advance() {
    const HalfEdgeId across = mesh_->twins[exit_];
    if (across == kNone) return false;
    entry_ = across;
    entryFront_ = exitFront_;
    entryBack_ = exitBack_;
    const HalfEdgeId before = HalfEdgeMesh::prev(across);
    const float apex = valueAt(before);
    if (apex > 0.0F) {
      exit_ = HalfEdgeMesh::next(across);
      exitFront_ = apex;
    } else {
      exit_ = before;
      exitBack_ = apex;
    }
    return true;
  }

  /// Into the face across the entry. False at a border: the walk stays.
  bool retreat() {
    const HalfEdgeId across = mesh_->twins[entry_];
    if (across == kNone) return false;
    exit_ = across;
    exitFront_ = entryFront_;
    exitBack_ = entryBack_;
    const HalfEdgeId before = HalfEdgeMesh::prev(across);
    const float apex = valueAt(before);
    if (apex > 0.0F) {
      entry_ = before;
      entryFront_ = apex;
    } else {
      entry_ = HalfEdgeMesh::next(across);
      entryBack_ = apex;
    }
    return true;
  }

  [[nodiscard]] FaceId face() const { return HalfEdgeMesh::face(exit_); }

  /// The half-edge it is left through, in this face.
  [[nodiscard]] HalfEdgeId exit() const { return exit_; }

  /// The front vertex of the edge it is left through.
  [[nodiscard]] std::uint32_t frontVertex() const { return mesh_->target(exit_); }

  /// Where the silhouette enters and leaves the face, grid units: the zero of the values' linear
  /// interpolation on the edge, always measured from the front end, so that both faces of an edge
  /// have the same point to the last bit.
  [[nodiscard]] glm::vec3 entryPoint() const {
    return crossing(mesh_->origin(entry_), entryFront_, mesh_->target(entry_), entryBack_);
  }

  [[nodiscard]] glm::vec3 exitPoint() const {
    return crossing(mesh_->target(exit_), exitFront_, mesh_->origin(exit_), exitBack_);
  }

 private:
  [[nodiscard]] float valueAt(HalfEdgeId h) const { return field_->value(mesh_->origins[h], eye_); }

  [[nodiscard]] glm::vec3
  crossing(std::uint32_t front, float frontValue, std::uint32_t back, float backValue) const {
    const glm::ivec3& p = field_->positions()[front];
    const float t = frontValue / (frontValue - backValue);
    return glm::vec3(p) + t * glm::vec3(field_->positions()[back] - p);
  }

  const SilhouetteField* field_;
  const HalfEdgeMesh* mesh_;
  glm::vec4 eye_;
  HalfEdgeId entry_ = kNone;
  HalfEdgeId exit_ = kNone;
  float entryFront_ = 0.0F;
  float entryBack_ = 0.0F;
  float exitFront_ = 0.0F;
  float exitBack_ = 0.0F;
};

}  // namespace limn
