// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol/messages.h"

#include "shared/codec/contour_codec.h"
#include "shared/core/camera.h"
#include "shared/core/sha256.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/progressive/active_mesh.h"
#include "shared/progressive/map_layout.h"
#include "shared/progressive/progressive_hull.h"
#include "shared/silhouette/seed_table.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace limn {

/// The hulls that a model has, or why it has none.
struct HullDescription {
  struct Side {
    std::uint32_t baseFaces = 0;
    std::uint32_t finestFaces = 0;  // ≥ baseFaces
  };

  Side outer;
  Side inner;
  int extraBits = 0;   // their grid's step is the model's / 2^extraBits
  std::string reason;  // not empty: there are none
  std::array<std::optional<protocol::SectionHash>, 2> hashes{};  // of Hull.draco, by side
};

inline constexpr std::size_t kMapKinds = static_cast<std::size_t>(protocol::MapKind::MAX) + 1;

/// A map as it comes.
struct MapFile {
  std::uint32_t bytes = 0;  // 0: there is none
  std::optional<protocol::SectionHash> hash;
};

/// What a client knows of a model before its first split (ModelInfo).
struct ModelDescription {
  std::string name;
  Sha256Digest asset{};
  Grid grid;
  BoundingSphere sphere;       // of the prepared mesh
  std::uint32_t vertices = 0;  // of the full mesh
  std::uint32_t faces = 0;
  bool closed = false;
  std::uint8_t attributeKinds = 0;      // AttributeKind bits
  std::optional<HullDescription> hull;  // unset: the asset knows of none
  std::optional<MapLayout> maps;        // over the outer hull's level of so many faces
  std::array<MapFile, kMapKinds> mapFiles{};
  std::optional<protocol::SectionHash> baseHash;

  /// If not, whyNoHull() says why.
  [[nodiscard]] bool hasHull() const { return hull && hull->reason.empty(); }

  [[nodiscard]] const MapFile& mapFile(protocol::MapKind kind) const {
    return mapFiles[static_cast<std::size_t>(kind)];
  }
};

/// A map over a level of the outer hull, as it came.
struct HullMap {
  MapLayout layout;
  std::vector<std::uint8_t> png;
};

/// Silhouettes of the full mesh that the server found for one view.
struct ExactContour {
  std::uint32_t view = 0;  // its id
  ContourLines lines;
};

/// The client's mesh at one moment. Immutable; crosses threads as shared_ptr<const MeshSnapshot>.
struct MeshSnapshot {
  ModelDescription model;
  ActiveMesh mesh;
  std::shared_ptr<const SeedTable> seeds;            // null until they have arrived
  std::shared_ptr<const ProgressiveHull> outerHull;  // null until asked for and arrived
  std::shared_ptr<const ProgressiveHull> innerHull;
  std::shared_ptr<const HullMap> normalMap;     // null until asked for and arrived
  std::shared_ptr<const HullMap> colorMap;      // the same; sRGB
  std::shared_ptr<const ExactContour> contour;  // the last that came; null: none was asked for
  std::uint64_t revision = 0;                   // grows with every published change
};

}  // namespace limn
