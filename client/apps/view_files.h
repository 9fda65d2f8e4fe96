// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/render_options.h"
#include "client/pose/path_recorder.h"
#include "client/view/choices.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace limn {

/// The files that a window leaves in a folder when it is asked to: pictures, paths of the camera,
/// cameras. No file that is there is ever written over. Threads: one.
class ViewFiles {
 public:
  explicit ViewFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// MODEL-001.png, or the first number that no file and nothing named before has: whoever asks
  /// writes it, at once or later.
  [[nodiscard]] std::filesystem::path name(const std::string& model, const char* extension);

  /// What was named, in order.
  [[nodiscard]] const std::vector<std::string>& named() const { return named_; }

  [[nodiscard]] bool isRecording() const { return recorder_.has_value(); }

  void beginRecording() { recorder_.emplace(); }

  /// A frame of the path, if one is being recorded.
  void record(double nowSeconds, const Camera& camera);

  /// Ends the path and writes it, for `render --path` and load scripts. Returns where; nullopt
  /// where nothing was recorded. Errors: kIo.
  [[nodiscard]] Result<std::optional<std::filesystem::path>> endRecording(const std::string& model);

 private:
  std::filesystem::path folder_;
  std::vector<std::string> named_;
  std::optional<PathRecorder> recorder_;  // while the camera is recorded
};

/// The command that draws what a window shows, for a shell.
[[nodiscard]] std::string renderCommand(
    const SourceOptions& source,
    const std::string& model,
    const ViewChoices& choices,
    const std::filesystem::path& cameraFile);

}  // namespace limn
