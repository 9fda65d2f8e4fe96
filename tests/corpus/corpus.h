// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/triangle_mesh.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Meshes for tests, handed out by property. Generated shapes are always there; real models join in
/// when a folder of them is: $LIMN_MODELS, or ../shared/models beside the repository. All went
/// through the same import and repair as in limn-prepare, so each is an oriented manifold on a
/// 14-bit grid. Everything is loaded at its first use and kept for the life of the process. CTest
/// runs each case in a process of its own, so ask for no more than the case needs.
namespace limn::corpus {

struct Mesh {
  std::string name;  // "torus", or the file's name: "bunny-low.off"
  TriangleMesh mesh;
  bool closed = false;
};

/// How large the real models handed out may be.
enum class Size {
  kSmall,   // files below 600 kB, some 10 to 15 thousand faces: property tests over every mesh
  kMedium,  // files below 4 MB, up to some 200 thousand faces: one pass over each
  kAll,     // everything, the Stanford dragon's 871,414 faces included
};

/// Generated shapes only: closed ones first, open ones last, 4 to 20,000 faces.
[[nodiscard]] std::span<const Mesh> generated();

/// Generated and real meshes without a border; with one; of both kinds.
[[nodiscard]] std::vector<const Mesh*> closedMeshes(Size size = Size::kSmall);
[[nodiscard]] std::vector<const Mesh*> openMeshes(Size size = Size::kSmall);
[[nodiscard]] std::vector<const Mesh*> allGood(Size size = Size::kSmall);

/// The folder of real models, if there is one. A test that cannot do without says
/// `if (!corpus::modelsFolder()) GTEST_SKIP() << corpus::kNoModels;`.
[[nodiscard]] std::optional<std::filesystem::path> modelsFolder();
inline constexpr char kNoModels[] = "no real models: set LIMN_MODELS to a folder of meshes";

/// The good model files, by name; smallest files first.
[[nodiscard]] std::vector<std::filesystem::path> modelFiles(Size size = Size::kAll);

/// One real model by file name ("bunny-closed.ply"), null when it is not there or was refused.
[[nodiscard]] const Mesh* model(const std::string& fileName);

/// What import or repair said about each model that it refused so far: a bug or a bad model.
[[nodiscard]] std::vector<std::string> failures();

}  // namespace limn::corpus
