// SPDX-License-Identifier: Apache-2.0
#include "client/core/eviction.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace limn {
namespace {

/// Bytes of ActiveMesh a vertex of a closed mesh: six half-edges and what is kept by vertex.
constexpr std::uint64_t kBytesPerVertex = 6 * 9 + 25;
/// … and of its history, where vertices move.
constexpr std::uint64_t kBytesPerHistory = 20;
/// Of the slot table, by thousands of ids, however few of them are held.
constexpr std::uint64_t kBytesPerPage = 1024 * 4 + 48;
constexpr std::uint64_t kCopies = 3;
constexpr std::uint64_t kUsefulSplits = 256;

constexpr double kRememberDegrees = 4.0;  // views closer than this count as one
constexpr double kNearSine = 0.35;        // how far a face may be from edge-on and still be near
constexpr double kFrameMargin = 1.15;

/// How much a view makes of a vertex, least first.
enum Use : std::uint8_t { kOutOfFrame = 0, kFacesAway = 1, kFacesEye = 2, kUsed = 3 };

/// A view in grid units.
struct GridView {
  glm::dvec3 eye{0.0};
  glm::dvec3 forward{0.0, 0.0, -1.0};
  glm::dvec3 right{1.0, 0.0, 0.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  bool orthographic = false;
  double halfWidth = 1.0;  // at distance 1; of all distances when orthographic
  double halfHeight = 1.0;
};

GridView gridViewOf(const ClientView& view, const Grid& grid) {
  const protocol::Pose pose = toPose(view, 0, 0);
  GridView result;
  result.eye = (pose.eye - grid.origin) / grid.step;
  result.forward = glm::normalize(pose.forward);
  result.right = glm::normalize(glm::cross(result.forward, glm::normalize(pose.up)));
  result.up = glm::cross(result.right, result.forward);
  result.orthographic = pose.orthoHeight > 0.0;
  result.halfHeight = result.orthographic ? pose.orthoHeight / 2.0 / grid.step
                                          : std::tan(static_cast<double>(pose.fovY) / 2.0);
  result.halfWidth = result.halfHeight * pose.width / pose.height;
  return result;
}

bool inFrame(const GridView& view, const glm::dvec3& offset) {
  const double depth = glm::dot(offset, view.forward);
  if (!view.orthographic && depth <= 0.0) return false;
  const double scale = (view.orthographic ? 1.0 : depth) * kFrameMargin;
  return std::abs(glm::dot(offset, view.right)) <= view.halfWidth * scale &&
         std::abs(glm::dot(offset, view.up)) <= view.halfHeight * scale;
}

Use useOf(const GridView& view, const glm::dvec3& position, std::span<const glm::dvec3> normals) {
  const glm::dvec3 offset = position - view.eye;
  if (!inFrame(view, offset)) return kOutOfFrame;
  const glm::dvec3 toEye = view.orthographic ? -view.forward : -glm::normalize(offset);
  bool front = false;
  bool back = false;
  for (const glm::dvec3& normal : normals) {
    const double cosine = glm::dot(normal, toEye);
    if (std::abs(cosine) < kNearSine) return kUsed;
    (cosine > 0.0 ? front : back) = true;
  }
  return front && back ? kUsed : front ? kFacesEye : kFacesAway;
}

/// Unit normals of the faces around a slot.
void normalsAround(const ActiveMesh& active, Slot slot, std::vector<glm::dvec3>& normals) {
  const HalfEdgeMesh& mesh = active.mesh();
  const auto positions = active.positions();
  normals.clear();
  const HalfEdgeId first = mesh.outgoing[slot];
  for (HalfEdgeId h = first; h != kNone;) {
    const glm::dvec3 a(positions[slot]);
    const glm::dvec3 b(positions[mesh.target(h)]);
    const glm::dvec3 c(positions[mesh.origin(HalfEdgeMesh::prev(h))]);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double length = glm::length(normal);
    if (length > 0.0) normals.push_back(normal / length);
    h = mesh.rotateCcw(h);
    if (h == first) break;
  }
}

}  // namespace

std::uint32_t splitsThatFit(std::uint64_t bytes, const protocol::ModelInfo& model) {
  const std::uint32_t baseVertices = model.levelBegin[1];
  const std::uint32_t vertices = model.vertices;
  // Seams are bits that every half-edge has anyway.
  const std::uint64_t perVertex =
      kBytesPerVertex + ((model.attributes & kAttributeColors) != 0 ? sizeof(SrgbColor) : 0) +
      ((model.attributes & kAttributeNormals) != 0 ? sizeof(OctNormal) : 0) +
      (model.placement != 0 ? kBytesPerHistory : 0);
  const std::uint64_t copy = bytes / kCopies;
  const std::uint64_t fixed = kBytesPerPage * (vertices / 1024 + 1) + perVertex * baseVertices;
  if (copy <= fixed) return 0;
  const std::uint64_t splits = (copy - fixed) / perVertex;
  if (splits < std::min<std::uint64_t>(kUsefulSplits, vertices - baseVertices)) return 0;
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(splits, vertices));
}

