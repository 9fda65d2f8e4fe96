// SPDX-License-Identifier: Apache-2.0
// Based on: Khronos Group, "glTF 2.0 Specification". tinygltf parses; it does not check that
// indices, offsets and lengths fit, so all of that is checked here, and a preflight comes before
// it.
#include "server/preprocess/import/gltf_preflight.h"
#include "server/preprocess/import/import_readers.h"

#include "shared/core/ids.h"

#include <glm/gtc/matrix_inverse.hpp>
#include <glm/gtc/quaternion.hpp>
#include <tiny_gltf.h>

#include <cstring>
#include <exception>
#include <vector>

namespace limn::import {

namespace {

/// Instances multiply: a small file may describe more than any memory holds. These many corners are
/// always fine (5.6 million faces, below half a GiB), and so are four for each byte of the file.
constexpr std::size_t kCornersAlwaysFine = std::size_t{1} << 24;
constexpr std::size_t kCornersPerByte = 4;

tl::unexpected<Error> corrupt(std::string_view what) {
  return fail(
      ErrorCode::kCorrupt,
      std::string(what) + ": the glTF file is damaged; export it again");
}

double component(const unsigned char* at, int type, bool normalized) {
  const auto load = [&]<class T>(T value, double scale) {
    std::memcpy(&value, at, sizeof value);
    return normalized ? std::max(static_cast<double>(value) / scale, -1.0)
                      : static_cast<double>(value);
  };
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return load(std::int8_t{}, 127.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load(std::uint8_t{}, 255.0);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return load(std::int16_t{}, 32767.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load(std::uint16_t{}, 65535.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load(std::uint32_t{}, 1.0);
    default: {
      float value = 0.0F;
      std::memcpy(&value, at, sizeof value);
      return static_cast<double>(value);
    }
  }
}

/// Items of an accessor inside the bytes of its buffer.
struct Items {
  const unsigned char* data = nullptr;
  std::size_t count = 0;
  std::size_t stride = 0;
  int type = 0;
  int components = 0;
  bool normalized = false;

  [[nodiscard]] double at(std::size_t item, int k) const {
    const auto size = static_cast<std::size_t>(
        tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type)));
    return component(data + item * stride + static_cast<std::size_t>(k) * size, type, normalized);
  }

  [[nodiscard]] glm::dvec3 vec3(std::size_t item) const {
    return {at(item, 0), at(item, 1), at(item, 2)};
  }
};

template <class List>
bool has(const List& list, int index) {
  return index >= 0 && static_cast<std::size_t>(index) < list.size();
}

class GltfReader {
 public:
  GltfReader(const tinygltf::Model& model, std::size_t fileBytes)
      : model_(model),
        maxCorners_(kCornersAlwaysFine + kCornersPerByte * fileBytes) {}

  Result<ImportedMesh> read() {
    if (!model_.materials.empty()) {
      for (const tinygltf::Material& material : model_.materials) {
        const std::vector<double>& factor = material.pbrMetallicRoughness.baseColorFactor;
        mesh_.materialColors.emplace_back(1.0F);
        for (std::size_t k = 0; k < 3 && factor.size() >= 3; ++k)
          mesh_.materialColors.back()[static_cast<int>(k)] = static_cast<float>(factor[k]);
      }
      mesh_.materialColors.emplace_back(1.0F);  // of primitives that name none
    }
    if (auto walked = walkScene(); !walked) return tl::unexpected(walked.error());
    if (mesh_.polygonBegin.size() == 1 && mesh_.droppedFaces == 0) {
      return fail(
          ErrorCode::kUnsupported,
          "the scene has no triangles: export a mesh, not only lines, points or cameras");
    }
    if (mesh_.normals.size() != mesh_.positions.size()) mesh_.normals.clear();
    if (mesh_.colors.size() != mesh_.positions.size()) mesh_.colors.clear();
    return std::move(mesh_);
  }

 private:
  struct Placed {
    int node;
    glm::dmat4 modelFromParent;
  };

