// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/gl/handles.h"

#include <glm/glm.hpp>

#include <string_view>

namespace limn::gl {

/// A linked vertex and fragment shader, with a geometry shader between them where there is one.
/// Uniforms are set by name on the program in use; a name the compiler optimised away is ignored,
/// as GL does.
class Program {
 public:
  Program() = default;

  struct Sources {
    std::string_view vertex;
    std::string_view geometry = {};  // empty: no such stage; GLES 3.2 has it, 3.0 does not
    std::string_view fragment;
  };

  /// Compiles and links `#version 300 es` sources (with a geometry shader: 320 es). name: for
  /// messages. Errors: kUnavailable, with the stage and the compiler's log on one line.
  [[nodiscard]] static Result<Program>
  build(const Api& api, std::string_view name, const Sources& sources);
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
  void set(const char* uniform, glm::vec4 value) const;
  void set(const char* uniform, const glm::mat4& value) const;

 private:
  const Api* api_ = nullptr;
  Handle<ProgramTraits> handle_;
};

}  // namespace limn::gl
