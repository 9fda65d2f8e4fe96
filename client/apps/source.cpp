// SPDX-License-Identifier: Apache-2.0
#include "client/apps/source.h"

#include "client/apps/child_process.h"
#include "client/apps/interrupt.h"
#include "client/apps/temporary_directory.h"
#include "client/apps/token.h"
#include "client/net/asset_connection.h"
#include "client/net/asset_files.h"
#include "client/net/cache_directory.h"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

namespace limn {
namespace {

/// The last line with something in it.
std::string lastLine(const std::string& text) {
  const std::size_t end = text.find_last_not_of(" \n\r\t");
  if (end == std::string::npos) return {};
  const std::size_t begin = text.find_last_of("\n\r", end);
  return text.substr(
      begin == std::string::npos ? 0 : begin + 1,
      end - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

/// The id of the asset that `limn-prepare --json` says it made.
Result<std::string> assetIdOf(const std::string& output) {
  const auto report = nlohmann::json::parse(output, nullptr, false);
  const auto* object = &report;
  if (report.is_array() && !report.empty()) object = &report.front();
  if (object->is_object() && object->contains("asset") && (*object)["asset"].is_string()) {
    return (*object)["asset"].get<std::string>();
  }
  return fail(ErrorCode::kProtocol, "limn-prepare did not say which asset it made");
}

Result<Source> openMeshSource(const SourceOptions& options) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(options.meshFile, error)) {
    return fail(ErrorCode::kNotFound, "there is no mesh file " + options.meshFile.string());
  }
  const auto store = TemporaryDirectory::create();
  if (!store) return tl::unexpected(store.error());
  const std::filesystem::path input = std::filesystem::absolute(options.meshFile, error);
  const auto child = runChild(
      {siblingProgram("limn-prepare"),
       input.string(),
       "--store",
       (*store)->path().string(),
       "--name",
       "mesh",
       "--quantization",
       std::to_string(options.quantizationBits),
       "--json"},
      interrupted);
  if (!child) return tl::unexpected(child.error());
  if (child->exitCode >= 128) {
    return fail(
        ErrorCode::kUnsupported,
        "limn-prepare was ended by signal " + std::to_string(child->exitCode - 128) + " on " +
            options.meshFile.string() + ": out of memory, or a bug worth reporting");
  }
  if (child->exitCode != 0) {
    std::string why = lastLine(child->complaint);
    constexpr std::string_view kPrefix = "limn-prepare: ";
    if (why.starts_with(kPrefix)) why.erase(0, kPrefix.size());
    if (why.empty()) why = "limn-prepare ended with status " + std::to_string(child->exitCode);
    return fail(ErrorCode::kCorrupt, why);
  }
  const auto id = assetIdOf(child->output);
  if (!id) return tl::unexpected(id.error());
  auto source = openAssetSource((*store)->path() / "assets" / *id);
  return source;
}

/// Where the desktop keeps what programs can get again (XDG base directories); empty: nowhere.
std::filesystem::path usualCache() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && *cache == '/') return std::filesystem::path(cache) / "limn";
  const char* home = std::getenv("HOME");
  if (home == nullptr || *home == '\0') return {};
  return std::filesystem::path(home) / ".cache/limn";
}

std::shared_ptr<SectionCache> cacheOf(const SourceOptions& options) {
  if (options.cache == "none") return nullptr;
  std::filesystem::path path = options.cache;
  if (path.empty()) path = usualCache();
  return path.empty() ? nullptr : openCacheDirectory({.path = std::move(path)});
}

}  // namespace

Result<LwsConnectionOptions> serverOf(const SourceOptions& options) {
  LwsConnectionOptions server;
  auto url = parseServerUrl(options.serverUrl);
  if (!url) return tl::unexpected(url.error());
  server.url = std::move(*url);
  auto token = readToken(options.tokenFile);
  if (!token) return tl::unexpected(token.error());
  server.token = std::move(*token);
  server.caFile = options.caFile.string();
  return server;
}

Result<Source> openAssetSource(const std::filesystem::path& directory) {
  auto files = readAssetFiles(directory);
  if (!files) return tl::unexpected(files.error());
  const auto shared = std::make_shared<const AssetFiles>(std::move(*files));
  return Source{shared->name, [shared] { return makeAssetConnection(shared); }};
}

Result<Source> openSource(const SourceOptions& options) {
  if (!options.serverUrl.empty()) {
    const auto server = serverOf(options);
    if (!server) return tl::unexpected(server.error());
    return Source{
        options.model,
        [server = *server] { return makeLwsConnection(server); },
        true,
        cacheOf(options)};
  }
  if (!options.assetDirectory.empty()) return openAssetSource(options.assetDirectory);
  return openMeshSource(options);
}

}  // namespace limn
