// SPDX-License-Identifier: Apache-2.0
#include "client/render/assets.h"

#include <algorithm>
#include <system_error>

namespace limn {
namespace {

bool holdsStyles(const std::filesystem::path& folder) {
  return !listStyles(folder).empty();
}

}  // namespace

Result<std::filesystem::path> findAssets(const std::optional<std::filesystem::path>& chosen) {
  if (chosen) {
    if (holdsStyles(*chosen)) return *chosen;
    return fail(
        ErrorCode::kNotFound,
        "no texture set in " + chosen->string() +
            ": --assets wants the folder that holds NAME/style.toml");
  }
  std::error_code failed;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", failed);
  const auto installed =
      (failed ? std::filesystem::path(".") : program.parent_path().parent_path()) /
      "share/limn/assets";
  const std::filesystem::path source = LIMN_SOURCE_ASSETS;
  for (const auto& candidate : {installed, source}) {
    if (holdsStyles(candidate)) return candidate;
  }
  return fail(
      ErrorCode::kNotFound,
      "no texture sets in " + installed.string() + " nor " + source.string() +
          ": reinstall Limn or give --assets DIR");
}

std::vector<std::string> listStyles(const std::filesystem::path& assets) {
  std::vector<std::string> names;
  std::error_code failed;
  for (std::filesystem::directory_iterator it(assets, failed), end; !failed && it != end;
       it.increment(failed)) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(it->path() / "style.toml", ignored)) {
      names.push_back(it->path().filename().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace limn
