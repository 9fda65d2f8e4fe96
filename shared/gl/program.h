// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/gl/handles.h"

#include <glm/glm.hpp>

#include <string_view>

namespace limn::gl {

/// A linked vertex and fragment shader. Uniforms are set by name on the program in use; a name the
/// compiler optimised away is ignored, as GL does.
class Program {
 public:
  Program() = default;

  /// Compiles and links `#version 300 es` sources. name: for messages.
  /// Errors: kUnavailable, with the stage and the compiler's log on one line.
  [[nodiscard]] static Result<Program> build(
      const Api& api,
      std::string_view name,
      std::string_view vertexSource,
      std::string_view fragmentSource);

  void use() const { api_->useProgram(handle_.id()); }

  void set(const char* uniform, int value) const;
  void set(const char* uniform, float value) const;
  void set(const char* uniform, glm::vec2 value) const;
  void set(const char* uniform, glm::ivec2 value) const;
  void set(const char* uniform, glm::vec3 value) const;
  void set(const char* uniform, const glm::mat4& value) const;

 private:
  const Api* api_ = nullptr;
  Handle<ProgramTraits> handle_;
};

}  // namespace limn::gl
