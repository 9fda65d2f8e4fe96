// SPDX-License-Identifier: Apache-2.0
#include "client/render/egl_context.h"

#define EGL_NO_X11
#include "shared/gl/dynamic_library.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

namespace limn {
namespace {

struct EglFunctions {
  decltype(&eglGetProcAddress) getProcAddress = nullptr;
  decltype(&eglQueryString) queryString = nullptr;
  decltype(&eglInitialize) initialize = nullptr;
  decltype(&eglTerminate) terminate = nullptr;
  decltype(&eglBindAPI) bindApi = nullptr;
  decltype(&eglChooseConfig) chooseConfig = nullptr;
  decltype(&eglCreateContext) createContext = nullptr;
  decltype(&eglDestroyContext) destroyContext = nullptr;
  decltype(&eglMakeCurrent) makeCurrent = nullptr;
  // Extensions; null when absent.
  PFNEGLGETPLATFORMDISPLAYEXTPROC getPlatformDisplay = nullptr;
  PFNEGLQUERYDEVICESEXTPROC queryDevices = nullptr;
  PFNEGLQUERYDEVICESTRINGEXTPROC queryDeviceString = nullptr;
};

bool contains(const char* list, const char* word) {
  return list != nullptr && std::strstr(list, word) != nullptr;
}

class EglContext final : public GlContext {
 public:
  EglContext(const EglFunctions& egl, EGLDisplay display) : egl_(egl), display_(display) {}

  ~EglContext() override {
    if (context_ != EGL_NO_CONTEXT) {
      egl_.makeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      egl_.destroyContext(display_, context_);
    }
    // The display is not terminated: it is one per process, and other contexts may share it.
  }

  /// The display is initialised. Errors: kUnavailable.
  Result<void> create() {
    if (!contains(egl_.queryString(display_, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context")) {
      return fail(ErrorCode::kUnavailable, "the EGL driver draws only into windows");
    }
    egl_.bindApi(EGL_OPENGL_ES_API);
    const std::array<EGLint, 5> wanted =
        {EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint found = 0;
    if (egl_.chooseConfig(display_, wanted.data(), &config, 1, &found) == EGL_FALSE || found == 0) {
      return fail(ErrorCode::kUnavailable, "the EGL driver has no GLES 3");
    }
    const std::array<EGLint, 3> attributes = {EGL_CONTEXT_CLIENT_VERSION, 3, EGL_NONE};
    context_ = egl_.createContext(display_, config, EGL_NO_CONTEXT, attributes.data());
    if (context_ == EGL_NO_CONTEXT) {
      return fail(ErrorCode::kUnavailable, "the EGL driver makes no GLES 3 context");
    }
    if (auto current = makeCurrent(); !current) return current;
    auto api = gl::loadApi(reinterpret_cast<gl::GetProcAddress>(egl_.getProcAddress));
    if (!api) return tl::unexpected(api.error());
    api_ = *api;
    return {};
  }

  Result<void> makeCurrent() override {
    // Another GlContext of the process may have bound another API on this thread.
    egl_.bindApi(EGL_OPENGL_ES_API);
    if (egl_.makeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE) {
      return fail(ErrorCode::kUnavailable, "EGL refuses to make its context current");
    }
    return {};
  }

  const gl::Api& api() const override { return api_; }

 private:
  EglFunctions egl_;
  EGLDisplay display_;
  EGLContext context_ = EGL_NO_CONTEXT;
  gl::Api api_;
};

template <class Function>
bool resolve(const DynamicLibrary& library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(library.symbol(name));
  return function != nullptr;
}

/// Displays to try, best first: hardware devices, Mesa's surfaceless platform, software devices.
std::vector<EGLDisplay> candidateDisplays(const EglFunctions& egl) {
  std::vector<EGLDisplay> hardware;
  std::vector<EGLDisplay> software;
  const char* extensions = egl.queryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (egl.getPlatformDisplay == nullptr) return {};
  if (egl.queryDevices != nullptr && egl.queryDeviceString != nullptr &&
      contains(extensions, "EGL_EXT_platform_device")) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    egl.queryDevices(static_cast<EGLint>(devices.size()), devices.data(), &count);
    for (EGLint i = 0; i < count; ++i) {
      const char* about =
          egl.queryDeviceString(devices[static_cast<std::size_t>(i)], EGL_EXTENSIONS);
      const EGLDisplay display = egl.getPlatformDisplay(
          EGL_PLATFORM_DEVICE_EXT,
          devices[static_cast<std::size_t>(i)],
          nullptr);
      if (display == EGL_NO_DISPLAY) continue;
      (contains(about, "EGL_MESA_device_software") ? software : hardware).push_back(display);
    }
  }
  std::vector<EGLDisplay> all = hardware;
  if (contains(extensions, "EGL_MESA_platform_surfaceless")) {
    const EGLDisplay display =
        egl.getPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display != EGL_NO_DISPLAY) all.push_back(display);
  }
  all.insert(all.end(), software.begin(), software.end());
  return all;
}

}  // namespace

Result<std::unique_ptr<GlContext>> createEglContext() {
  const auto library = DynamicLibrary::open("libEGL.so.1", "libegl1");
  if (!library) return tl::unexpected(library.error());
  EglFunctions egl;
  if (!resolve(*library, "eglGetProcAddress", egl.getProcAddress) ||
      !resolve(*library, "eglQueryString", egl.queryString) ||
      !resolve(*library, "eglInitialize", egl.initialize) ||
      !resolve(*library, "eglTerminate", egl.terminate) ||
      !resolve(*library, "eglBindAPI", egl.bindApi) ||
      !resolve(*library, "eglChooseConfig", egl.chooseConfig) ||
      !resolve(*library, "eglCreateContext", egl.createContext) ||
      !resolve(*library, "eglDestroyContext", egl.destroyContext) ||
      !resolve(*library, "eglMakeCurrent", egl.makeCurrent)) {
    return fail(ErrorCode::kUnavailable, "libEGL.so.1 is not EGL 1.4: install a newer GL driver");
  }
  egl.getPlatformDisplay = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      egl.getProcAddress("eglGetPlatformDisplayEXT"));
  egl.queryDevices =
      reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(egl.getProcAddress("eglQueryDevicesEXT"));
  egl.queryDeviceString = reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(
      egl.getProcAddress("eglQueryDeviceStringEXT"));

  std::string reason = "no EGL device without a window system was found";
  for (const EGLDisplay display : candidateDisplays(egl)) {
    if (egl.initialize(display, nullptr, nullptr) == EGL_FALSE) continue;
    auto context = std::make_unique<EglContext>(egl, display);
    if (auto created = context->create(); !created) {
      reason = created.error().message;
      continue;
    }
    return context;
  }
  return fail(
      ErrorCode::kUnavailable,
      reason +
          ": install libegl-mesa0 (software drawing needs no graphics card), or use --gl osmesa");
}

}  // namespace limn
