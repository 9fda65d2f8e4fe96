// SPDX-License-Identifier: Apache-2.0
// Based on: J. Canny, "A Computational Approach to Edge Detection", PAMI 8(6), 1986 (through
// OpenCV); M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 3.2.3:
// edges of the rendered picture as hints where silhouettes are.
// Deviations: loops are known exactly here, so the picture only says which of their segments count;
// depth and normal are not rendered but follow from the face id of a pixel.
#include "server/preprocess/seeds/visible_loops.h"

#include "shared/silhouette/trace.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace limn {

GridView GridView::of(const Camera& camera, const Grid& grid) {
  GridView view;
  glm::dmat4 worldFromGrid(grid.step);
  worldFromGrid[3] = glm::dvec4(grid.origin, 1.0);
  view.clipFromGrid = camera.clipFromWorld(1.0) * worldFromGrid;
  view.silhouette = {grid.fromModel(camera.eye), camera.forward(), camera.orthographic};
  return view;
}

SilhouetteLoops traceLoops(
    const SilhouetteField& field,
    const SilhouetteView& view,
    const SilhouetteResult& found) {
  const HalfEdgeMesh& mesh = field.mesh();
  const glm::vec4 eye = field.eyeOf(view);
  SilhouetteLoops loops;
  const auto endLoop = [&] {
    const auto size = static_cast<std::uint32_t>(loops.vertices.size());
    if (size > loops.begin.back()) loops.begin.push_back(size);
  };
  if (found.kind == SilhouetteKind::kEdges) {
    std::vector<std::uint8_t> isDone(mesh.origins.size(), 0);
    for (const HalfEdgeId first : found.edges) {
      // An open line met in its middle becomes two: enough for seeds.
      for (HalfEdgeId h = first; h != kNone && isDone[h] == 0;
           h = nextSilhouetteEdge(field, eye, h)) {
        isDone[h] = 1;
        loops.vertices.push_back(mesh.origin(h));
      }
      endLoop();
    }
    return loops;
  }
  std::vector<std::uint8_t> isDone(mesh.faceCount(), 0);
  SmoothWalk walk(field, eye);
  for (const FaceId first : found.faces) {
    if (isDone[first] != 0 || !walk.start(first)) continue;
    bool isInside = true;
    while (isInside && isDone[walk.face()] == 0) {
      isDone[walk.face()] = 1;
      loops.vertices.push_back(walk.frontVertex());
      isInside = walk.advance();
    }
    endLoop();
  }
  return loops;
}

VisibilityJudge::VisibilityJudge(
    const SilhouetteField& faces,
    const GridView& view,
    const FaceImage& image,
    double radius)
    : image_(&image),
      faces_(&faces),
      view_(view),
      slack_(static_cast<float>(0.01 * radius)) {
  computeDepth(faces);
  findEdges(radius);
}

// Intersects each pixel's ray with the plane of its face, clamped to the distances of its corners:
// edge-on planes are met anywhere.
void VisibilityJudge::computeDepth(const SilhouetteField& faces) {
  const auto pixels = image_->faces.size();
  depth_.assign(pixels, 1e30F);
  shade_.assign(pixels, 0.0F);
  const glm::dmat4 gridFromClip = glm::inverse(view_.clipFromGrid);
  const glm::dvec3 eye = view_.silhouette.eye;
  const glm::vec4 relativeEye = faces.eyeOf(view_.silhouette);
  const int size = image_->size;
  // On the far plane, pixels are evenly spaced.
  const auto onFarPlane = [&](double x, double y) {
    const glm::dvec4 far =
        gridFromClip * glm::dvec4(x / size * 2.0 - 1.0, y / size * 2.0 - 1.0, 1.0, 1.0);
    return glm::dvec3(far) / far.w - eye;
  };
  const glm::vec3 corner(onFarPlane(0.5, 0.5));
  const glm::vec3 stepX(onFarPlane(1.5, 0.5) - onFarPlane(0.5, 0.5));
  const glm::vec3 stepY(onFarPlane(0.5, 1.5) - onFarPlane(0.5, 0.5));
  const glm::vec3 gridEye(eye);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const FaceId f = image_->at(x, y);
      if (f == kNone) continue;
      const glm::vec3 ray =
          glm::normalize(corner + static_cast<float>(x) * stepX + static_cast<float>(y) * stepY);
      const glm::vec4& plane = faces.plane(f);
      const float slope = glm::dot(glm::vec3(plane), ray);
      const float length = glm::length(glm::vec3(plane));
      float nearest = 1e30F;
      float farthest = 0.0F;
      const glm::uvec3& t = faces.mesh().triangles()[f];
      for (int k = 0; k < 3; ++k) {
        const float distance = glm::length(glm::vec3(faces.positions()[t[k]]) - gridEye);
        nearest = std::min(nearest, distance);
        farthest = std::max(farthest, distance);
      }
      const float hit =
          slope != 0.0F ? -SilhouetteField::valueAt(plane, relativeEye) / slope : nearest;
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(size) +
                     static_cast<std::size_t>(x);
      depth_[i] = std::clamp(hit, nearest, farthest);
      shade_[i] = length > 0.0F ? std::abs(slope) / length : 0.0F;
    }
  }
}

void VisibilityJudge::findEdges(double radius) {
  const int size = image_->size;
  cv::Mat shade(size, size, CV_8U, cv::Scalar(0));
  cv::Mat depth(size, size, CV_8U, cv::Scalar(255));
  float nearest = 1e30F;
  for (const float d : depth_)
    nearest = std::min(nearest, d);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (image_->at(x, y) == kNone) continue;
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(size) +
                     static_cast<std::size_t>(x);
      shade.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(40.0F + 200.0F * shade_[i]);
      const float share = (depth_[i] - nearest) / static_cast<float>(2.0 * radius);
      depth.at<std::uint8_t>(y, x) =
          static_cast<std::uint8_t>(std::clamp(200.0F * share, 0.0F, 200.0F));
    }
  }
  cv::Mat shadeEdges;
  cv::Mat depthEdges;
  cv::Canny(shade, shadeEdges, 60.0, 150.0);
  cv::Canny(depth, depthEdges, 10.0, 30.0);
  cv::Mat edges;
  cv::dilate(shadeEdges | depthEdges, edges, cv::Mat());
  isEdge_.assign(edges.begin<std::uint8_t>(), edges.end<std::uint8_t>());
}

Seen VisibilityJudge::judge(VertexId v, glm::vec2& pixel) const {
  const glm::dvec3 point(faces_->positions()[v]);
  const glm::dvec4 clip = view_.clipFromGrid * glm::dvec4(point, 1.0);
  const int size = image_->size;
  pixel = glm::vec2((glm::dvec2(clip) / clip.w * 0.5 + 0.5) * static_cast<double>(size));
  const auto px = static_cast<int>(std::floor(pixel.x));
  const auto py = static_cast<int>(std::floor(pixel.y));
  const auto distance = static_cast<float>(glm::length(point - view_.silhouette.eye));
  bool isVisible = false;
  for (int y = std::max(py - 1, 0); y <= std::min(py + 1, size - 1); ++y) {
    for (int x = std::max(px - 1, 0); x <= std::min(px + 1, size - 1); ++x) {
      isVisible |= depthAt(x, y) >= distance - slack_;
    }
  }
  if (!isVisible) return Seen::kHidden;
  const auto i =
      static_cast<std::size_t>(py) * static_cast<std::size_t>(size) + static_cast<std::size_t>(px);
  return i < isEdge_.size() && isEdge_[i] != 0 ? Seen::kConfirmed : Seen::kVisible;
}

}  // namespace limn
