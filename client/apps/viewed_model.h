// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/source.h"
#include "client/apps/view_options.h"
#include "client/core/client_session.h"

#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace limn {

/// The model that a window shows, and the change to another, without ever waiting: sources are
/// opened and sessions ended on threads of their own. Threads: one.
class ViewedModel {
 public:
  /// whenReady: wakes the window; any thread.
  ViewedModel(const ViewCommandOptions& options, std::function<void()> whenReady);
  /// Waits for what is under way.
  ~ViewedModel();

  /// Begins with another model of the server (of a file: it is called so), or anew.
  void open(const std::string& model);
  /// Looks after what is under way; to be called often.
  void poll();

  [[nodiscard]] const std::string& name() const { return name_; }

  /// Null until the model is known.
  [[nodiscard]] const ModelDescription* description() const;
  /// Null until there is something to see.
  [[nodiscard]] std::shared_ptr<const MeshSnapshot> snapshot() const;
  [[nodiscard]] ClientSession::Progress progress() const;

  /// Why there is no more to come; empty: there is.
  [[nodiscard]] const std::string& complaint() const { return complaint_; }

  void setView(const ClientView& view);

 private:
  void retire();

  const ViewCommandOptions& options_;
  const std::function<void()> whenReady_;
  std::string name_;
  std::future<Result<Source>> opening_;
  std::unique_ptr<ClientSession> session_;
  std::optional<ModelDescription> description_;
  std::string complaint_;
  std::chrono::steady_clock::time_point retryAt_;  // where there is a complaint
  std::vector<std::future<void>> retired_;         // sessions that are ending
};

}  // namespace limn
