// SPDX-License-Identifier: Apache-2.0
#include "client/pose/recorded_path.h"

#include "client/pose/camera_file.h"

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

namespace limn {
namespace {

using nlohmann::json;

constexpr double kStepSeconds = 0.1;

tl::unexpected<Error> bad(std::size_t entry, const std::string& what) {
  return fail(
      ErrorCode::kInvalidArgument,
      "camera path, entry " + std::to_string(entry + 1) + ": " + what +
          R"(; write [{"t":0,"eye":[x,y,z],"target":[x,y,z],"up":[x,y,z],"fov":40}, …])");
}

}  // namespace

Result<RecordedPath> parseRecordedPath(std::string_view text) {
  const json whole = json::parse(text.begin(), text.end(), nullptr, false);
  const json entries = whole.is_object() ? json::array({whole}) : whole;
  if (!entries.is_array() || entries.empty()) return bad(0, "no camera");
  RecordedPath path;
  for (const json& entry : entries) {
    const auto camera = parseCamera(entry.dump());
    if (!camera) return bad(path.size(), camera.error().message);
    RecordedCamera moment{path.empty() ? 0.0 : path.back().seconds + kStepSeconds, *camera};
    if (const auto t = entry.find("t"); t != entry.end()) {
      if (!t->is_number() || !std::isfinite(t->get<double>()))
        return bad(path.size(), "\"t\" is no number");
      moment.seconds = t->get<double>();
    }
    if (!path.empty() && !(moment.seconds > path.back().seconds))
      return bad(path.size(), "\"t\" must grow");
    path.push_back(moment);
  }
  return path;
}

Result<RecordedPath> readRecordedPath(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return fail(ErrorCode::kNotFound, "cannot open camera path " + file.string());
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (in.bad()) return fail(ErrorCode::kIo, "cannot read camera path " + file.string());
  auto path = parseRecordedPath(text);
  if (!path) return tl::unexpected(path.error().within(file.string()));
  return path;
}

std::string recordedPathJson(const RecordedPath& path) {
  std::string text = "[";
  for (const RecordedCamera& moment : path) {
    // The camera's object, with the time in front.
    text += text.size() == 1 ? "\n" : ",\n";
    text += "{\"t\":" + json(moment.seconds).dump() + "," + cameraFileJson(moment.camera).substr(1);
  }
  return text + "\n]\n";
}

double durationOf(const RecordedPath& path) {
  return path.back().seconds - path.front().seconds;
}

Camera cameraAt(const RecordedPath& path, double seconds) {
  const double moment = path.front().seconds + seconds;
  const auto after = std::ranges::upper_bound(path, moment, {}, &RecordedCamera::seconds);
  if (after == path.begin()) return path.front().camera;
  if (after == path.end()) return path.back().camera;
  const auto before = std::prev(after);
  const double t = (moment - before->seconds) / (after->seconds - before->seconds);
  Camera camera = before->camera;
  camera.eye = glm::mix(before->camera.eye, after->camera.eye, t);
  camera.target = glm::mix(before->camera.target, after->camera.target, t);
  camera.up = glm::mix(before->camera.up, after->camera.up, t);
  camera.fovDegrees = glm::mix(before->camera.fovDegrees, after->camera.fovDegrees, t);
  return camera;
}

}  // namespace limn
