// SPDX-License-Identifier: Apache-2.0
#include "shared/gl/osmesa_context.h"

// osmesa.h brings the desktop GL headers, whose types agree with GLES's; only its types are used.
#include "shared/gl/dynamic_library.h"

#include <GL/osmesa.h>

#include <array>
#include <cstdint>
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

struct OsmesaFunctions {
  decltype(&OSMesaCreateContextAttribs) createContextAttribs = nullptr;
  decltype(&OSMesaDestroyContext) destroyContext = nullptr;
  decltype(&OSMesaMakeCurrent) makeCurrent = nullptr;
  decltype(&OSMesaGetProcAddress) getProcAddress = nullptr;
};

class OsmesaContext final : public GlContext {
 public:
  OsmesaContext(const OsmesaFunctions& osmesa, OSMesaContext context)
      : osmesa_(osmesa),
        context_(context) {}

  ~OsmesaContext() override { osmesa_.destroyContext(context_); }

  Result<void> makeCurrent() override {
    if (osmesa_
            .makeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, kSurfaceSize, kSurfaceSize) ==
        GL_FALSE) {
      return fail(ErrorCode::kUnavailable, "OSMesa refuses to make its context current");
    }
    return {};
  }

  const gl::Api& api() const override { return api_; }

  Result<void> load() {
    auto api = gl::loadApi(osmesa_.getProcAddress);
    if (!api) return tl::unexpected(api.error());
    api_ = *api;
    return {};
  }

 private:
  // OSMesa insists on a window surface; everything is drawn into framebuffer objects.
  static constexpr int kSurfaceSize = 4;
  OsmesaFunctions osmesa_;
  OSMesaContext context_;
  std::array<std::uint8_t, 4 * kSurfaceSize * kSurfaceSize> pixels_{};
  gl::Api api_;
};

template <class Function>
bool resolve(const DynamicLibrary& library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(library.symbol(name));
  return function != nullptr;
}

}  // namespace

Result<std::unique_ptr<GlContext>> createOsmesaContext(const char* soname) {
  const auto library = DynamicLibrary::open(soname, "libosmesa6");
  if (!library) return tl::unexpected(library.error());
  OsmesaFunctions osmesa;
  if (!resolve(*library, "OSMesaCreateContextAttribs", osmesa.createContextAttribs) ||
      !resolve(*library, "OSMesaDestroyContext", osmesa.destroyContext) ||
      !resolve(*library, "OSMesaMakeCurrent", osmesa.makeCurrent) ||
      !resolve(*library, "OSMesaGetProcAddress", osmesa.getProcAddress)) {
    return fail(
        ErrorCode::kUnavailable,
        "this OSMesa is too old: install libosmesa6 of Mesa 17 or newer");
  }
  // A core context of 4.5 compiles `#version 300 es` through ARB_ES3_compatibility (4.3 and up).
  for (const auto& [major, minor] : {std::pair{4, 5}, {4, 3}}) {
    const std::array<int, 9> attributes = {
        OSMESA_FORMAT,
        OSMESA_RGBA,
        OSMESA_PROFILE,
        OSMESA_CORE_PROFILE,
        OSMESA_CONTEXT_MAJOR_VERSION,
        major,
        OSMESA_CONTEXT_MINOR_VERSION,
        minor,
        0};
    OSMesaContext handle = osmesa.createContextAttribs(attributes.data(), nullptr);
    if (handle == nullptr) continue;
    auto context = std::make_unique<OsmesaContext>(osmesa, handle);
    if (auto current = context->makeCurrent(); !current) return tl::unexpected(current.error());
    if (auto loaded = context->load(); !loaded) return tl::unexpected(loaded.error());
    return context;
  }
  return fail(
      ErrorCode::kUnavailable,
      "OSMesa makes no GL 4.3 core context: install a newer libosmesa6");
}

}  // namespace limn
