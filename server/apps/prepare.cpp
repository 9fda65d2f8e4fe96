// SPDX-License-Identifier: Apache-2.0
#include "server/apps/arguments.h"
#include "server/apps/confine.h"
#include "server/preprocess/pipeline.h"

#include "protocol/messages.h"

#include "shared/core/exit_status.h"
#include "shared/mesh/ply_writer.h"

#include <CLI/CLI.hpp>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <iostream>
#include <set>
#include <thread>

namespace limn {
namespace {

constexpr char kProgram[] = "limn-prepare";

constexpr char kExamples[] =
    "Examples:\n"
    "  limn-prepare dragon.ply --store assets\n"
    "  limn-prepare scans/*.stl --store assets --quantization 12 --json\n"
    "  limn-prepare part.obj --store assets --name bracket --crease-angle 30 --dump-mesh "
    "prepared.ply";

struct Arguments {
  std::vector<std::string> inputs;
  std::string store;
  std::string name;
  std::string viewpoints = "8x5";
  bool confined = false;
  std::string dumpMesh;
  bool json = false;
  PrepareOptions options;
};

// Names of the inputs; an error says which two would collide.
Result<std::vector<std::string>> chooseNames(const Arguments& arguments) {
  if (!arguments.name.empty() && arguments.inputs.size() != 1) {
    return fail(
        ErrorCode::kInvalidArgument,
        "--name needs a single input; leave it out to use the files' stems");
  }
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const std::string& input : arguments.inputs) {
    names.push_back(
        arguments.name.empty() ? std::filesystem::path(input).stem().string() : arguments.name);
    if (!protocol::isValidModelName(names.back())) {
      return fail(
          ErrorCode::kInvalidArgument,
          "'" + names.back() + "' cannot be a model's name; choose one with --name");
    }
    if (!taken.insert(names.back()).second) {
      return fail(
          ErrorCode::kInvalidArgument,
          "two inputs would be named '" + names.back() +
              "'; prepare one of them on its own with --name");
    }
  }
  return names;
}

bool parseViewpoints(const std::string& text, PrepareOptions& options) {
  char rest = 0;
  return std::sscanf(
             text.c_str(),
             "%dx%d%c",
             &options.seedAzimuths,
             &options.seedElevations,
             &rest) == 2 &&
         options.seedAzimuths >= 1 && options.seedAzimuths <= 64 && options.seedElevations >= 1 &&
         options.seedElevations <= 64;
}

// A bar on a terminal, plain lines otherwise.
Progress progressOf(const std::string& name) {
  const bool isTerminal = isatty(STDERR_FILENO) == 1;
  return [name, isTerminal](std::string_view stage, double done) {
    const int percent = static_cast<int>(100.0 * done);
    if (isTerminal) {
      const auto filled = static_cast<std::size_t>(percent / 4);
      std::cerr << "\r\033[K" << name << " [" << std::string(filled, '#')
                << std::string(25 - filled, ' ') << "] " << stage << (done >= 1.0 ? "\n" : "")
                << std::flush;
    } else {
      std::cerr << "limn-prepare: " << name << ": " << stage << ' ' << percent << "%\n";
    }
  };
}

Result<void> writeFile(const std::string& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file)
    return fail(ErrorCode::kIo, "cannot write " + path + ": check the folder and the free space");
  return {};
}

Result<void> prepareOne(
    const std::string& input,
    const std::string& name,
    const Arguments& arguments,
    AssetStore& store) {
  auto model = prepareModel(input, name, arguments.options, store, progressOf(name));
  if (!model) return tl::unexpected(model.error());
  if (!arguments.dumpMesh.empty()) {
    const TriangleMesh& mesh = model->mesh;
    const auto written = writeFile(
        arguments.dumpMesh,
        encodePly(mesh.grid, mesh.positions, mesh.triangles, mesh.attributes));
    if (!written) return written;
  }
  if (!model->note.empty()) std::cerr << "limn-prepare: " << name << ": " << model->note << '\n';
  if (arguments.json) {
    std::cout << model->reportJson << std::endl;
  } else {
    std::cout << name << ": asset " << toHex(model->asset) << '\n';
  }
  return {};
}

