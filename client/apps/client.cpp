// SPDX-License-Identifier: Apache-2.0
#include "client/apps/render_command.h"
#include "client/apps/render_options.h"
#include "client/apps/sweep_command.h"
#ifdef LIMN_WITH_WINDOW
#include "client/apps/view_command.h"
#endif

#include <cstdio>
#include <string>
#include <vector>

namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

int complain(const limn::Error& error, int status) {
  std::fprintf(stderr, "limn-client: %s\n", error.message.c_str());
  return status;
}

limn::Result<void> run(const limn::CommandLine& commandLine) {
  if (commandLine.render) return limn::runRender(*commandLine.render);
  if (commandLine.sweep) return limn::runSweep(*commandLine.sweep);
#ifdef LIMN_WITH_WINDOW
  if (commandLine.view) return limn::runView(*commandLine.view);
#else
  if (commandLine.view) {
    return limn::fail(
        limn::ErrorCode::kUnsupported,
        "this limn-client was built without a window (LIMN_WITH_WINDOW): use render");
  }
#endif
  std::fputs(commandLine.print.c_str(), stdout);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  const auto commandLine = limn::parseCommandLine(std::vector<std::string>(argv + 1, argv + argc));
  if (!commandLine) return complain(commandLine.error(), kWrongUsage);
  const auto done = run(*commandLine);
  if (done) return 0;
  // A style that does not exist, a camera file that is none: usage, noticed late.
  const bool usage = done.error().code == limn::ErrorCode::kInvalidArgument;
  return complain(done.error(), usage ? kWrongUsage : kFailed);
}
