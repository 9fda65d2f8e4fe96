// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/draco_codec.h"

#include "shared/codec/allocation_budget.h"

#include <draco/compression/config/decoder_options.h>
#include <draco/compression/encode.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <string>

namespace limn {
namespace {

using draco::GeometryAttribute;

constexpr int kMaxAttributes = 3;  // positions, colours, normals
// All that Draco allocates for one mesh, freed or not. A base of 2^18 faces takes about 130 MiB.
constexpr std::size_t kMaxDecoderBytes = std::size_t{384} << 20;

// Value i of the attribute belongs to vertex i.
template <class Vector>
void addAttribute(
    draco::Mesh& mesh,
    GeometryAttribute::Type type,
    draco::DataType valueType,
    const std::vector<Vector>& values) {
  GeometryAttribute description;
  description.Init(
      type,
      nullptr,
      static_cast<std::int8_t>(Vector::length()),
      valueType,
      false,
      sizeof(Vector),
      0);
  draco::PointAttribute* attribute = mesh.attribute(
      mesh.AddAttribute(description, true, static_cast<std::uint32_t>(values.size())));
  for (std::uint32_t v = 0; v < values.size(); ++v)
    attribute->SetAttributeValue(draco::AttributeValueIndex(v), &values[v].x);
}

// One value a point. Nothing where the mesh has no such attribute; false where it is another one.
template <class Vector>
bool readAttribute(
    const draco::Mesh& mesh,
    GeometryAttribute::Type type,
    draco::DataType valueType,
    std::vector<Vector>& values) {
  const draco::PointAttribute* attribute = mesh.GetNamedAttribute(type);
  if (attribute == nullptr) return true;
  if (attribute->data_type() != valueType || attribute->num_components() != Vector::length())
    return false;
  values.resize(mesh.num_points());
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
    const draco::PointIndex point(i);
    if (attribute->mapped_index(point).value() >= attribute->size()) return false;
    attribute->GetMappedValue(point, &values[i].x);
  }
  return true;
}

std::unique_ptr<draco::Mesh> toDraco(const TriangleMesh& mesh) {
  auto result = std::make_unique<draco::Mesh>();
  const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
  result->set_num_points(vertices);
  result->SetNumFaces(mesh.triangles.size());
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    draco::Mesh::Face face;
    for (int k = 0; k < 3; ++k)
      face[k] = draco::PointIndex(mesh.triangles[f][k]);
    result->SetFace(draco::FaceIndex(f), face);
  }
  addAttribute(*result, GeometryAttribute::POSITION, draco::DT_INT32, mesh.positions);
  if (!mesh.attributes.colors.empty())
    addAttribute(*result, GeometryAttribute::COLOR, draco::DT_UINT8, mesh.attributes.colors);
  if (!mesh.attributes.normals.empty())
    addAttribute(*result, GeometryAttribute::GENERIC, draco::DT_UINT16, mesh.attributes.normals);
  return result;
}

bool encode(const draco::Mesh& mesh, int speed, draco::EncoderBuffer& buffer) {
  draco::Encoder encoder;
  encoder.SetSpeedOptions(speed, speed);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  return encoder.EncodeMeshToBuffer(mesh, &buffer).ok();
}

// Draco's varint, as its header uses it.
bool readVarint(std::span<const std::uint8_t>& bytes, std::uint32_t& value) {
  value = 0;
  for (int shift = 0; shift < 35 && !bytes.empty(); shift += 7) {
    const std::uint8_t byte = bytes.front();
    bytes = bytes.subspan(1);
    value |= static_cast<std::uint32_t>(byte & 0x7F) << shift;
    if ((byte & 0x80) == 0) return true;
  }
  return false;
}

// Draco's decoder allocates what the header claims, so the claims are checked before it runs
// (bitstream 2.2 of a mesh, edgebreaker: the only kind that we write).
Result<void> checkHeader(
    std::span<const std::uint8_t> bytes,
    std::uint32_t maxVertices,
    std::uint32_t maxFaces) {
  constexpr std::uint8_t kExpected[] =
      {'D', 'R', 'A', 'C', 'O', 2, 2, draco::TRIANGULAR_MESH, draco::MESH_EDGEBREAKER_ENCODING};
  constexpr std::size_t kFlags = 2;
  constexpr std::size_t kTraversal = 1;
  if (bytes.size() < sizeof(kExpected) + kFlags + kTraversal ||
      !std::equal(std::begin(kExpected), std::end(kExpected), bytes.begin())) {
    return fail(ErrorCode::kCorrupt, "not an edgebreaker Draco mesh");
  }
  bytes = bytes.subspan(sizeof(kExpected) + kFlags + kTraversal);
  std::uint32_t vertices = 0;
  std::uint32_t faces = 0;
  if (!readVarint(bytes, vertices) || !readVarint(bytes, faces)) {
    return fail(ErrorCode::kCorrupt, "Draco mesh is cut short");
  }
  if (vertices > maxVertices || faces > maxFaces) {
    return fail(
        ErrorCode::kLimitExceeded,
        "Draco mesh claims " + std::to_string(vertices) + " vertices and " + std::to_string(faces) +
            " faces");
  }
  // A connectivity of its own for every attribute, each as large as the mesh's.
  if (bytes.empty() || bytes.front() > kMaxAttributes) {
    return fail(ErrorCode::kCorrupt, "Draco mesh has attributes that it cannot have");
  }
  return {};
}

