// SPDX-License-Identifier: Apache-2.0
#include "shared/gl/program.h"

#include <algorithm>
#include <string>

namespace limn::gl {
namespace {

std::string oneLine(std::string log) {
  while (!log.empty() && (log.back() == '\n' || log.back() == '\0' || log.back() == ' '))
    log.pop_back();
  std::replace(log.begin(), log.end(), '\n', ';');
  return log.empty() ? std::string("no log") : log;
}

std::string_view nameOf(GLenum stage) {
  return stage == GL_VERTEX_SHADER     ? "vertex"
         : stage == GL_GEOMETRY_SHADER ? "geometry"
                                       : "fragment";
}

/// The shader's id; it must be deleted. Errors: kUnavailable.
Result<GLuint>
compile(const Api& api, GLenum stage, std::string_view name, std::string_view source) {
  const GLuint shader = api.createShader(stage);
  const char* text = source.data();
  const auto length = static_cast<GLint>(source.size());
  api.shaderSource(shader, 1, &text, &length);
  api.compileShader(shader);
  GLint ok = GL_FALSE;
  api.getShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok == GL_TRUE) return shader;
  std::string log(2048, '\0');
  GLsizei written = 0;
  api.getShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &written, log.data());
  log.resize(static_cast<std::size_t>(std::max(written, 0)));
  api.deleteShader(shader);
  return fail(
      ErrorCode::kUnavailable,
      std::string(nameOf(stage)) + " shader of '" + std::string(name) +
          "' does not compile on this GL: " + oneLine(log));
}

}  // namespace

Result<Program> Program::build(
    const Api& api,
    std::string_view name,
    std::string_view vertexSource,
    std::string_view fragmentSource) {
  return build(api, name, {.vertex = vertexSource, .fragment = fragmentSource});
}

Result<Program> Program::build(const Api& api, std::string_view name, const Sources& sources) {
  struct Stage {
    GLenum type;
    std::string_view source;
  };

  const Stage stages[] = {
      {GL_VERTEX_SHADER, sources.vertex},
      {GL_GEOMETRY_SHADER, sources.geometry},
      {GL_FRAGMENT_SHADER, sources.fragment}};
  Program program;
  program.api_ = &api;
  program.handle_ = Handle<ProgramTraits>::create(api);
  for (const Stage& stage : stages) {
    if (stage.source.empty()) continue;
    const auto shader = compile(api, stage.type, name, stage.source);
    if (!shader) return tl::unexpected(shader.error());
    api.attachShader(program.handle_.id(), *shader);
    api.deleteShader(*shader);  // it lives on until its program goes
  }
  api.linkProgram(program.handle_.id());
  GLint ok = GL_FALSE;
  api.getProgramiv(program.handle_.id(), GL_LINK_STATUS, &ok);
  if (ok == GL_TRUE) return program;
  std::string log(2048, '\0');
  GLsizei written = 0;
  api.getProgramInfoLog(
      program.handle_.id(),
      static_cast<GLsizei>(log.size()),
      &written,
      log.data());
  log.resize(static_cast<std::size_t>(std::max(written, 0)));
  return fail(
      ErrorCode::kUnavailable,
      "the shaders of '" + std::string(name) + "' do not link on this GL: " + oneLine(log));
}

void Program::set(const char* uniform, int value) const {
  api_->uniform1i(api_->getUniformLocation(handle_.id(), uniform), value);
}

void Program::set(const char* uniform, float value) const {
  api_->uniform1f(api_->getUniformLocation(handle_.id(), uniform), value);
}

void Program::set(const char* uniform, glm::vec2 value) const {
  api_->uniform2f(api_->getUniformLocation(handle_.id(), uniform), value.x, value.y);
}

void Program::set(const char* uniform, glm::ivec2 value) const {
  api_->uniform2i(api_->getUniformLocation(handle_.id(), uniform), value.x, value.y);
}

void Program::set(const char* uniform, glm::vec3 value) const {
  api_->uniform3f(api_->getUniformLocation(handle_.id(), uniform), value.x, value.y, value.z);
}

void Program::set(const char* uniform, glm::vec4 value) const {
  api_->uniform4f(
      api_->getUniformLocation(handle_.id(), uniform),
      value.x,
      value.y,
      value.z,
      value.w);
}

void Program::set(const char* uniform, const glm::mat4& value) const {
  api_->uniformMatrix4fv(
      api_->getUniformLocation(handle_.id(), uniform),
      1,
      GL_FALSE,
      &value[0][0]);
}

}  // namespace limn::gl
