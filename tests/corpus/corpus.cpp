// SPDX-License-Identifier: Apache-2.0
#include "tests/corpus/corpus.h"

#include "server/preprocess/import/import.h"
#include "server/preprocess/repair/repair.h"

#include "shared/mesh/primitives.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>

namespace limn::corpus {
namespace {

/// Real models loaded so far, by file name; a null entry was refused.
struct Cache {
  std::mutex mutex;
  std::map<std::string, std::unique_ptr<const Mesh>> meshes;
  std::vector<std::string> failures;
};

Cache& cache() {
  static Cache instance;
  return instance;
}

std::uintmax_t maxBytes(Size size) {
  switch (size) {
    case Size::kSmall:
      return 600'000;
    case Size::kMedium:
      return 4'000'000;
    case Size::kAll:
      break;
  }
  return UINTMAX_MAX;
}

bool isMeshFile(const std::filesystem::path& file) {
  static constexpr std::array<std::string_view, 6>
      kExtensions{".ply", ".obj", ".stl", ".off", ".glb", ".gltf"};
  const std::string extension = file.extension().string();
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

const Mesh* load(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  Cache& all = cache();
  const std::scoped_lock lock(all.mutex);
  if (const auto found = all.meshes.find(name); found != all.meshes.end()) {
    return found->second.get();
  }
  std::unique_ptr<const Mesh>& entry = all.meshes[name];
  const auto imported = importMesh(file);
  if (!imported) {
    all.failures.push_back(name + ": " + imported.error().message);
    return nullptr;
  }
  auto repaired = repairMesh(*imported, RepairOptions{});
  if (!repaired) {
    all.failures.push_back(name + ": " + repaired.error().message);
    return nullptr;
  }
  entry = std::make_unique<const Mesh>(Mesh{name, std::move(repaired->mesh), repaired->closed});
  return entry.get();
}

enum class Border { kWithout, kWith, kEither };

std::vector<const Mesh*> select(Size size, Border border) {
  std::vector<const Mesh*> chosen;
  const auto offer = [&](const Mesh* mesh) {
    if (mesh != nullptr &&
        (border == Border::kEither || mesh->closed == (border == Border::kWithout))) {
      chosen.push_back(mesh);
    }
  };
  for (const Mesh& mesh : generated()) {
    offer(&mesh);
  }
  for (const std::filesystem::path& file : modelFiles(size)) {
    offer(load(file));
  }
  return chosen;
}

}  // namespace

std::span<const Mesh> generated() {
  static const std::vector<Mesh> shapes = [] {
    std::vector<Mesh> made;
    made.push_back({"tetrahedron", primitives::tetrahedron(), true});
    made.push_back({"cube", primitives::cube(), true});
    made.push_back({"icosphere", primitives::icosphere(4), true});
    made.push_back({"torus", primitives::torus(48, 24), true});
    made.push_back({"torus-knot", primitives::torusKnot(2, 3, 240, 20), true});
    made.push_back({"bumpy-sphere", primitives::bumpySphere(5, 7), true});
    made.push_back({"open-grid", primitives::openGrid(40, 30), false});
    return made;
  }();
  return shapes;
}

std::vector<const Mesh*> closedMeshes(Size size) {
  return select(size, Border::kWithout);
}

std::vector<const Mesh*> openMeshes(Size size) {
  return select(size, Border::kWith);
}

std::vector<const Mesh*> allGood(Size size) {
  return select(size, Border::kEither);
}

std::optional<std::filesystem::path> modelsFolder() {
  std::error_code ignored;
  // An empty LIMN_MODELS means: none, even if the folder beside the repository exists.
  if (const char* chosen = std::getenv("LIMN_MODELS"); chosen != nullptr) {
    return std::filesystem::is_directory(chosen, ignored)
               ? std::optional(std::filesystem::path(chosen))
               : std::nullopt;
  }
  std::filesystem::path beside =
      std::filesystem::path(LIMN_SOURCE_DIR).parent_path() / "shared" / "models";
  return std::filesystem::is_directory(beside, ignored) ? std::optional(std::move(beside))
                                                        : std::nullopt;
}

std::vector<std::filesystem::path> modelFiles(Size size) {
  const auto folder = modelsFolder();
  std::vector<std::pair<std::uintmax_t, std::filesystem::path>> found;
  std::error_code ignored;
  if (folder) {
    for (const auto& entry : std::filesystem::directory_iterator(*folder, ignored)) {
      if (entry.is_regular_file(ignored) && isMeshFile(entry.path()) &&
          entry.file_size(ignored) < maxBytes(size)) {
        found.emplace_back(entry.file_size(ignored), entry.path());
      }
    }
  }
  std::sort(found.begin(), found.end());
  std::vector<std::filesystem::path> files;
  for (auto& [bytes, file] : found) {
    files.push_back(std::move(file));
  }
  return files;
}

const Mesh* model(const std::string& fileName) {
  const auto folder = modelsFolder();
  std::error_code ignored;
  if (!folder || !std::filesystem::is_regular_file(*folder / fileName, ignored)) {
    return nullptr;
  }
  return load(*folder / fileName);
}

std::vector<std::string> failures() {
  Cache& all = cache();
  const std::scoped_lock lock(all.mutex);
  return all.failures;
}

}  // namespace limn::corpus
