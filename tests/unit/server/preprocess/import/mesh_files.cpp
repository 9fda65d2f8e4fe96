// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/server/preprocess/import/mesh_files.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>

namespace limn::testing {

namespace {

enum class Order { kLittle, kBig };

template <class T>
void put(std::string& out, T value, Order order = Order::kLittle) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof(T));
  if (order == Order::kBig) std::reverse(raw.begin(), raw.end());
  out.append(raw.data(), raw.size());
}

glm::vec3 at(const TriangleMesh& mesh, std::uint32_t v) {
  return glm::vec3(mesh.grid.toModel(mesh.positions[v]));
}

void print(std::ostringstream& out, const TriangleMesh& mesh, std::uint32_t v) {
  const glm::vec3 p = at(mesh, v);
  out << p.x << ' ' << p.y << ' ' << p.z << '\n';
}

std::ostringstream exactText() {
  std::ostringstream out;
  out.precision(9);
  return out;
}

Corners startingWithLeast(Corners t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

}  // namespace

std::string plyFile(const TriangleMesh& mesh, PlyEncoding encoding) {
  const bool isDouble = encoding == PlyEncoding::kBigEndianDouble;
  const bool text = encoding == PlyEncoding::kText;
  const Order order = encoding == PlyEncoding::kLittleEndian ? Order::kLittle : Order::kBig;
  std::ostringstream header = exactText();
  header << "ply\nformat "
         << (text                   ? "ascii"
             : order == Order::kBig ? "binary_big_endian"
                                    : "binary_little_endian")
         << " 1.0\nelement vertex " << mesh.positions.size();
  for (const char axis : {'x', 'y', 'z'})
    header << "\nproperty " << (isDouble ? "double " : "float ") << axis;
  header << "\nelement face " << mesh.triangles.size()
         << "\nproperty list uchar int vertex_indices\nend_header\n";
  if (text) {
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
      print(header, mesh, v);
    for (const glm::uvec3& t : mesh.triangles)
      header << "3 " << t.x << ' ' << t.y << ' ' << t.z << '\n';
    return header.str();
  }
  std::string out = header.str();
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    for (int k = 0; k < 3; ++k) {
      if (isDouble) {
        put(out, static_cast<double>(at(mesh, v)[k]), order);
      } else {
        put(out, at(mesh, v)[k], order);
      }
    }
  }
  for (const glm::uvec3& t : mesh.triangles) {
    put(out, std::uint8_t{3});
    for (int k = 0; k < 3; ++k)
      put(out, t[k], order);
  }
  return out;
}

std::string objFile(const TriangleMesh& mesh) {
  std::ostringstream out = exactText();
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    out << "v ";
    print(out, mesh, v);
  }
  for (const glm::uvec3& t : mesh.triangles)
    out << "f " << t.x + 1 << ' ' << t.y + 1 << ' ' << t.z + 1 << '\n';
  return out.str();
}

std::string offFile(const TriangleMesh& mesh) {
  std::ostringstream out = exactText();
  out << "OFF\n" << mesh.positions.size() << ' ' << mesh.triangles.size() << " 0\n";
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    print(out, mesh, v);
  for (const glm::uvec3& t : mesh.triangles)
    out << "3 " << t.x << ' ' << t.y << ' ' << t.z << '\n';
  return out.str();
}

std::string offBinaryFile(const TriangleMesh& mesh) {
  std::string out = "OFF BINARY\n";
  put(out, static_cast<std::uint32_t>(mesh.positions.size()), Order::kBig);
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()), Order::kBig);
  put(out, std::uint32_t{0}, Order::kBig);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    for (int k = 0; k < 3; ++k)
      put(out, at(mesh, v)[k], Order::kBig);
  }
  for (const glm::uvec3& t : mesh.triangles) {
    put(out, std::uint32_t{3}, Order::kBig);
    for (int k = 0; k < 3; ++k)
      put(out, t[k], Order::kBig);
    put(out, std::uint32_t{0}, Order::kBig);
  }
  return out;
}

std::string stlTextFile(const TriangleMesh& mesh) {
  std::ostringstream out = exactText();
  out << "solid made by a test\n";
  for (const glm::uvec3& t : mesh.triangles) {
    out << "facet normal 0 0 0\nouter loop\n";
    for (int k = 0; k < 3; ++k) {
      out << "vertex ";
      print(out, mesh, t[k]);
    }
    out << "endloop\nendfacet\n";
  }
  out << "endsolid\n";
  return out.str();
}

std::string stlBinaryFile(const TriangleMesh& mesh) {
  std::string out = "solid is what a binary file may begin with, too";
  out.resize(80, ' ');
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const glm::uvec3& t : mesh.triangles) {
    out.append(12, '\0');
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis)
        put(out, at(mesh, t[k])[axis]);
    }
    out.append(2, '\0');
  }
  return out;
}

