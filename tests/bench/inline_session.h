// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/peer.h"
#include "server/session/task_runner.h"

#include <cstddef>
#include <functional>

namespace limn {

/// Does all work at once, on the thread that asks for it.
class InlineTasks final : public TaskRunner {
 public:
  void submit(TaskUrgency, std::function<void()> work, std::function<void()> done) override {
    work();
    done();
  }

  [[nodiscard]] std::size_t pending() const override { return 0; }
};

/// Of a session that is asked for its messages.
class NoPeer final : public Peer {
 public:
  void wantWrite() override {}
};

}  // namespace limn