int run(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "Prepares meshes for streaming: repairs them and builds their progressive assets.",
      kProgram);
  app.set_version_flag("--version", std::string("limn-prepare ") + LIMN_VERSION);
  app.footer(kExamples);
  app.add_option("INPUT", arguments.inputs, "Mesh files: PLY, OBJ, STL, OFF, GLB, glTF")
      ->required();
  app.add_option("--store", arguments.store, "Directory of prepared assets; made when missing")
      ->required();
  app.add_option("--name", arguments.name, "Name in the catalogue (default: the file's stem)");
  app.add_option("--quantization", arguments.options.repair.quantizationBits, "Bits a coordinate")
      ->check(CLI::Range(11, 18))
      ->capture_default_str();
  app.add_option("--base-faces", arguments.options.forest.baseFaces, "Faces of the base mesh")
      ->check(CLI::Range(4, 1000000))
      ->capture_default_str();
  const std::map<std::string, CollapseCost> costs = {
      {"volume", CollapseCost::kVolume},
      {"quadric", CollapseCost::kQuadric},
      {"memoryless", CollapseCost::kMemoryless}};
  app.add_option(
         "--cost",
         arguments.options.forest.cost,
         "Which edges collapse first: volume, quadric, memoryless")
      ->transform(CLI::CheckedTransformer(costs))
      ->default_str("memoryless");
  const std::map<std::string, Placement> placements = {
      {"subset", Placement::kSubset},
      {"volume", Placement::kVolume}};
  app.add_option(
         "--placement",
         arguments.options.forest.placement,
         "Where the survivor of a collapse stands: subset (where it stood), volume (where the "
         "volume stays the same: closer at as many faces, more bytes)")
      ->transform(CLI::CheckedTransformer(placements))
      ->default_str("subset");
  app.add_option(
         "--crease-angle",
         arguments.options.forest.creaseAngleDegrees,
         "Sharper edges are creases, degrees")
      ->check(CLI::Range(1.0, 180.0))
      ->capture_default_str();
  app.add_option(
         "--viewpoints",
         arguments.viewpoints,
         "Grid of viewpoints that seeds are prepared for")
      ->capture_default_str();
  app.add_option(
         "--hull-faces",
         arguments.options.hullFaces,
         "Faces of the hulls that have maps and whose volumes are reported")
      ->check(CLI::Range(4, 1000000))
      ->capture_default_str();
  arguments.options.forest.threads = std::max(1U, std::thread::hardware_concurrency());
  app.add_option(
         "--threads",
         arguments.options.forest.threads,
         "Threads; the result does not depend on it")
      ->check(CLI::Range(1, 256));
  app.add_option(
      "--dump-mesh",
      arguments.dumpMesh,
      "Write the prepared mesh to this PLY file (single input)");
  app.add_flag(
      "--confined",
      arguments.confined,
      "Give up the network and other programs before reading: for files of strangers");
  app.add_flag("--json", arguments.json, "Print one JSON report a model");
  if (const auto status = parseArguments(app, argc, argv)) return *status;
  if (!parseViewpoints(arguments.viewpoints, arguments.options)) {
    return complain(
        kProgram,
        kExitUsage,
        "--viewpoints takes AZIMUTHSxELEVATIONS, 1 to 64 each, such as 8x5");
  }
  if (!arguments.dumpMesh.empty() && arguments.inputs.size() != 1) {
    return complain(kProgram, kExitUsage, "--dump-mesh needs a single input");
  }
  if (arguments.confined) {
    if (const auto confined = confineProcess(); !confined) {
      return complain(kProgram, kExitFailed, confined.error().message);
    }
  }
  const auto names = chooseNames(arguments);
  if (!names) return complain(kProgram, kExitUsage, names.error().message);

  const auto store = openDirectoryStore(arguments.store);
  if (!store) return complain(kProgram, kExitFailed, store.error().message);
  int status = kExitSuccess;
  for (std::size_t i = 0; i < names->size(); ++i) {
    const auto done = prepareOne(arguments.inputs[i], (*names)[i], arguments, **store);
    if (!done) status = complain(kProgram, kExitFailed, done.error().message);
  }
  return status;
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(argc, argv);
}
