// SPDX-License-Identifier: Apache-2.0
// Based on: L. Markosian et al., "Real-Time Nonphotorealistic Rendering", SIGGRAPH 1997 (tracing
// silhouettes from seeds through adjacent faces).
#include "shared/silhouette/trace.h"

namespace limn {

HalfEdgeId nextSilhouetteEdge(const SilhouetteField& field, const glm::vec4& eye, HalfEdgeId h) {
  const HalfEdgeMesh& mesh = field.mesh();
  HalfEdgeId g = HalfEdgeMesh::next(h);
  for (;;) {
    const HalfEdgeId across = mesh.twins[g];
    if (across == kNone) return kNone;
    if (!field.isFront(HalfEdgeMesh::face(across), eye)) return g;
    g = HalfEdgeMesh::next(across);  // the turn ends at h's own back face at the latest
  }
}

HalfEdgeId
previousSilhouetteEdge(const SilhouetteField& field, const glm::vec4& eye, HalfEdgeId h) {
  const HalfEdgeMesh& mesh = field.mesh();
  HalfEdgeId g = HalfEdgeMesh::prev(h);
  for (;;) {
    const HalfEdgeId across = mesh.twins[g];
    if (across == kNone) return kNone;
    if (!field.isFront(HalfEdgeMesh::face(across), eye)) return g;
    g = HalfEdgeMesh::prev(across);
  }
}

}  // namespace limn
