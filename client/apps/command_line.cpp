// SPDX-License-Identifier: Apache-2.0
#include "client/apps/command_line.h"

#include "client/apps/flag_values.h"
#include "client/apps/render_flags.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <sstream>

namespace limn {
namespace {

template <class Flags>
Result<Command> commandOf(const Flags& flags) {
  auto options = flags.parse();
  if (!options) return tl::unexpected(options.error());
  return *std::move(options);
}

}  // namespace

Result<Command> parseCommandLine(const std::vector<std::string>& arguments) {
  CLI::App app(
      "Draws a mesh as stylised lines, streamed from a server or from a file.",
      "limn-client");
  app.set_version_flag("--version", std::string("limn-client ") + LIMN_VERSION);
  app.require_subcommand(1);
  CLI::App* render = app.add_subcommand("render", "Draw a picture, write reports and dumps");
  RenderFlags renderFlags;
  renderFlags.addTo(*render);
  app.footer(render->get_footer());
  CLI::App* view = app.add_subcommand("view", "Show a model in a window");
  ViewFlags viewFlags;
  viewFlags.addTo(*view);
  CLI::App* sweep = app.add_subcommand("sweep", "Compare detectors over a camera path");
  SweepFlags sweepFlags;
  sweepFlags.addTo(*sweep);

  try {
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    app.parse(reversed);
  } catch (const CLI::Success& done) {  // --help, --version
    std::ostringstream text;
    std::ostringstream ignored;
    app.exit(done, text, ignored);
    return PrintCommand{text.str()};
  } catch (const CLI::ParseError& error) {
    std::string what = error.what();
    std::replace(what.begin(), what.end(), '\n', ' ');
    if (arguments.empty()) what = "say what to do, for instance render";
    const std::string command = sweep->parsed() ? "sweep" : view->parsed() ? "view" : "render";
    return wrong(what + "; limn-client " + command + " --help has the flags and examples");
  }
  if (view->parsed()) return commandOf(viewFlags);
  if (sweep->parsed()) return commandOf(sweepFlags);
  return commandOf(renderFlags);
}

}  // namespace limn
