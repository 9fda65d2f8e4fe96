// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

/// How one model is to be prepared: arguments for limn-prepare.
using PrepareFlags = std::vector<std::string>;

/// Reads a limn.toml: keys are limn-prepare's options without dashes in front (quantization,
/// base-faces, cost, placement, crease-angle, viewpoints, hull-faces, threads); a table
/// [models.NAME] holds what is different for one model.
class PrepareSettings {
 public:
  PrepareSettings() = default;
  /// Errors: kInvalidArgument, naming the line or the key.
  [[nodiscard]] static Result<PrepareSettings> parse(std::string_view toml);
  [[nodiscard]] PrepareFlags flagsFor(const std::string& model) const;

 private:
  [[nodiscard]] static Result<PrepareSettings> read(std::string_view toml);

  std::map<std::string, std::string> common_;
  std::map<std::string, std::map<std::string, std::string>> models_;
};

/// One file to prepare, and all that would make it worth preparing again.
struct ModelFile {
  std::filesystem::path path;
  std::uintmax_t bytes = 0;
  std::int64_t modified = 0;  // ticks of the file's clock
  PrepareFlags flags;
  friend bool operator==(const ModelFile&, const ModelFile&) = default;
};

/// What a look at a folder of models found.
struct FolderScan {
  std::map<std::string, ModelFile> models;  // by name
  std::size_t refusedFiles = 0;             // whose names cannot be a model's
};

/// Lists the mesh files right in a folder; a model is named by its file's stem, and by its whole
/// file name when another file has that stem already. Errors: kIo, kInvalidArgument (limn.toml).
[[nodiscard]] Result<FolderScan> scanModelFolder(const std::filesystem::path& folder);

}  // namespace limn