  /// The nodes to draw: the default scene's, else the first's, else every root.
  [[nodiscard]] Result<std::vector<int>> roots() const {
    if (!model_.scenes.empty()) {
      const int scene = model_.defaultScene < 0 ? 0 : model_.defaultScene;
      if (!has(model_.scenes, scene)) return corrupt("the default scene does not exist");
      return model_.scenes[static_cast<std::size_t>(scene)].nodes;
    }
    std::vector<std::uint8_t> isChild(model_.nodes.size(), 0);
    for (const tinygltf::Node& node : model_.nodes) {
      for (const int child : node.children) {
        if (has(model_.nodes, child)) isChild[static_cast<std::size_t>(child)] = 1;
      }
    }
    std::vector<int> found;
    for (std::size_t i = 0; i < isChild.size(); ++i) {
      if (isChild[i] == 0) found.push_back(static_cast<int>(i));
    }
    return found;
  }

  Result<void> walkScene() {
    auto first = roots();
    if (!first) return tl::unexpected(first.error());
    std::vector<Placed> stack;
    for (auto it = first->rbegin(); it != first->rend(); ++it)
      stack.push_back({*it, glm::dmat4(1.0)});
    std::vector<std::uint8_t> seen(model_.nodes.size(), 0);
    while (!stack.empty()) {
      const Placed placed = stack.back();
      stack.pop_back();
      if (!has(model_.nodes, placed.node))
        return corrupt("a scene names a node that does not exist");
      const auto index = static_cast<std::size_t>(placed.node);
      if (seen[index] != 0)
        return corrupt("node " + std::to_string(index) + " is its own ancestor or has two parents");
      seen[index] = 1;
      const tinygltf::Node& node = model_.nodes[index];
      const glm::dmat4 modelFromNode = placed.modelFromParent * localTransform(node);
      if (node.mesh >= 0) {
        if (!has(model_.meshes, node.mesh))
          return corrupt("a node names a mesh that does not exist");
        for (const tinygltf::Primitive& primitive :
             model_.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
          if (auto added = addPrimitive(primitive, modelFromNode); !added) return added;
        }
      }
      for (auto it = node.children.rbegin(); it != node.children.rend(); ++it)
        stack.push_back({*it, modelFromNode});
    }
    return {};
  }

  static glm::dmat4 localTransform(const tinygltf::Node& node) {
    glm::dmat4 matrix(1.0);
    if (node.matrix.size() == 16) {
      for (int k = 0; k < 16; ++k)
        matrix[k / 4][k % 4] = node.matrix[static_cast<std::size_t>(k)];
      return matrix;
    }
    if (node.translation.size() == 3) {
      matrix[3] = {node.translation[0], node.translation[1], node.translation[2], 1.0};
    }
    if (node.rotation.size() == 4) {
      matrix *= glm::mat4_cast(
          glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]));
    }
    if (node.scale.size() == 3) {
      for (int k = 0; k < 3; ++k)
        matrix[k] *= node.scale[static_cast<std::size_t>(k)];
    }
    return matrix;
  }