std::string glbContainer(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string out = "glTF";
  put(out, std::uint32_t{2});
  put(out, static_cast<std::uint32_t>(28 + json.size() + binary.size()));
  put(out, static_cast<std::uint32_t>(json.size()));
  out += "JSON" + json;
  put(out, static_cast<std::uint32_t>(binary.size()));
  out += std::string("BIN\0", 4) + binary;
  return out;
}

std::string glbFile(const TriangleMesh& mesh, int indexBytes) {
  std::string binary;
  std::size_t vertices = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    for (int k = 0; indexBytes == 0 && k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis)
        put(binary, at(mesh, t[k])[axis]);
      ++vertices;
    }
  }
  for (std::uint32_t v = 0; indexBytes > 0 && v < mesh.positions.size(); ++v) {
    for (int axis = 0; axis < 3; ++axis)
      put(binary, at(mesh, v)[axis]);
    ++vertices;
  }
  const std::size_t indicesAt = binary.size();
  for (const glm::uvec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      if (indexBytes == 1) put(binary, static_cast<std::uint8_t>(t[k]));
      if (indexBytes == 2) put(binary, static_cast<std::uint16_t>(t[k]));
      if (indexBytes == 4) put(binary, t[k]);
    }
  }
  const int type = indexBytes == 1 ? 5121 : indexBytes == 2 ? 5123 : 5125;
  std::ostringstream json;
  json << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
       << R"("meshes":[{"primitives":[{"attributes":{"POSITION":0})"
       << (indexBytes > 0 ? R"(,"indices":1)" : "")
       << R"(}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" << vertices
       << R"(,"type":"VEC3"})";
  if (indexBytes > 0) {
    json << R"(,{"bufferView":1,"componentType":)" << type << R"(,"count":)"
         << 3 * mesh.triangles.size() << R"(,"type":"SCALAR"})";
  }
  json << R"(],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":)" << indicesAt << "}";
  if (indexBytes > 0) {
    json << R"(,{"buffer":0,"byteOffset":)" << indicesAt << R"(,"byteLength":)"
         << binary.size() - indicesAt << "}";
  }
  json << R"(],"buffers":[{"byteLength":)" << binary.size() << "}]}";
  return glbContainer(json.str(), binary);
}

std::vector<NamedFile> everyFormat(const TriangleMesh& mesh) {
  return {
      {"PLY text", ".ply", plyFile(mesh, PlyEncoding::kText)},
      {"PLY little-endian", ".ply", plyFile(mesh, PlyEncoding::kLittleEndian)},
      {"PLY big-endian", ".ply", plyFile(mesh, PlyEncoding::kBigEndian)},
      {"PLY big-endian double", ".ply", plyFile(mesh, PlyEncoding::kBigEndianDouble)},
      {"OBJ", ".obj", objFile(mesh)},
      {"OFF", ".off", offFile(mesh)},
      {"OFF binary", ".off", offBinaryFile(mesh)},
      {"STL text", ".stl", stlTextFile(mesh)},
      {"STL binary", ".stl", stlBinaryFile(mesh)},
      {"GLB", ".glb", glbFile(mesh, 4)},
      {"GLB 16-bit", ".glb", glbFile(mesh, 2)},
      {"GLB not indexed", ".glb", glbFile(mesh, 0)},
  };
}

std::vector<Corners> oriented(const TriangleMesh& mesh) {
  std::vector<Corners> triangles;
  for (const glm::uvec3& t : mesh.triangles) {
    Corners corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3 p = at(mesh, t[static_cast<int>(k)]);
      corners[k] = {p.x, p.y, p.z};
    }
    triangles.push_back(startingWithLeast(corners));
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

std::vector<Corners> oriented(const ImportedMesh& mesh) {
  std::vector<Corners> triangles;
  for (std::size_t p = 0; p + 1 < mesh.polygonBegin.size(); ++p) {
    const std::uint32_t begin = mesh.polygonBegin[p];
    for (std::uint32_t c = begin + 1; c + 1 < mesh.polygonBegin[p + 1]; ++c) {
      Corners corners{};
      const std::array<std::uint32_t, 3> of{begin, c, c + 1};
      for (std::size_t k = 0; k < 3; ++k) {
        const glm::vec3 q(mesh.positions[mesh.corners[of[k]]]);
        corners[k] = {q.x, q.y, q.z};
      }
      triangles.push_back(startingWithLeast(corners));
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

TemporaryFile::TemporaryFile(std::string_view name, std::string_view bytes) {
  static std::atomic<int> number{0};
  folder_ = std::filesystem::temp_directory_path() /
            ("limn-test-" + std::to_string(::getpid()) + "-" + std::to_string(number++));
  std::filesystem::create_directories(folder_);
  path_ = folder_ / name;
  std::ofstream(path_, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

}  // namespace limn::testing
