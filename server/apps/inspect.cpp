// SPDX-License-Identifier: Apache-2.0
#include "server/apps/inspect.h"

#include "server/apps/arguments.h"
#include "server/inspect/byte_account.h"
#include "server/inspect/inspect_report.h"
#include "server/inspect/rate_distortion.h"
#include "server/session/model.h"
#include "server/store/asset_store.h"
#include "server/store/manifest.h"

#include "shared/core/exit_status.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

namespace limn {
namespace {

namespace fs = std::filesystem;

constexpr char kProgram[] = "limn-server inspect";

constexpr char kExamples[] =
    "Examples:\n"
    "  limn-server inspect dragon --store assets\n"
    "  limn-server inspect assets/assets/75aab538…8a1 --plot dragon.svg\n"
    "  limn-server inspect dragon --store assets --rates --json";

struct Arguments {
  std::string asset;
  std::string store;
  std::string plot;
  bool json = false;
  bool rates = false;
  RateDistortionOptions options;
};

/// A directory of an asset is ROOT/assets/ID.
Result<std::shared_ptr<const Asset>> openAsset(const Arguments& arguments) {
  fs::path root = arguments.store;
  std::string name = arguments.asset;
  if (arguments.store.empty()) {
    const fs::path directory = fs::path(arguments.asset).lexically_normal();
    std::error_code error;
    if (!fs::is_directory(directory, error)) {
      return fail(
          ErrorCode::kNotFound,
          arguments.asset + " is no directory; give an asset's directory, or its name and --store");
    }
    const fs::path leaf = directory.has_filename() ? directory : directory.parent_path();
    name = leaf.filename().string();
    root = fs::absolute(leaf).parent_path().parent_path();
  }
  std::error_code error;
  if (!fs::is_directory(root / "assets", error)) {
    return fail(ErrorCode::kNotFound, root.string() + " is no store; limn-prepare makes one");
  }
  const auto store = openDirectoryStore(root);
  if (!store) return tl::unexpected(store.error());
  if (const auto id = digestFromHex(name)) return (*store)->open(*id);
  const auto names = (*store)->names();
  if (!names) return tl::unexpected(names.error());
  for (const NameRecord& record : *names) {
    if (record.name == name) return (*store)->open(record.asset);
  }
  return fail(ErrorCode::kNotFound, root.string() + " has no model '" + name + "'");
}

Result<void> writePlot(const std::string& path, const std::string& svg) {
  std::ofstream out(path, std::ios::binary);
  out << svg;
  if (!out.flush()) return fail(ErrorCode::kIo, "cannot write " + path);
  return {};
}

Result<void> inspect(const Arguments& arguments) {
  const auto asset = openAsset(arguments);
  if (!asset) return tl::unexpected(asset.error());
  const auto model = Model::load(*asset);
  if (!model) return tl::unexpected(model.error());
  const auto account = accountBytes(**asset, **model);
  if (!account) return tl::unexpected(account.error());
  std::optional<RateDistortion> rates;
  if (arguments.rates || !arguments.plot.empty()) {
    auto measured = measureRateDistortion(**model, *account, arguments.options);
    if (!measured) return tl::unexpected(measured.error());
    rates = std::move(*measured);
  }
  if (!arguments.plot.empty()) {
    if (auto written = writePlot(arguments.plot, ratePlot(**model, *rates)); !written)
      return written;
  }
  if (arguments.json) {
    std::cout << inspectJson(**model, *account, rates ? &*rates : nullptr) << '\n';
  } else {
    std::cout << byteTable(**model, *account);
    if (rates) std::cout << '\n' << rateTable(*rates);
  }
  return {};
}

}  // namespace

int inspectCommand(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Prints where the bytes of a prepared asset go, and what they buy.", kProgram);
  app.footer(kExamples);
  app.add_option("ASSET", arguments.asset, "Directory of an asset; with --store, a name or an id")
      ->required();
  app.add_option("--store", arguments.store, "Store that has it");
  app.add_flag("--json", arguments.json, "One JSON object");
  app.add_flag("--rates", arguments.rates, "Errors against bytes too (some seconds)");
  app.add_option("--plot", arguments.plot, "Errors against bytes as a diagram (SVG)");
  app.add_option("--views", arguments.options.views, "Views that errors are measured in")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  if (const auto status = parseArguments(app, argc, argv)) return *status;
  const auto done = inspect(arguments);
  return done ? kExitSuccess : complain(kProgram, kExitFailed, done.error().message);
}

}  // namespace limn
