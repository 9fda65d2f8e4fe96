// SPDX-License-Identifier: Apache-2.0
#include "client/apps/command_line.h"
#include "client/apps/render_command.h"
#include "client/apps/sweep_command.h"
#ifdef LIMN_WITH_WINDOW
#include "client/apps/view_command.h"
#endif

#include "shared/core/exit_status.h"

#include <cstdio>
#include <string>
#include <variant>
#include <vector>

namespace limn {
namespace {

int complain(const Error& error, int status) {
  std::fprintf(stderr, "limn-client: %s\n", error.message.c_str());
  return status;
}

Result<void> run(const RenderCommandOptions& options) {
  return runRender(options);
}

Result<void> run(const SweepCommandOptions& options) {
  return runSweep(options);
}

Result<void> run([[maybe_unused]] const ViewCommandOptions& options) {
#ifdef LIMN_WITH_WINDOW
  return runView(options);
#else
  return fail(
      ErrorCode::kUnsupported,
      "this limn-client was built without a window (LIMN_WITH_WINDOW): use render");
#endif
}

Result<void> run(const PrintCommand& command) {
  std::fputs(command.text.c_str(), stdout);
  return {};
}

int run(const std::vector<std::string>& arguments) {
  const auto command = parseCommandLine(arguments);
  if (!command) return complain(command.error(), kExitUsage);
  const auto done = std::visit([](const auto& options) { return run(options); }, *command);
  if (done) return kExitSuccess;
  // A style that does not exist, a camera file that is none: usage, noticed late.
  return complain(done.error(), exitStatusOf(done.error()));
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  return limn::run(std::vector<std::string>(argv + 1, argv + argc));
}