void Eviction::look(const ClientView& view) {
  present_ = view;
  const auto isApart = [&](const ClientView& last) {
    const double step = kRememberDegrees * std::acos(-1.0) / 180.0;
    const double cosine = glm::dot(last.camera.forward(), view.camera.forward());
    const double moved = glm::distance(last.camera.eye, view.camera.eye);
    return cosine < std::cos(step) ||
           moved > step * glm::distance(view.camera.eye, view.camera.target);
  };
  if (past_.empty() || isApart(past_.front())) past_.push_front(view);
  if (past_.size() > kViews) past_.pop_back();
}

std::vector<VertexId>
Eviction::choose(const ActiveMesh& active, const Grid& grid, std::size_t count) const {
  if (!present_) return {};
  std::vector<GridView> views{gridViewOf(*present_, grid)};
  for (const ClientView& view : past_)
    views.push_back(gridViewOf(view, grid));

  struct Candidate {
    std::uint32_t need = 0;
    VertexId id = kNone;
  };

  std::vector<Candidate> candidates;
  std::vector<glm::dvec3> normals;
  const auto ids = active.ids();
  for (Slot s = active.baseVertexCount(); s < ids.size(); ++s) {
    normalsAround(active, s, normals);
    const glm::dvec3 position(active.positions()[s]);
    const Use now = useOf(views.front(), position, normals);
    if (now == kUsed) continue;
    // What an earlier view used is needed the more the later that was.
    std::uint32_t lately = 0;
    for (std::size_t i = 1; i < views.size() && lately == 0; ++i) {
      if (useOf(views[i], position, normals) == kUsed)
        lately = static_cast<std::uint32_t>(views.size() - i);
    }
    candidates.push_back({4 * lately + now, ids[s]});
  }
  const std::size_t size = std::min(count, candidates.size());
  std::partial_sort(
      candidates.begin(),
      candidates.begin() + static_cast<std::ptrdiff_t>(size),
      candidates.end(),
      [](const Candidate& a, const Candidate& b) {
        return std::pair(a.need, ~a.id) < std::pair(b.need, ~b.id);
      });
  std::vector<VertexId> chosen;
  for (std::size_t i = 0; i < size; ++i)
    chosen.push_back(candidates[i].id);
  std::ranges::sort(chosen);

  // From the finest on: what is next to a finer one that stays, stays.
  std::vector<bool> stays(chosen.size(), false);
  std::vector<Slot> ring;
  for (std::size_t i = chosen.size(); i-- > 0;) {
    active.mesh().ring(active.slotOf(chosen[i]), ring);
    for (const Slot neighbour : ring) {
      const VertexId finer = ids[neighbour];
      if (finer < chosen[i]) continue;
      const auto at = std::ranges::lower_bound(chosen, finer);
      if (at == chosen.end() || *at != finer ||
          stays[static_cast<std::size_t>(at - chosen.begin())])
        stays[i] = true;
    }
  }
  std::vector<VertexId> result;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!stays[i]) result.push_back(chosen[i]);
  }
  return result;
}

}  // namespace limn
