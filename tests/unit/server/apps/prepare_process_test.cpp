// SPDX-License-Identifier: Apache-2.0
#include "server/apps/prepare_process.h"

#include <gtest/gtest.h>

#include <thread>

namespace limn {
namespace {

struct Ended {
  PrepareProcess::Outcome outcome;
  double progress = 0.0;
};

Ended endOf(const std::string& script) {
  auto process = PrepareProcess::start({"/bin/sh", "-c", script});
  EXPECT_TRUE(process);
  while (true) {
    if (auto outcome = process->poll()) return {*outcome, process->progress()};
    std::this_thread::yield();
  }
}

TEST(PrepareProcess, GivesTheReportOfASuccess) {
  const auto [outcome, progress] =
      endOf("echo 'limn-prepare: a: simplify 42%' >&2; echo '{\"asset\":1}'");
  EXPECT_TRUE(outcome.succeeded);
  EXPECT_EQ(outcome.report, "{\"asset\":1}\n");
  EXPECT_DOUBLE_EQ(progress, 0.42);
}

TEST(PrepareProcess, GivesTheReasonOfAFailure) {
  const auto outcome =
      endOf("echo 'a: 10%' >&2; echo 'limn-prepare: a.ply: no faces' >&2; exit 1").outcome;
  EXPECT_FALSE(outcome.succeeded);
  EXPECT_EQ(outcome.reason, "a.ply: no faces");
}

TEST(PrepareProcess, SaysWhenASignalEndedIt) {
  const auto outcome = endOf("kill -SEGV $$").outcome;
  EXPECT_FALSE(outcome.succeeded);
  EXPECT_NE(outcome.reason.find("signal 11"), std::string::npos);
}

TEST(PrepareProcess, SurvivesMoreOutputThanAPipeHolds) {
  const auto outcome =
      endOf(
          "i=0; while [ $i -lt 3000 ]; do echo '0123456789012345678901234567890123456789'; "
          "echo '0123456789012345678901234567890123456789' >&2; i=$((i+1)); done")
          .outcome;
  EXPECT_TRUE(outcome.succeeded);
  EXPECT_EQ(outcome.report.size(), 3000U * 41U);
}

TEST(PrepareProcess, MayTakeOnlySoMuch) {
  // The limits come right after it has begun.
  auto process = PrepareProcess::start(
      {"/bin/sh", "-c", "until [ $(ulimit -t) = 77 ]; do :; done; ulimit -v; ulimit -t"},
      {std::uint64_t{1} << 30, 77});
  ASSERT_TRUE(process);
  std::optional<PrepareProcess::Outcome> outcome;
  while (!(outcome = process->poll()))
    std::this_thread::yield();
  EXPECT_EQ(outcome->report, "1048576\n77\n");
}

TEST(PrepareProcess, SaysWhenTheProgramIsMissing) {
  const auto process = PrepareProcess::start({"/nonexistent/limn-prepare"});
  ASSERT_FALSE(process);
  EXPECT_NE(process.error().message.find("/nonexistent/limn-prepare"), std::string::npos);
}

TEST(PrepareProcess, EndsWithItsObject) {
  auto process = PrepareProcess::start({"/bin/sh", "-c", "while :; do :; done"});
  ASSERT_TRUE(process);
  EXPECT_FALSE(process->poll());
  // Destroyed here: killed and waited for, or this test would leave a process behind.
}

}  // namespace
}  // namespace limn
