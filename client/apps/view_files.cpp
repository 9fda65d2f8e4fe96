// SPDX-License-Identifier: Apache-2.0
#include "client/apps/view_files.h"

#include "client/apps/output_file.h"

#include <algorithm>
#include <cstdio>
#include <system_error>

namespace limn {
namespace {

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word)
    text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

std::filesystem::path ViewFiles::name(const std::string& model, const char* extension) {
  for (int number = 1;; ++number) {
    char suffix[32];
    std::snprintf(suffix, sizeof suffix, "-%03d%s", number, extension);
    std::filesystem::path path = folder_ / (model + suffix);
    std::error_code error;
    if (std::filesystem::exists(path, error) ||
        std::ranges::find(named_, path.string()) != named_.end()) {
      continue;
    }
    named_.push_back(path.string());
    return path;
  }
}

void ViewFiles::record(double nowSeconds, const Camera& camera) {
  if (recorder_) recorder_->add(nowSeconds, camera);
}

Result<std::optional<std::filesystem::path>> ViewFiles::endRecording(const std::string& model) {
  if (!recorder_) return std::nullopt;
  const RecordedPath path = recorder_->path();
  recorder_.reset();
  if (path.empty()) return std::nullopt;
  const std::filesystem::path file = name(model, "-path.json");
  if (auto written = writeOutputFile(file, recordedPathJson(path)); !written) {
    named_.pop_back();
    return tl::unexpected(written.error());
  }
  return file;
}

std::string renderCommand(
    const SourceOptions& source,
    const std::string& model,
    const ViewChoices& choices,
    const std::filesystem::path& cameraFile) {
  std::string command = "limn-client render";
  const auto add = [&](const char* flag, const std::string& value) {
    if (!value.empty()) command += std::string(" ") + flag + " " + quoted(value);
  };
  add("--server", source.serverUrl);
  if (!source.serverUrl.empty()) add("--model", model);
  add("--asset", source.assetDirectory.string());
  add("--mesh", source.meshFile.string());
  for (const std::string& word : flagsOf(choices))
    command += " " + word;
  add("--camera-file", cameraFile.string());
  return command + " --out picture.png";
}

}  // namespace limn
