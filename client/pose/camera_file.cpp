// SPDX-License-Identifier: Apache-2.0
#include "client/pose/camera_file.h"

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <string>

namespace limn {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxFileBytes = 1024 * 1024;

tl::unexpected<Error> bad(const std::string& what) {
  return fail(
      ErrorCode::kInvalidArgument,
      "camera " + what +
          R"(: write {"eye":[x,y,z],"target":[x,y,z],"up":[x,y,z],"fov":40,"ortho":false})");
}

Result<glm::dvec3> readVector(const json& object, const char* name, const glm::dvec3* fallback) {
  const auto field = object.find(name);
  if (field == object.end()) {
    if (fallback != nullptr) return *fallback;
    return bad("lacks \"" + std::string(name) + "\"");
  }
  glm::dvec3 v;
  if (!field->is_array() || field->size() != 3) {
    return bad("field \"" + std::string(name) + "\" is not three numbers");
  }
  for (int i = 0; i < 3; ++i) {
    const json& number = (*field)[static_cast<std::size_t>(i)];
    if (!number.is_number() || !std::isfinite(number.get<double>())) {
      return bad("field \"" + std::string(name) + "\" is not three numbers");
    }
    v[i] = number.get<double>();
  }
  return v;
}

}  // namespace

std::string cameraFileJson(const Camera& camera) {
  const auto vector = [](const glm::dvec3& v) { return json{v.x, v.y, v.z}; };
  const nlohmann::ordered_json object = {
      {"eye", vector(camera.eye)},
      {"target", vector(camera.target)},
      {"up", vector(camera.up)},
      {"fov", camera.fovDegrees},
      {"ortho", camera.orthographic}};
  return object.dump();
}

Result<Camera> parseCamera(std::string_view text) {
  const json object = json::parse(text.begin(), text.end(), nullptr, false);
  if (!object.is_object()) return bad("is no JSON object");
  Camera camera;
  const glm::dvec3 defaultUp{0.0, 1.0, 0.0};
  const auto eye = readVector(object, "eye", nullptr);
  if (!eye) return tl::unexpected(eye.error());
  const auto target = readVector(object, "target", nullptr);
  if (!target) return tl::unexpected(target.error());
  const auto up = readVector(object, "up", &defaultUp);
  if (!up) return tl::unexpected(up.error());
  camera.eye = *eye;
  camera.target = *target;
  camera.up = *up;
  if (const auto fov = object.find("fov"); fov != object.end()) {
    if (!fov->is_number()) return bad("field \"fov\" is no number");
    camera.fovDegrees = fov->get<double>();
    if (!(camera.fovDegrees >= 1.0 && camera.fovDegrees <= 170.0)) {
      return bad("field \"fov\" is not 1 to 170 degrees");
    }
  }
  if (const auto ortho = object.find("ortho"); ortho != object.end()) {
    if (!ortho->is_boolean()) return bad("field \"ortho\" is neither true nor false");
    camera.orthographic = ortho->get<bool>();
  }
  const glm::dvec3 gaze = camera.target - camera.eye;
  const double gazeLength = glm::length(gaze);
  const double upLength = glm::length(camera.up);
  if (!(gazeLength > 0.0) || !std::isfinite(gazeLength))
    return bad("has eye and target at one place");
  if (!(upLength > 0.0) || !std::isfinite(upLength) ||
      glm::length(glm::cross(gaze / gazeLength, camera.up / upLength)) < 1e-9) {
    return bad("looks along its own \"up\"");
  }
  return camera;
}

Result<Camera> readCameraFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return fail(ErrorCode::kNotFound, "cannot open camera file " + path.string());
  std::string text(kMaxFileBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (in.bad()) return fail(ErrorCode::kIo, "cannot read camera file " + path.string());
  if (text.size() > kMaxFileBytes) return bad("file " + path.string() + " is far too long");
  auto camera = parseCamera(text);
  if (!camera) return tl::unexpected(camera.error().within(path.string()));
  return camera;
}

}  // namespace limn
