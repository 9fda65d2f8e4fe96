// SPDX-License-Identifier: Apache-2.0
#include "server/apps/background_preparation.h"

#include "server/store/manifest.h"

#include "protocol/messages.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <set>
#include <utility>

namespace limn {
namespace {

namespace fs = std::filesystem;

/// Stands in the catalogue for files whose names cannot.
constexpr char kRefusedName[] = "(odd file name)";

/// The asset that a report of limn-prepare --json names.
std::optional<Sha256Digest> assetOf(const std::string& report) {
  const auto json = nlohmann::json::parse(report, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  const auto asset = json.find("asset");
  if (asset == json.end() || !asset->is_string()) return std::nullopt;
  return digestFromHex(asset->get<std::string>());
}

fs::path fullPath(const fs::path& path) {
  std::error_code error;
  const fs::path full = fs::weakly_canonical(path, error);
  return error ? path : full;
}

}  // namespace

BackgroundPreparation::BackgroundPreparation(
    AssetStore& store,
    ModelLibrary& library,
    BackgroundOptions options,
    Log log)
    : store_(store),
      library_(library),
      options_(std::move(options)),
      log_(std::move(log)) {
  if (!options_.models.empty()) options_.models = fullPath(options_.models);
}

Result<void> BackgroundPreparation::begin(std::int64_t nowMs) {
  if (const auto damagedNames = store_.damagedNames()) {
    for (const std::string& file : *damagedNames) {
      log_({"names/" + file + " is damaged and left out; prepare that model again"});
    }
  }
  if (const auto synced = syncNames(); !synced) return synced;
  nextCollectMs_ = nowMs + options_.collectEveryMs;
  if (!options_.models.empty()) {
    const auto first = scanModelFolder(options_.models);
    if (!first && first.error().code == ErrorCode::kIo) return tl::unexpected(first.error());
  }
  return {};
}

Result<void> BackgroundPreparation::syncNames() {
  const auto names = store_.names();
  if (!names) return tl::unexpected(names.error());
  std::set<std::string> present;
  std::error_code error;
  for (const NameRecord& record : *names) {
    if (!protocol::isValidModelName(record.name)) continue;
    present.insert(record.name);
    // What comes from the folder is followed by its files.
    if (known_.contains(record.name) || (running_ && running_->name == record.name)) continue;
    const auto before = stored_.find(record.name);
    if (before != stored_.end() && before->second.asset == record.asset) continue;
    const fs::path source(record.source);
    const bool ofFolder = !options_.models.empty() && source.parent_path() == options_.models;
    if (ofFolder && !fs::exists(source, error)) {
      // Deleted while no server ran.
      static_cast<void>(store_.removeName(record.name));
      continue;
    }
    stored_[record.name] = record;
    if (!library_.contains(record.name)) library_.setQueued(record.name);
    library_.setAsset(record.name, record.asset);
  }
  std::erase_if(stored_, [&](const auto& entry) {
    const std::string& name = entry.first;
    if (present.contains(name) || known_.contains(name)) return false;
    if (running_ && running_->name == name) return false;
    library_.remove(name);
    return true;
  });
  return {};
}

void BackgroundPreparation::enqueue(Job job) {
  std::erase_if(queue_, [&](const Job& waiting) { return waiting.name == job.name; });
  if (!job.quiet) library_.setQueued(job.name);
  job.number = ++jobs_;
  queue_.push_back(std::move(job));
}

void BackgroundPreparation::scan() {
  const auto found = scanModelFolder(options_.models);
  if (!found) {
    if (folderProblem_ != found.error().message) log_({found.error().message});
    folderProblem_ = found.error().message;
    return;
  }
  folderProblem_.clear();
  if (found->refusedFiles > 0) {
    library_.setFailed(
        kRefusedName,
        "rename the file: a model's name is UTF-8 without control characters and without '/'");
  } else {
    library_.remove(kRefusedName);
  }
  for (const auto& [name, file] : found->models) {
    const auto known = known_.find(name);
    if (known != known_.end() && known->second == file) {
      settling_.erase(name);
      continue;
    }
    // A file that is being copied changes from look to look.
    const auto seen = settling_.find(name);
    if (seen == settling_.end() || seen->second != file) {
      settling_[name] = file;
      if (!library_.contains(name)) library_.setQueued(name);
      continue;
    }
    settling_.erase(name);
    const auto stored = stored_.find(name);
    const bool quiet = known == known_.end() && stored != stored_.end() &&
                       fullPath(stored->second.source) == fullPath(file.path);
    known_[name] = file;
    enqueue({name, file, quiet});
  }
  std::erase_if(settling_, [&](const auto& entry) {
    if (found->models.contains(entry.first)) return false;
    if (!known_.contains(entry.first) && !stored_.contains(entry.first))
      library_.remove(entry.first);
    return true;
  });
  std::erase_if(known_, [&](const auto& entry) {
    const std::string& name = entry.first;
    if (found->models.contains(name)) return false;
    std::erase_if(queue_, [&](const Job& job) { return job.name == name; });
    if (running_ && running_->name == name) process_->stop();
    library_.remove(name);
    static_cast<void>(store_.removeName(name));
    stored_.erase(name);
    log_({"'" + name + "' left the catalogue: its file is gone", name});
    return true;
  });
}

void BackgroundPreparation::startNext() {
  if (process_ || queue_.empty()) return;
  Job job = std::move(queue_.front());
  queue_.pop_front();
  std::vector<std::string> arguments = {
      options_.prepare.string(),
      fullPath(job.file.path).string(),
      "--store",
      options_.store.string(),
      "--name",
      job.name,
      "--json",
      "--confined"};
  arguments.insert(arguments.end(), job.file.flags.begin(), job.file.flags.end());
  auto process = PrepareProcess::start(arguments, options_.limits);
  if (!process) {
    ++failed_;
    log_({"'" + job.name + "': " + process.error().message, job.name, job.number});
    if (!job.quiet) library_.setFailed(job.name, process.error().message);
    return;
  }
  log_({"'" + job.name + "' is being prepared", job.name, job.number});
  if (!job.quiet) library_.setPreparing(job.name, 0.0);
  running_ = std::move(job);
  process_ = std::move(*process);
}

void BackgroundPreparation::pollRunning() {
  if (!process_) return;
  const auto outcome = process_->poll();
  if (!outcome) {
    if (!running_->quiet) library_.setPreparing(running_->name, process_->progress());
    return;
  }
  process_.reset();
  finish(*outcome);
  running_.reset();
}

void BackgroundPreparation::finish(const PrepareProcess::Outcome& outcome) {
  const std::string& name = running_->name;
  // Its file may be gone, or have changed again.
  const auto known = known_.find(name);
  const bool byFolder = known != known_.end();
  const bool current = !byFolder || known->second == running_->file;
  const bool wanted = byFolder || stored_.contains(name);
  if (!outcome.succeeded) {
    if (!wanted) return;
    ++failed_;
    log_({"'" + name + "': " + outcome.reason, name, running_->number});
    // What the store has stays good enough when it could only not be confirmed (a full disk).
    if (current && !running_->quiet) library_.setFailed(name, outcome.reason);
    return;
  }
  ++finished_;
  const auto asset = assetOf(outcome.report);
  if (!asset) {
    ++failed_;
    library_.setFailed(name, "limn-prepare gave no report; are both programs of one version?");
    return;
  }
  if (!wanted) {
    static_cast<void>(store_.removeName(name));
    return;
  }
  stored_[name] = {name, *asset, running_->file.path.string()};
  library_.setAsset(name, *asset);
  if (!running_->quiet) log_({"'" + name + "' is prepared", name, running_->number});
}

void BackgroundPreparation::damaged(
    const std::string& name,
    const Sha256Digest& asset,
    const Error& error) {
  log_({"'" + name + "': " + error.message, name});
  if (error.code == ErrorCode::kCorrupt || error.code == ErrorCode::kUnsupported) {
    static_cast<void>(store_.quarantine(asset));
  }
  const auto fromFolder = known_.find(name);
  if (fromFolder != known_.end()) {
    enqueue({name, fromFolder->second, false});
    return;
  }
  const auto stored = stored_.find(name);
  std::error_code missing;
  if (stored != stored_.end() && !stored->second.source.empty() &&
      fs::exists(stored->second.source, missing)) {
    ModelFile file;
    file.path = stored->second.source;
    enqueue({name, file, false});
  }
}

void BackgroundPreparation::collect() {
  const auto removed = store_.removeUnreferenced(std::chrono::seconds(options_.collectAgeSeconds));
  if (removed && *removed > 0) {
    log_({"collected " + std::to_string(*removed) + " assets that nobody names"});
  } else if (!removed) {
    log_({removed.error().message});
  }
}

void BackgroundPreparation::tick(std::int64_t nowMs) {
  pollRunning();
  if (!options_.models.empty() && nowMs >= nextScanMs_) {
    scan();
  }
  if (nowMs >= nextScanMs_) {
    nextScanMs_ = nowMs + options_.scanEveryMs;
    // Names that others have set: limn-prepare run by hand.
    static_cast<void>(syncNames());
  }
  startNext();
  if (!process_ && nowMs >= nextCollectMs_) {
    nextCollectMs_ = nowMs + options_.collectEveryMs;
    collect();
  }
}

void BackgroundPreparation::stop() {
  queue_.clear();
  process_.reset();
  running_.reset();
}

}  // namespace limn
