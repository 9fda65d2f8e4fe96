// SPDX-License-Identifier: Apache-2.0
#include "client/apps/source_flags.h"

#include "client/apps/flag_values.h"
#include "client/net/server_url.h"

#include "protocol/messages.h"

#include <CLI/CLI.hpp>

namespace limn {

void addServerFlags(CLI::App& app, SourceOptions& source) {
  app.add_option("--server", source.serverUrl, "Server to stream from, ws://HOST:PORT")
      ->group(kSourceGroup);
  app.add_option("--model", source.model, "Name of the model on the server")->group(kSourceGroup);
  app.add_option(
         "--token-file",
         source.tokenFile,
         "File with the token that the server asks for (default: $LIMN_TOKEN)")
      ->group(kSourceGroup);
  app.add_option("--ca-file", source.caFile, "Certificates (PEM) to trust for wss://")
      ->group(kSourceGroup);
}

void addSourceFlags(CLI::App& app, SourceOptions& source) {
  addServerFlags(app, source);
  app.add_option(
         "--cache",
         source.cache,
         "Directory where maps that a server sent are kept, 256 MiB at most, or none "
         "($XDG_CACHE_HOME/limn)")
      ->group(kSourceGroup);
  app.add_option("--asset", source.assetDirectory, "Directory of a prepared asset")
      ->group(kSourceGroup);
  app.add_option("--mesh", source.meshFile, "Mesh file, prepared into a temporary store")
      ->group(kSourceGroup);
  app.add_option("--quantization", source.quantizationBits, "Grid bits for --mesh")
      ->check(CLI::Range(11, 18))
      ->group(kSourceGroup);
}

Result<void> checkSource(const SourceOptions& source) {
  const int sources = (source.serverUrl.empty() ? 0 : 1) + (source.assetDirectory.empty() ? 0 : 1) +
                      (source.meshFile.empty() ? 0 : 1);
  if (sources != 1) {
    return wrong(
        "give one source: --server URL --model NAME, or --asset DIRECTORY, or --mesh FILE");
  }
  if (source.serverUrl.empty()) {
    if (!source.model.empty()) return wrong("--model goes with --server");
    if (!source.tokenFile.empty()) return wrong("--token-file goes with --server");
    if (!source.caFile.empty()) return wrong("--ca-file goes with --server");
    return {};
  }
  if (const auto url = parseServerUrl(source.serverUrl); !url) return tl::unexpected(url.error());
  if (source.model.empty()) return wrong("--server needs --model NAME");
  if (!protocol::isValidModelName(source.model)) {
    return wrong("--model is no name that a model can have");
  }
  return {};
}

}  // namespace limn