  /// `size` bytes at `offset` of a buffer view, all inside it and its buffer.
  [[nodiscard]] Result<const unsigned char*>
  bytesOf(int viewIndex, std::size_t offset, std::size_t size) const {
    if (!has(model_.bufferViews, viewIndex))
      return corrupt("an accessor has no data (no such buffer view)");
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(viewIndex)];
    if (!has(model_.buffers, view.buffer))
      return corrupt("a buffer view names a buffer that does not exist");
    const std::vector<unsigned char>& buffer =
        model_.buffers[static_cast<std::size_t>(view.buffer)].data;
    if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
      return corrupt("a buffer view is longer than its buffer");
    }
    if (offset > view.byteLength || size > view.byteLength - offset)
      return corrupt("an accessor is longer than its buffer view");
    return buffer.data() + view.byteOffset + offset;
  }

  [[nodiscard]] Result<Items> itemsOf(int accessorIndex) const {
    if (!has(model_.accessors, accessorIndex))
      return corrupt("a mesh names an accessor that does not exist");
    const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(accessorIndex)];
    if (accessor.sparse.isSparse) {
      return fail(
          ErrorCode::kUnsupported,
          "the geometry is stored as sparse accessors: export it with plain ones");
    }
    const int size =
        tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
    const int components =
        tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
    if (size <= 0 || size > 4 || components <= 0 || components > 4)
      return corrupt("an accessor has an unknown type");
    Items items;
    items.count = accessor.count;
    items.type = accessor.componentType;
    items.components = components;
    items.normalized = accessor.normalized;
    const auto item = static_cast<std::size_t>(size) * static_cast<std::size_t>(components);
    items.stride = item;
    if (has(model_.bufferViews, accessor.bufferView)) {
      const std::size_t stride =
          model_.bufferViews[static_cast<std::size_t>(accessor.bufferView)].byteStride;
      if (stride != 0 && (stride < item || stride > 1024))
        return corrupt("a buffer view has an impossible stride");
      if (stride != 0) items.stride = stride;
    }
    if (accessor.count == 0 || accessor.count >= kNone)
      return corrupt("an accessor has an impossible count");
    auto data = bytesOf(
        accessor.bufferView,
        accessor.byteOffset,
        (accessor.count - 1) * items.stride + item);
    if (!data) return tl::unexpected(data.error());
    items.data = *data;
    return items;
  }

  /// An attribute with at least three components and an item for each vertex, where there is one.
  [[nodiscard]] Result<Items>
  attribute(const tinygltf::Primitive& primitive, const char* name, std::size_t count) const {
    const auto found = primitive.attributes.find(name);
    if (found == primitive.attributes.end()) return Items{};
    auto items = itemsOf(found->second);
    if (items && (items->components < 3 || items->count < count))
      return corrupt("an attribute is shorter than its vertices");
    return items;
  }

  /// A primitive's accessors, checked.
  struct Source {
    Items positions;
    Items normals;  // count 0 where there are none
    Items colors;
    Items indices;

    [[nodiscard]] std::size_t corners() const {
      return indices.count > 0 ? indices.count : positions.count;
    }

    [[nodiscard]] std::size_t vertex(std::size_t corner) const {
      return indices.count > 0 ? static_cast<std::size_t>(indices.at(corner, 0)) : corner;
    }
  };

  [[nodiscard]] Result<Source> sourceOf(const tinygltf::Primitive& primitive) const {
    const auto positions = attribute(primitive, "POSITION", 0);
    if (!positions) return tl::unexpected(positions.error());
    const auto normals = attribute(primitive, "NORMAL", positions->count);
    if (!normals) return tl::unexpected(normals.error());
    const auto colors = attribute(primitive, "COLOR_0", positions->count);
    if (!colors) return tl::unexpected(colors.error());
    if (primitive.indices < 0) return Source{*positions, *normals, *colors, {}};
    const auto indices = itemsOf(primitive.indices);
    if (!indices) return tl::unexpected(indices.error());
    if (indices->components != 1 || indices->type == TINYGLTF_COMPONENT_TYPE_FLOAT) {
      return corrupt("indices are not whole numbers");
    }
    return Source{*positions, *normals, *colors, *indices};
  }

  Result<void> addPrimitive(const tinygltf::Primitive& primitive, const glm::dmat4& modelFromNode) {
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode < TINYGLTF_MODE_TRIANGLES) return {};  // points and lines
    if (mode > TINYGLTF_MODE_TRIANGLE_FAN) return corrupt("a primitive has an unknown mode");
    const auto source = sourceOf(primitive);
    if (!source) return tl::unexpected(source.error());
    // Many primitives may share one large accessor: only vertices in use are taken.
    if (slots_.size() < source->positions.count) slots_.resize(source->positions.count, kNone);
    const bool mirrored = glm::determinant(glm::dmat3(modelFromNode)) < 0.0;
    const std::size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
    bool tooMuch = false;
    for (std::size_t i = 0; i + 2 < source->corners() && !tooMuch; i += step) {
      const std::size_t first = mode == TINYGLTF_MODE_TRIANGLE_FAN ? 0 : i;
      const bool odd = mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 == 1;
      const bool swapped = odd != mirrored;
      for (const std::size_t corner : {first, swapped ? i + 2 : i + 1, swapped ? i + 1 : i + 2}) {
        mesh_.corners.push_back(place(*source, source->vertex(corner), modelFromNode));
      }
      endPolygon(mesh_);
      tooMuch = mesh_.corners.size() > maxCorners_ || mesh_.corners.size() > kNone - 3;
    }
    if (!model_.materials.empty()) {
      const bool isThere = has(model_.materials, primitive.material);
      const std::size_t material =
          isThere ? static_cast<std::size_t>(primitive.material) : model_.materials.size();
      endMaterial(mesh_, static_cast<std::uint32_t>(material));
    }
    for (const std::size_t vertex : taken_)
      slots_[vertex] = kNone;
    taken_.clear();
    if (!tooMuch) return {};
    return fail(
        ErrorCode::kLimitExceeded,
        "the scene's instances add up to far more faces than the file holds: export fewer of "
        "them, or split the model");
  }

  /// The mesh's vertex for a vertex of the primitive being added.
  std::uint32_t place(const Source& source, std::size_t vertex, const glm::dmat4& modelFromNode) {
    if (vertex >= source.positions.count) return kNone;
    if (slots_[vertex] != kNone) return slots_[vertex];
    slots_[vertex] = static_cast<std::uint32_t>(mesh_.positions.size());
    taken_.push_back(vertex);
    mesh_.positions.emplace_back(modelFromNode * glm::dvec4(source.positions.vec3(vertex), 1.0));
    if (source.normals.count > 0) {
      const glm::dmat3 normalMatrix = glm::inverseTranspose(glm::dmat3(modelFromNode));
      mesh_.normals.emplace_back(normalMatrix * source.normals.vec3(vertex));
    }
    if (source.colors.count > 0) mesh_.colors.emplace_back(source.colors.vec3(vertex));
    return slots_[vertex];
  }

  const tinygltf::Model& model_;
  const std::size_t maxCorners_;
  ImportedMesh mesh_;
  std::vector<std::uint32_t> slots_;  // of the primitive being added; kNone elsewhere
  std::vector<std::size_t> taken_;    // which slots are in use
};

