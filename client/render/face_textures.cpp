// SPDX-License-Identifier: Apache-2.0
#include "client/render/face_textures.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace limn {
namespace {

struct Layout {
  gl::TexelFormat format;
  GLenum components;
  GLenum type;
};

constexpr Layout kVectors{gl::TexelFormat::kRgba32f, GL_RGBA, GL_FLOAT};
constexpr Layout kWords{gl::TexelFormat::kR32ui, GL_RED_INTEGER, GL_UNSIGNED_INT};
constexpr Layout kBytes{gl::TexelFormat::kR8, GL_RED, GL_UNSIGNED_BYTE};

int rowsFor(std::size_t entries) {
  return std::max(1, static_cast<int>((entries + FaceTextures::kRow - 1) / FaceTextures::kRow));
}

Result<void> checkRows(const gl::Api& api, std::size_t entries) {
  GLint largest = 0;
  api.getIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (rowsFor(entries) <= largest) return {};
  return fail(
      ErrorCode::kLimitExceeded,
      "the mesh is too large for this GL's textures (" + std::to_string(entries) +
          " indices): use --draw strokes");
}

/// A texture of `entries`, padded to whole rows.
template <class Entry>
gl::Texture makeRows(const gl::Api& api, const Layout& layout, std::vector<Entry> entries) {
  const int rows = rowsFor(entries.size());
  entries.resize(static_cast<std::size_t>(rows) * FaceTextures::kRow);
  gl::Texture texture = gl::makeTexture(api, layout.format, {FaceTextures::kRow, rows});
  api.pixelStorei(GL_UNPACK_ALIGNMENT, 1);
  api.texSubImage2D(
      GL_TEXTURE_2D,
      0,
      0,
      0,
      FaceTextures::kRow,
      rows,
      layout.components,
      layout.type,
      entries.data());
  return texture;
}

}  // namespace

Result<bool>
FaceTextures::upload(const gl::Api& api, const MeshSnapshot& snapshot, const glm::ivec3& center) {
  const std::vector<std::uint32_t>& origins = snapshot.mesh.mesh().origins;
  const auto positions = snapshot.mesh.positions();
  const int faces = static_cast<int>(origins.size() / 3);
  if (api_ != nullptr && asset_ == snapshot.model.asset && revision_ == snapshot.revision &&
      vertices_ == positions.size() && faces_ == faces) {
    return false;
  }
  if (auto ok = checkRows(api, std::max(origins.size(), positions.size())); !ok) {
    return tl::unexpected(ok.error());
  }
  api_ = &api;
  asset_ = snapshot.model.asset;
  revision_ = snapshot.revision;
  vertices_ = positions.size();
  faces_ = faces;
  hasNormals_ = false;
  std::vector<glm::vec4> relative;
  relative.reserve(positions.size() + kRow);
  for (const glm::ivec3& p : positions)
    relative.emplace_back(glm::vec3(p - center), 1.0F);
  positions_ = makeRows(api, kVectors, std::move(relative));
  corners_ = makeRows(api, kWords, origins);
  marks_ = makeRows(api, kBytes, std::vector<std::uint8_t>(1));
  return true;
}

void FaceTextures::uploadNormals(const MeshSnapshot& snapshot) {
  if (hasNormals_) return;
  hasNormals_ = true;
  const auto positions = snapshot.mesh.positions();
  std::vector<glm::dvec3> sums(positions.size(), glm::dvec3(0.0));
  for (const glm::uvec3& t : snapshot.mesh.mesh().triangles()) {
    const glm::dvec3 a(positions[t.x]);
    const glm::dvec3 n = glm::cross(glm::dvec3(positions[t.y]) - a, glm::dvec3(positions[t.z]) - a);
    for (const std::uint32_t v : {t.x, t.y, t.z})
      sums[v] += n;
  }
  std::vector<glm::vec4> normals;
  normals.reserve(sums.size() + kRow);
  for (const glm::dvec3& sum : sums) {
    const double length = glm::length(sum);
    normals.emplace_back(length > 0.0 ? glm::vec3(sum / length) : glm::vec3(0.0F), 0.0F);
  }
  normals_ = makeRows(*api_, kVectors, std::move(normals));
}

void FaceTextures::uploadMarks(std::span<const std::uint8_t> marks) {
  marks_ = makeRows(*api_, kBytes, std::vector<std::uint8_t>(marks.begin(), marks.end()));
}

Result<gl::Texture> makeIndexTexture(const gl::Api& api, std::vector<std::uint32_t> indices) {
  if (auto ok = checkRows(api, indices.size()); !ok) return tl::unexpected(ok.error());
  return makeRows(api, kWords, std::move(indices));
}

}  // namespace limn
