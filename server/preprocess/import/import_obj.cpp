// SPDX-License-Identifier: Apache-2.0
// Based on: Wavefront, "Object Files (.obj)", Advanced Visualizer Manual, appendix B1. Only what is
// geometry is read: v, vn, f (and fo, its old name).
#include "server/preprocess/import/import_readers.h"
#include "server/preprocess/import/text_scanner.h"

#include "shared/core/ids.h"

#include <charconv>
#include <map>
#include <string>

namespace limn::import {

namespace {

/// An index as OBJ has it: from 1, or negative and relative to the `count` elements read so far.
std::uint32_t resolveIndex(std::string_view token, std::size_t count) {
  if (!token.empty() && token.front() == '+') token.remove_prefix(1);
  std::int64_t index = 0;
  const auto [stop, error] = std::from_chars(token.data(), token.data() + token.size(), index);
  if (error != std::errc{} || stop != token.data() + token.size()) return kNone;
  if (index < 0) index += static_cast<std::int64_t>(count) + 1;
  return index >= 1 && index < static_cast<std::int64_t>(kNone)
             ? static_cast<std::uint32_t>(index - 1)
             : kNone;
}

class ObjReader {
 public:
  explicit ObjReader(std::string_view text)
      : scanner_(text, {.hashComments = true, .backslashContinuation = true}) {}

  Result<ImportedMesh> read() {
    mesh_.format = "obj";
    do {
      const std::string_view keyword = scanner_.tokenOnLine();
      if (keyword == "v") {
        if (auto done = readVertex(); !done) return tl::unexpected(done.error());
      } else if (keyword == "vn") {
        readNormal();
      } else if (keyword == "f" || keyword == "fo") {
        readFace();
        if (!materials_.empty()) endMaterial(mesh_, material_);
      } else if (keyword == "usemtl") {
        useMaterial(std::string(scanner_.tokenOnLine()));
      } else if (keyword == "l" || keyword == "p") {
        linesOrPoints_ = true;
      }
    } while (scanner_.nextLine());

    if (mesh_.positions.empty()) {
      return fail(
          ErrorCode::kCorrupt,
          "no vertex (\"v x y z\") found: this is not an OBJ mesh; check the file");
    }
    if (mesh_.polygonBegin.size() == 1 && mesh_.droppedFaces == 0) {
      return fail(
          ErrorCode::kUnsupported,
          linesOrPoints_ ? "only lines or points, no face: export the surface too"
                         : "vertices but no face (\"f\"): export the surface, not a point cloud");
    }
    if (mesh_.colors.size() != mesh_.positions.size()) mesh_.colors.clear();
    attachNormals();
    return std::move(mesh_);
  }

 private:
  Result<void> readVertex() {
    double values[6] = {};
    int count = 0;
    for (; count < 6; ++count) {
      const std::string_view token = scanner_.tokenOnLine();
      if (token.empty()) break;
      const Number number = parseNumber(token);
      if (number.status == Number::Status::kTooLarge) {
        return fail(
            ErrorCode::kCorrupt,
            atLine(
                scanner_.line(),
                "a coordinate is beyond the range of a double: rescale the model"));
      }
      if (number.status == Number::Status::kMalformed) {
        if (count < 3) break;
        return addVertex(values, 3);
      }
      values[count] = number.value;
    }
    // A vertex left out would shift every later index: better no mesh than a wrong one.
    if (count < 3) {
      return fail(
          ErrorCode::kCorrupt,
          atLine(
              scanner_.line(),
              "a vertex needs three numbers: the file is damaged or cut; export it again"));
    }
    return addVertex(values, count);
  }

  Result<void> addVertex(const double* values, int count) {
    mesh_.positions.emplace_back(values[0], values[1], values[2]);
    if (count == 6) {
      mesh_.colors.emplace_back(
          linearFromSrgb(values[3]),
          linearFromSrgb(values[4]),
          linearFromSrgb(values[5]));
    }
    return {};
  }

  void readNormal() {
    glm::vec3 normal(0.0F);
    for (int k = 0; k < 3; ++k)
      normal[k] = static_cast<float>(parseNumber(scanner_.tokenOnLine()).value);
    normals_.push_back(normal);
  }

  void readFace() {
    const std::size_t first = mesh_.corners.size();
    for (std::string_view token = scanner_.tokenOnLine(); !token.empty();
         token = scanner_.tokenOnLine()) {
      const std::size_t slash = token.find('/');
      mesh_.corners.push_back(resolveIndex(token.substr(0, slash), mesh_.positions.size()));
      const std::size_t second = slash == token.npos ? slash : token.find('/', slash + 1);
      cornerNormals_.resize(mesh_.corners.size() - 1, kNone);
      cornerNormals_.push_back(
          second == token.npos ? kNone : resolveIndex(token.substr(second + 1), normals_.size()));
    }
    endPolygon(mesh_);
    if (mesh_.corners.size() == first) cornerNormals_.resize(first);
  }

  /// Names tell faces apart; their colours are in another file. 0: faces before the first.
  void useMaterial(const std::string& name) {
    if (materials_.empty()) endMaterial(mesh_, 0);
    const auto next = static_cast<std::uint32_t>(materials_.size()) + 1;
    material_ = materials_.try_emplace(name, next).first->second;
  }

  /// Normals belong to corners; they become the vertices' only where all corners of each agree.
  void attachNormals() {
    if (normals_.empty()) return;
    std::vector<std::uint32_t> chosen(mesh_.positions.size(), kNone);
    for (std::size_t c = 0; c < mesh_.corners.size(); ++c) {
      const std::uint32_t vertex = mesh_.corners[c];
      if (vertex >= chosen.size()) continue;
      if (cornerNormals_[c] >= normals_.size()) return;
      if (chosen[vertex] == kNone) chosen[vertex] = cornerNormals_[c];
      if (normals_[chosen[vertex]] != normals_[cornerNormals_[c]]) return;
    }
    mesh_.normals.reserve(chosen.size());
    for (const std::uint32_t normal : chosen) {
      mesh_.normals.push_back(normal == kNone ? glm::vec3(0.0F) : normals_[normal]);
    }
  }

  TextScanner scanner_;
  ImportedMesh mesh_;
  std::map<std::string, std::uint32_t> materials_;
  std::uint32_t material_ = 0;
  std::vector<glm::vec3> normals_;
  std::vector<std::uint32_t> cornerNormals_;  // one a corner of mesh_
  bool linesOrPoints_ = false;
};

}  // namespace

Result<ImportedMesh> readObj(std::string_view text) {
  return ObjReader(text).read();
}

}  // namespace limn::import
