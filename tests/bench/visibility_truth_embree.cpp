// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/visibility_truth.h"

#include <embree3/rtcore.h>

#include <algorithm>

namespace limn {
namespace {

/// Embree hands the context it was given to the filter: ours says which faces to look past.
struct Context {
  RTCIntersectContext embree;
  FaceId own[2];
};

void lookPastOwnFaces(const RTCFilterFunctionNArguments* arguments) {
  const auto* context = reinterpret_cast<const Context*>(arguments->context);
  const unsigned face = RTCHitN_primID(arguments->hit, arguments->N, 0);
  if (face == context->own[0] || face == context->own[1]) arguments->valid[0] = 0;
}

class EmbreeTruth final : public VisibilityTruth {
 public:
  EmbreeTruth(const HalfEdgeMesh& mesh, std::span<const glm::ivec3> positions)
      : mesh_(mesh),
        positions_(positions),
        device_(rtcNewDevice("threads=1")),
        scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(
        scene_,
        static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
        geometry,
        RTC_BUFFER_TYPE_VERTEX,
        0,
        RTC_FORMAT_FLOAT3,
        sizeof(glm::vec3),
        positions.size()));
    for (std::size_t i = 0; i < positions.size(); ++i)
      vertices[i] = glm::vec3(positions[i]);
    auto* faces = static_cast<glm::uvec3*>(rtcSetNewGeometryBuffer(
        geometry,
        RTC_BUFFER_TYPE_INDEX,
        0,
        RTC_FORMAT_UINT3,
        sizeof(glm::uvec3),
        mesh.faceCount()));
    const auto triangles = mesh.triangles();
    std::copy(triangles.begin(), triangles.end(), faces);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }

  ~EmbreeTruth() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  [[nodiscard]] bool isVisible(HalfEdgeId h, const glm::dvec3& eye) const override {
    const glm::dvec3 middle =
        0.5 * (glm::dvec3(positions_[mesh_.origin(h)]) + glm::dvec3(positions_[mesh_.target(h)]));
    const glm::dvec3 d = eye - middle;
    Context context{};
    rtcInitIntersectContext(&context.embree);
    context.embree.filter = lookPastOwnFaces;
    context.own[0] = HalfEdgeMesh::face(h);
    const HalfEdgeId twin = mesh_.twin(h);
    context.own[1] = twin == kNone ? kNone : HalfEdgeMesh::face(twin);
    RTCRay ray{};
    ray.org_x = static_cast<float>(middle.x);
    ray.org_y = static_cast<float>(middle.y);
    ray.org_z = static_cast<float>(middle.z);
    ray.dir_x = static_cast<float>(d.x);
    ray.dir_y = static_cast<float>(d.y);
    ray.dir_z = static_cast<float>(d.z);
    ray.tnear = 0.0F;
    ray.tfar = 1.0F;
    ray.mask = ~0U;
    rtcOccluded1(scene_, &context.embree, &ray);
    return ray.tfar >= 0.0F;
  }

 private:
  const HalfEdgeMesh& mesh_;
  std::span<const glm::ivec3> positions_;
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace

std::unique_ptr<VisibilityTruth> VisibilityTruth::create(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions) {
  return std::make_unique<EmbreeTruth>(mesh, positions);
}

}  // namespace limn
