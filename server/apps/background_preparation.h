// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/apps/model_folder.h"
#include "server/apps/prepare_process.h"
#include "server/session/model_library.h"
#include "server/store/asset_store.h"

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

namespace limn {

/// A line for the log.
struct PreparationNote {
  std::string message;
  std::string model = {};  // it is about; may be empty
  std::uint64_t job = 0;   // the number of the preparation, from the queue to its end; 0: none
};

struct BackgroundOptions {
  std::filesystem::path store;    // directory
  std::filesystem::path models;   // watched folder; empty: none
  std::filesystem::path prepare;  // the limn-prepare program
  PrepareLimits limits;           // of each preparation
  std::int64_t scanEveryMs = 1000;
  std::int64_t collectEveryMs = 60'000;
  std::int64_t collectAgeSeconds = 600;  // younger assets without a name stay
};

/// Keeps the catalogue in step with a folder of mesh files and the names of a store: prepares what
/// is new, changed or damaged, one child process at a time, and collects what nobody names. Polled
/// from the loop thread.
class BackgroundPreparation {
 public:
  using Log = std::function<void(const PreparationNote&)>;

  BackgroundPreparation(
      AssetStore& store,
      ModelLibrary& library,
      BackgroundOptions options,
      Log log);

  /// Takes over the store's names. Errors: kIo.
  [[nodiscard]] Result<void> begin(std::int64_t nowMs);
  void tick(std::int64_t nowMs);
  /// ModelLibrary's OnDamaged.
  void damaged(const std::string& name, const Sha256Digest& asset, const Error& error);
  /// Ends the preparation in progress.
  void stop();

  [[nodiscard]] std::uint64_t finished() const { return finished_; }

  [[nodiscard]] std::uint64_t failed() const { return failed_; }

  /// Why the folder could not be read last time; empty when it could.
  [[nodiscard]] const std::string& folderProblem() const { return folderProblem_; }

 private:
  struct Job {
    std::string name;
    ModelFile file;
    bool quiet = false;        // only makes sure that what the store has is current: stays kReady
    std::uint64_t number = 0;  // given when it is queued
  };

  [[nodiscard]] Result<void> syncNames();
  void scan();
  void enqueue(Job job);
  void startNext();
  void pollRunning();
  void finish(const PrepareProcess::Outcome& outcome);
  void collect();

  AssetStore& store_;
  ModelLibrary& library_;
  BackgroundOptions options_;
  Log log_;
  std::map<std::string, ModelFile> settling_;  // seen once; prepared when they stop changing
  std::map<std::string, ModelFile> known_;     // from the folder: prepared, or queued to be
  std::map<std::string, NameRecord> stored_;   // names of the store
  std::deque<Job> queue_;
  std::optional<Job> running_;
  std::optional<PrepareProcess> process_;
  std::int64_t nextScanMs_ = 0;
  std::int64_t nextCollectMs_ = 0;
  std::string folderProblem_;
  std::uint64_t jobs_ = 0;
  std::uint64_t finished_ = 0;
  std::uint64_t failed_ = 0;
};

}  // namespace limn
