// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/osmesa_context.h"

#include <GL/osmesa.h>
#include <dlfcn.h>

#include <array>
#include <cstdint>
#include <string>
#include <utility>

#if defined(__SANITIZE_ADDRESS__)
#define LIMN_LEAK_CHECK 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define LIMN_LEAK_CHECK 1
#endif
#endif
#if defined(LIMN_LEAK_CHECK)
// OSMesa keeps its window buffers in a list of its own for the life of the process: a few hundred
// bytes a context that nobody can free. Weak, so that another user of OSMesa may say the same.
extern "C" __attribute__((weak)) const char* __lsan_default_suppressions() {
  return "leak:libOSMesa.so\n";
}
#endif

namespace limn {
namespace {

struct Osmesa {
  decltype(&OSMesaCreateContextAttribs) createContextAttribs = nullptr;
  decltype(&OSMesaDestroyContext) destroyContext = nullptr;
  decltype(&OSMesaMakeCurrent) makeCurrent = nullptr;
  decltype(&OSMesaGetProcAddress) getProcAddress = nullptr;
};

class OsmesaOffscreenContext final : public OffscreenContext {
 public:
  OsmesaOffscreenContext(const Osmesa& osmesa, OSMesaContext context)
      : osmesa_(osmesa),
        context_(context) {}

  ~OsmesaOffscreenContext() override {
    osmesa_.makeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0);
    osmesa_.destroyContext(context_);
  }

  const gl::Api& api() const override { return api_; }

  Result<void> load() {
    if (osmesa_.makeCurrent(context_, surface_.data(), GL_UNSIGNED_BYTE, kSurface, kSurface) ==
        GL_FALSE) {
      return fail(ErrorCode::kUnavailable, "OSMesa refuses to make its context current");
    }
    auto api = gl::loadApi(osmesa_.getProcAddress);
    if (!api) return tl::unexpected(api.error());
    api_ = *api;
    return {};
  }

 private:
  // OSMesa insists on a window surface; everything is drawn into framebuffer objects.
  static constexpr int kSurface = 4;
  Osmesa osmesa_;
  OSMesaContext context_;
  std::array<std::uint8_t, 4 * kSurface * kSurface> surface_{};
  gl::Api api_;
};

// The library stays loaded: Mesa leaves exit handlers behind.
Result<Osmesa> loadOsmesa(const char* soname) {
  void* library = dlopen(soname, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    return fail(
        ErrorCode::kUnavailable,
        "cannot load " + std::string(soname) + ": install the package libosmesa6");
  }
  Osmesa osmesa;
  const auto resolve = [&](const char* name, auto& function) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
    return function != nullptr;
  };
  if (!resolve("OSMesaCreateContextAttribs", osmesa.createContextAttribs) ||
      !resolve("OSMesaDestroyContext", osmesa.destroyContext) ||
      !resolve("OSMesaMakeCurrent", osmesa.makeCurrent) ||
      !resolve("OSMesaGetProcAddress", osmesa.getProcAddress)) {
    return fail(
        ErrorCode::kUnavailable,
        std::string(soname) + " is too old: install libosmesa6 of Mesa 17 or newer");
  }
  return osmesa;
}

}  // namespace

Result<std::unique_ptr<OffscreenContext>> createOffscreenContext(const char* soname) {
  const auto osmesa = loadOsmesa(soname);
  if (!osmesa) return tl::unexpected(osmesa.error());
  // Core contexts from 4.3 on compile `#version 300 es`.
  constexpr std::array<int, 9> kAttributes = {
      OSMESA_FORMAT,
      OSMESA_RGBA,
      OSMESA_PROFILE,
      OSMESA_CORE_PROFILE,
      OSMESA_CONTEXT_MAJOR_VERSION,
      4,
      OSMESA_CONTEXT_MINOR_VERSION,
      3,
      0};
  OSMesaContext handle = osmesa->createContextAttribs(kAttributes.data(), nullptr);
  if (handle == nullptr) {
    return fail(
        ErrorCode::kUnavailable,
        "OSMesa makes no GL 4.3 core context: install a newer libosmesa6");
  }
  auto context = std::make_unique<OsmesaOffscreenContext>(*osmesa, handle);
  if (auto loaded = context->load(); !loaded) return tl::unexpected(loaded.error());
  return context;
}

}  // namespace limn