// Draco's decoder, held to what we write: it stops before it makes room for other attributes.
class GuardedDecoder final : public draco::MeshEdgebreakerDecoder {
 protected:
  bool CreateAttributesDecoder(std::int32_t id) override {
    return id < kMaxAttributes && MeshEdgebreakerDecoder::CreateAttributesDecoder(id);
  }

  // Called once all attributes are described, before any is decoded.
  bool DecodeAllAttributes() override {
    if (point_cloud()->num_attributes() > kMaxAttributes) return false;
    for (std::int32_t i = 0; i < point_cloud()->num_attributes(); ++i) {
      const draco::PointAttribute& attribute = *point_cloud()->attribute(i);
      if (!isOurs(attribute)) return false;
    }
    return MeshEdgebreakerDecoder::DecodeAllAttributes();
  }

 private:
  static bool isOurs(const draco::PointAttribute& attribute) {
    switch (attribute.attribute_type()) {
      case GeometryAttribute::POSITION:
        return attribute.data_type() == draco::DT_INT32 && attribute.num_components() == 3;
      case GeometryAttribute::COLOR:
        return attribute.data_type() == draco::DT_UINT8 && attribute.num_components() == 3;
      case GeometryAttribute::GENERIC:
        return attribute.data_type() == draco::DT_UINT16 && attribute.num_components() == 2;
      default:
        return false;
    }
  }
};

Result<std::unique_ptr<draco::Mesh>> runDraco(std::span<const std::uint8_t> bytes) {
  draco::DecoderBuffer in;
  in.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  auto mesh = std::make_unique<draco::Mesh>();
  try {
    const AllocationBudget budget(kMaxDecoderBytes);
    const draco::DecoderOptions options;
    if (!GuardedDecoder().Decode(options, &in, mesh.get()).ok()) {
      return fail(ErrorCode::kCorrupt, "Draco mesh is damaged");
    }
  } catch (const std::exception&) {
    // Out of its budget, or a length that no vector has.
    return fail(ErrorCode::kLimitExceeded, "Draco mesh needs more memory than it may have");
  }
  return mesh;
}

}  // namespace

Result<DracoMesh> encodeDraco(const TriangleMesh& mesh, int speed) {
  if (mesh.triangles.empty())
    return fail(ErrorCode::kInvalidArgument, "a mesh without faces cannot be coded");
  DracoMesh result;
  // A decoder numbers vertices as its traversal of the connectivity meets them. Positions do not
  // matter for that (that there are attributes does): a first pass carries vertex numbers in their
  // place, and tells the order.
  TriangleMesh numbered{mesh.grid, {}, mesh.triangles, mesh.attributes};
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    numbered.positions.emplace_back(v, 0, 0);
  draco::EncoderBuffer numbers;
  if (!encode(*toDraco(numbered), speed, numbers)) {
    return fail(ErrorCode::kCorrupt, "Draco cannot code this mesh");
  }
  const auto back = decodeDraco(
      {reinterpret_cast<const std::uint8_t*>(numbers.data()), numbers.size()},
      static_cast<std::uint32_t>(mesh.positions.size()),
      static_cast<std::uint32_t>(mesh.triangles.size()));
  if (!back) return tl::unexpected(back.error());
  if (back->positions.size() != mesh.positions.size()) {
    return fail(ErrorCode::kNonManifold, "Draco changes the vertex count of this mesh");
  }
  for (const glm::ivec3& p : back->positions)
    result.order.push_back(static_cast<std::uint32_t>(p.x));
  draco::EncoderBuffer buffer;
  if (!encode(*toDraco(mesh), speed, buffer))
    return fail(ErrorCode::kCorrupt, "Draco cannot code this mesh");
  const auto* data = reinterpret_cast<const std::uint8_t*>(buffer.data());
  result.bytes.assign(data, data + buffer.size());
  return result;
}

Result<TriangleMesh> decodeDraco(
    std::span<const std::uint8_t> bytes,
    std::uint32_t maxVertices,
    std::uint32_t maxFaces) {
  if (auto ok = checkHeader(bytes, maxVertices, maxFaces); !ok) return tl::unexpected(ok.error());
  const auto decoded = runDraco(bytes);
  if (!decoded) return tl::unexpected(decoded.error());
  const draco::Mesh& mesh = **decoded;
  if (mesh.GetNamedAttribute(GeometryAttribute::POSITION) == nullptr ||
      mesh.num_points() > maxVertices || mesh.num_faces() > maxFaces) {
    return fail(ErrorCode::kCorrupt, "Draco mesh has no integer positions");
  }
  TriangleMesh result;
  AttributeArrays& attributes = result.attributes;
  if (!readAttribute(mesh, GeometryAttribute::POSITION, draco::DT_INT32, result.positions) ||
      !readAttribute(mesh, GeometryAttribute::COLOR, draco::DT_UINT8, attributes.colors) ||
      !readAttribute(mesh, GeometryAttribute::GENERIC, draco::DT_UINT16, attributes.normals)) {
    return fail(ErrorCode::kCorrupt, "Draco mesh is damaged");
  }
  for (const OctNormal& normal : attributes.normals) {
    if (std::max(normal.x, normal.y) > 2 * kOctRadius)
      return fail(ErrorCode::kCorrupt, "Draco mesh has an impossible normal");
  }
  result.triangles.resize(mesh.num_faces());
  for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t corner = mesh.face(draco::FaceIndex(f))[k].value();
      if (corner >= mesh.num_points()) return fail(ErrorCode::kCorrupt, "Draco mesh is damaged");
      result.triangles[f][k] = corner;
    }
  }
  return result;
}

}  // namespace limn
