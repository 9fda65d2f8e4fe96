// SPDX-License-Identifier: Apache-2.0
// Based on: 3D Systems, "StereoLithography Interface Specification", 1989. Facet normals are not
// read: they follow from the corners, and where they do not they are wrong.
#include "server/preprocess/import/import_readers.h"
#include "server/preprocess/import/text_scanner.h"

#include <bit>
#include <cstring>

namespace limn::import {

static_assert(std::endian::native == std::endian::little, "readers assume a little-endian host");

Result<ImportedMesh> readStlBinary(std::string_view bytes) {
  constexpr std::size_t kHeader = 84;
  constexpr std::size_t kFacet = 50;
  if (bytes.size() < kHeader) {
    return fail(
        ErrorCode::kCorrupt,
        "too short for an STL header: this is not an STL file, or it was cut");
  }
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  const std::size_t fits = (bytes.size() - kHeader) / kFacet;
  // A few bytes after the last facet are common; whole facets more or fewer mean a damaged file.
  if (count != fits) {
    return fail(
        ErrorCode::kCorrupt,
        "the STL header promises " + std::to_string(count) + " facets, but the file has room for " +
            std::to_string(fits) + ": it is damaged, cut or not an STL file; export it again");
  }
  if (count == 0)
    return fail(ErrorCode::kUnsupported, "the STL file has no facet: export the surface again");
  ImportedMesh mesh;
  mesh.format = "stl";
  mesh.positions.reserve(3 * std::size_t{count});
  mesh.corners.reserve(3 * std::size_t{count});
  mesh.polygonBegin.reserve(std::size_t{count} + 1);
  for (std::size_t f = 0; f < count; ++f) {
    float corners[9];
    std::memcpy(corners, bytes.data() + kHeader + f * kFacet + 12, sizeof corners);
    for (std::size_t k = 0; k < 9; k += 3) {
      mesh.corners.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.emplace_back(corners[k], corners[k + 1], corners[k + 2]);
    }
    endPolygon(mesh);
  }
  return mesh;
}

namespace {

/// The three numbers after "vertex", or what is wrong with them.
tl::expected<glm::dvec3, std::string_view> parseVertex(TextScanner& scanner) {
  glm::dvec3 position(0.0);
  for (int k = 0; k < 3; ++k) {
    const Number number = parseNumber(scanner.tokenOnLine());
    if (number.status == Number::Status::kTooLarge) {
      return tl::unexpected<std::string_view>("a coordinate is beyond the range of a double");
    }
    if (number.status == Number::Status::kMalformed) {
      return tl::unexpected<std::string_view>("a vertex needs three numbers");
    }
    position[k] = number.value;
  }
  return position;
}

}  // namespace

Result<ImportedMesh> readStlText(std::string_view text) {
  TextScanner scanner(text);
  ImportedMesh mesh;
  mesh.format = "stl";
  const auto broken = [&](std::string_view what) {
    return fail(
        ErrorCode::kCorrupt,
        atLine(scanner.line(), what) + ": the STL file is damaged or cut; export it again");
  };
  bool inFacet = false;
  std::size_t facetBegin = 0;
  for (std::string_view word = scanner.token(); !word.empty(); word = scanner.token()) {
    if (equalsIgnoringCase(word, "vertex")) {
      if (!inFacet) return broken("a vertex outside a facet");
      const auto position = parseVertex(scanner);
      if (!position) return broken(position.error());
      mesh.corners.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(*position);
    } else if (equalsIgnoringCase(word, "facet")) {
      if (inFacet) return broken("a facet inside a facet");
      inFacet = true;
      facetBegin = mesh.corners.size();
      for (int k = 0; k < 4; ++k)
        (void)scanner.tokenOnLine();  // "normal" and its three numbers
    } else if (equalsIgnoringCase(word, "endfacet")) {
      if (!inFacet) return broken("\"endfacet\" without \"facet\"");
      if (mesh.corners.size() - facetBegin < 3)
        return broken("a facet with fewer than three vertices");
      endPolygon(mesh);
      inFacet = false;
    } else if (equalsIgnoringCase(word, "solid") || equalsIgnoringCase(word, "endsolid")) {
      if (inFacet) return broken("a facet without \"endfacet\"");
      scanner.nextLine();  // its name
    } else if (
        !equalsIgnoringCase(word, "outer") && !equalsIgnoringCase(word, "loop") &&
        !equalsIgnoringCase(word, "endloop")) {
      return broken("a word that STL does not have");
    }
  }
  if (inFacet) return broken("a facet without \"endfacet\"");
  if (mesh.positions.empty())
    return fail(ErrorCode::kUnsupported, "the STL file has no facet: export the surface again");
  return mesh;
}

}  // namespace limn::import
