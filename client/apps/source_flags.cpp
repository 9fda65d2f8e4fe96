// SPDX-License-Identifier: Apache-2.0
#include "client/apps/source_flags.h"

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

}  // namespace limn