/// Pictures are not decoded, and no file is opened.
bool ignoreImage(
    tinygltf::Image*,
    const int,
    std::string*,
    std::string*,
    int,
    int,
    const unsigned char*,
    int,
    void*) {
  return true;
}

}  // namespace

Result<ImportedMesh> readGltf(std::string_view bytes) {
  auto glb = preflightGltf(bytes);
  if (!glb) return tl::unexpected(glb.error());
  try {
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(&ignoreImage, nullptr);
    loader.SetFsCallbacks(
        {[](const std::string&, void*) { return false; },
         [](const std::string&, void*) { return std::string(); },
         [](std::vector<unsigned char>*, std::string*, const std::string&, void*) { return false; },
         [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
           return false;
         },
         nullptr});
    tinygltf::Model model;
    std::string error;
    std::string warning;
    const bool loaded = loader.LoadBinaryFromMemory(
        &model,
        &error,
        &warning,
        reinterpret_cast<const unsigned char*>(glb->data()),
        static_cast<unsigned>(glb->size()));
    if (!loaded) {
      std::string line = error.substr(0, error.find('\n')).substr(0, 200);
      return corrupt(line.empty() ? "not a glTF 2.0 model" : line);
    }
    glb->clear();
    glb->shrink_to_fit();
    auto mesh = GltfReader(model, bytes.size()).read();
    if (mesh) mesh->format = bytes.starts_with("glTF") ? "glb" : "gltf";
    return mesh;
  } catch (const std::exception& thrown) {  // nlohmann's json inside tinygltf
    return corrupt(
        std::string("cannot be read (") + std::string(thrown.what()).substr(0, 100) + ")");
  }
}

}  // namespace limn::import
