// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/camera.h"
#include "shared/core/result.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

/// One moment of a camera path.
struct RecordedCamera {
  double seconds = 0.0;
  Camera camera;
};

/// A camera path, as `limn-client view` records and `render --path` and load scripts play it: at
/// least one moment, times ascending.
using RecordedPath = std::vector<RecordedCamera>;

/// [{"t":seconds, and a camera as parseCamera() reads it}, …]; without "t" a tenth of a second
/// after the moment before. A single camera is a path of one moment. Errors: kInvalidArgument with
/// the entry, kNotFound, kIo.
[[nodiscard]] Result<RecordedPath> parseRecordedPath(std::string_view json);
[[nodiscard]] Result<RecordedPath> readRecordedPath(const std::filesystem::path& file);

/// As parseRecordedPath() reads it, a moment a line.
[[nodiscard]] std::string recordedPathJson(const RecordedPath& path);

/// From the first moment to the last, seconds.
[[nodiscard]] double durationOf(const RecordedPath& path);

/// The camera so long after the first moment, between two moments on the straight line; before the
/// first and after the last it stands. Near and far are not set.
[[nodiscard]] Camera cameraAt(const RecordedPath& path, double seconds);

}  // namespace limn
