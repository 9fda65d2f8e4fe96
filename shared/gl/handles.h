// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/gl/api.h"

#include <utility>

namespace limn::gl {

/// A GL object that is owned: move-only, deleted when it goes out of scope. The context it was made
/// in must then be current, and the Api must outlive it. Threads: the context's.
template <class Traits>
class Handle {
 public:
  Handle() = default;

  [[nodiscard]] static Handle create(const Api& api) { return Handle(&api, Traits::create(api)); }

  ~Handle() { reset(); }

  Handle(Handle&& other) noexcept
      : api_(std::exchange(other.api_, nullptr)),
        id_(std::exchange(other.id_, 0)) {}

  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      api_ = std::exchange(other.api_, nullptr);
      id_ = std::exchange(other.id_, 0);
    }
    return *this;
  }

  [[nodiscard]] GLuint id() const { return id_; }

  [[nodiscard]] explicit operator bool() const { return id_ != 0; }

  void reset() {
    if (id_ != 0) Traits::destroy(*api_, id_);
    id_ = 0;
  }

 private:
  Handle(const Api* api, GLuint id) : api_(api), id_(id) {}

  const Api* api_ = nullptr;
  GLuint id_ = 0;
};

struct BufferTraits {
  static GLuint create(const Api& api) {
    GLuint id = 0;
    api.genBuffers(1, &id);
    return id;
  }

  static void destroy(const Api& api, GLuint id) { api.deleteBuffers(1, &id); }
};

struct TextureTraits {
  static GLuint create(const Api& api) {
    GLuint id = 0;
    api.genTextures(1, &id);
    return id;
  }

  static void destroy(const Api& api, GLuint id) { api.deleteTextures(1, &id); }
};

struct FramebufferTraits {
  static GLuint create(const Api& api) {
    GLuint id = 0;
    api.genFramebuffers(1, &id);
    return id;
  }

  static void destroy(const Api& api, GLuint id) { api.deleteFramebuffers(1, &id); }
};

struct VertexArrayTraits {
  static GLuint create(const Api& api) {
    GLuint id = 0;
    api.genVertexArrays(1, &id);
    return id;
  }

  static void destroy(const Api& api, GLuint id) { api.deleteVertexArrays(1, &id); }
};

struct ProgramTraits {
  static GLuint create(const Api& api) { return api.createProgram(); }

  static void destroy(const Api& api, GLuint id) { api.deleteProgram(id); }
};

using Buffer = Handle<BufferTraits>;
using Texture = Handle<TextureTraits>;
using Framebuffer = Handle<FramebufferTraits>;
using VertexArray = Handle<VertexArrayTraits>;

}  // namespace limn::gl
