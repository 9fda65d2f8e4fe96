// SPDX-License-Identifier: Apache-2.0
#include "client/apps/render_command.h"
#include "client/apps/render_options.h"
#include "client/apps/sweep_command.h"

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

}  // namespace

int main(int argc, char** argv) {
  const auto commandLine = limn::parseCommandLine(std::vector<std::string>(argv + 1, argv + argc));
  if (!commandLine) return complain(commandLine.error(), kWrongUsage);
  if (!commandLine->render && !commandLine->sweep) {
    std::fputs(commandLine->print.c_str(), stdout);
    return 0;
  }
  const auto done = commandLine->sweep ? limn::runSweep(*commandLine->sweep)
                                       : limn::runRender(*commandLine->render);
  if (done) return 0;
  // A style that does not exist, a camera file that is none: usage, noticed late.
  const bool usage = done.error().code == limn::ErrorCode::kInvalidArgument;
  return complain(done.error(), usage ? kWrongUsage : kFailed);
}
