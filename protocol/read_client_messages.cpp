// SPDX-License-Identifier: Apache-2.0
#include "protocol/limits.h"
#include "protocol/message_fields.h"
#include "protocol/read_messages.h"
#include "protocol/text.h"

#include <cmath>

namespace limn::protocol {
namespace {

Result<Body> read(const wire::Hello& m) {
  if (!isText(view(m.client()), limits::kMaxNameBytes)) return bad("Hello.client is no short text");
  return Hello{m.version(), view(m.client())};
}

Result<Body> read(const wire::GetCatalogue&) {
  return GetCatalogue{};
}

Result<Body> read(const wire::Open& m) {
  if (!isValidModelName(view(m.model()))) return bad("Open.model is no model name");
  return Open{m.channel(), view(m.model()), m.resume()};
}

Result<Body> read(const wire::HaveSet& m) {
  const auto asset = digest(view(m.asset()));
  if (!asset) return bad("HaveSet.asset is not 32 bytes");
  const Bytes bits = view(m.bits());
  if (bits.size() > limits::kMaxHaveSetPieceBytes) return tooLarge("HaveSet.bits");
  if (m.first() % 8 != 0) return bad("HaveSet.first is not a multiple of 8");
  if (m.first() / 8 + std::uint64_t{bits.size()} > (limits::kMaxVertices + 7ULL) / 8) {
    return tooLarge("HaveSet goes past the largest vertex id");
  }
  if (m.seeds() > limits::kMaxSeedBytes) return tooLarge("HaveSet.seeds");
  return HaveSet{m.channel(), *asset, m.base(), m.first(), bits, m.last(), m.seeds()};
}

Result<Body> read(const wire::Pose& m) {
  Pose pose;
  pose.channel = m.channel();
  pose.id = m.id();
  pose.eye = toGlm(*m.eye());
  pose.forward = toGlm(*m.forward());
  pose.up = toGlm(*m.up());
  pose.fovY = m.fov_y();
  pose.orthoHeight = m.ortho_height();
  pose.width = m.width();
  pose.height = m.height();
  pose.errorPx = m.error_px();
  pose.silhouette = m.silhouette();
  pose.goal = m.goal();
  pose.maxSplits = m.max_splits();
  if (!finite(pose.eye) || !finite(pose.forward) || !finite(pose.up)) {
    return bad("Pose has a number that is not finite");
  }
  // Lengths first: a cross product of huge or tiny vectors could overflow or vanish by itself.
  const double forwardLength = glm::length(pose.forward);
  const double upLength = glm::length(pose.up);
  if (!(forwardLength > 1e-100 && forwardLength < 1e100 && upLength > 1e-100 && upLength < 1e100)) {
    return bad("Pose.forward or Pose.up has no usable length");
  }
  const double sine = glm::length(glm::cross(pose.forward / forwardLength, pose.up / upLength));
  if (!(sine > 1e-9)) return bad("Pose.forward and Pose.up are parallel");
  if (!(pose.fovY > 0.0F && pose.fovY < 3.14159F)) return bad("Pose.fov_y is not between 0 and pi");
  if (!(pose.orthoHeight >= 0.0) || !std::isfinite(pose.orthoHeight)) {
    return bad("Pose.ortho_height is negative or not finite");
  }
  if (pose.width < 1 || pose.width > limits::kMaxViewportPixels || pose.height < 1 ||
      pose.height > limits::kMaxViewportPixels) {
    return bad("Pose viewport is not 1 to 16384 pixels");
  }
  if (!(pose.errorPx >= limits::kMinErrorPx && pose.errorPx <= limits::kMaxErrorPx)) {
    return bad("Pose.error_px is not 0.1 to 64");
  }
  if (pose.silhouette > Silhouette::MAX) return bad("Pose.silhouette is unknown");
  if (pose.goal > Goal::MAX) return bad("Pose.goal is unknown");
  return pose;
}

Result<Body> read(const wire::Acknowledge& m) {
  return Acknowledge{m.bytes()};
}

Result<Body> read(const wire::Drop& m) {
  return Drop{m.channel(), view(m.ids())};
}

Result<Body> read(const wire::GetHull& m) {
  if (m.side() > HullSide::MAX) return bad("GetHull.side is unknown");
  if (m.faces() > limits::kMaxHullFaces) return tooLarge("GetHull.faces");
  if (m.held() > limits::kMaxHullPieces) return tooLarge("GetHull.held");
  return GetHull{m.channel(), m.side(), m.faces(), m.held()};
}

Result<Body> read(const wire::GetContour& m) {
  const GetContour request{
      m.channel(),
      m.id(),
      toGlm(*m.eye()),
      toGlm(*m.forward()),
      m.orthographic(),
      m.silhouette()};
  if (!finite(request.eye) || !finite(request.forward)) {
    return bad("GetContour has a number that is not finite");
  }
  const double length = glm::length(request.forward);
  if (!(length > 1e-100 && length < 1e100)) return bad("GetContour.forward has no usable length");
  if (request.silhouette > Silhouette::MAX) return bad("GetContour.silhouette is unknown");
  return request;
}

Result<Body> read(const wire::GetMap& m) {
  if (m.kind() > MapKind::MAX) return bad("GetMap.kind is unknown");
  if (m.held() > limits::kMaxMapPieces) return tooLarge("GetMap.held");
  return GetMap{m.channel(), m.kind(), m.held()};
}

}  // namespace

Result<Body> readClientMessage(const wire::Message& m) {
  switch (m.body_type()) {
    case wire::Body::Hello:
      return read(*m.body_as_Hello());
    case wire::Body::GetCatalogue:
      return read(*m.body_as_GetCatalogue());
    case wire::Body::Open:
      return read(*m.body_as_Open());
    case wire::Body::HaveSet:
      return read(*m.body_as_HaveSet());
    case wire::Body::Pose:
      return read(*m.body_as_Pose());
    case wire::Body::Acknowledge:
      return read(*m.body_as_Acknowledge());
    case wire::Body::Drop:
      return read(*m.body_as_Drop());
    case wire::Body::GetHull:
      return read(*m.body_as_GetHull());
    case wire::Body::GetContour:
      return read(*m.body_as_GetContour());
    case wire::Body::GetMap:
      return read(*m.body_as_GetMap());
    default:
      return refuse(m.body_type());
  }
}

}  // namespace limn::protocol
