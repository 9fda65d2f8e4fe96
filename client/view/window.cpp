// SPDX-License-Identifier: Apache-2.0
#include "client/view/window.h"

#include "shared/gl/api.h"
#include "shared/gl/handles.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <utility>

namespace limn {
namespace {

std::string lastGlfwComplaint() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "no reason given" : text;
}

tl::unexpected<Error> unavailable(const std::string& what) {
  return fail(
      ErrorCode::kUnavailable,
      what + " (" + lastGlfwComplaint() +
          "): run limn-client view on a desktop (DISPLAY or WAYLAND_DISPLAY set), or draw files "
          "with limn-client render");
}

ImTextureID textureId(const gl::Texture& texture) {
  return reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(texture.id()));
}

}  // namespace

struct Window::Impl {
  GLFWwindow* window = nullptr;
  bool hasImGui = false;
  gl::Api api;
  gl::Texture picture;
  int width = 0;  // of the picture
  int height = 0;

  ~Impl() {
    picture.reset();
    if (hasImGui) {
      ImGui_ImplOpenGL3_Shutdown();
      ImGui_ImplGlfw_Shutdown();
      ImGui::DestroyContext();
    }
    if (window != nullptr) glfwDestroyWindow(window);
    glfwTerminate();
  }

  Result<void> open(const std::string& title, const Viewport& size) {
    glfwInitHint(GLFW_COCOA_MENUBAR, GLFW_FALSE);
    if (glfwInit() != GLFW_TRUE) return unavailable("cannot open a window");
    glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_ES_API);
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 0);
    window = glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
    if (window == nullptr) return unavailable("cannot open a window with GLES 3");
    glfwMakeContextCurrent(window);
    glfwSwapInterval(1);
    auto loaded = gl::loadApi(&glfwGetProcAddress);
    if (!loaded) return tl::unexpected(loaded.error());
    api = *loaded;
    ImGui::CreateContext();
    hasImGui = true;
    ImGui::GetIO().IniFilename = nullptr;  // what is remembered, the caller remembers
    ImGui::StyleColorsLight();
    if (!ImGui_ImplGlfw_InitForOpenGL(window, true) || !ImGui_ImplOpenGL3_Init("#version 300 es")) {
      return unavailable("cannot set up the window's menus");
    }
    return {};
  }
};

Window::Window(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Window::~Window() = default;

Result<std::unique_ptr<Window>> Window::open(const std::string& title, const Viewport& size) {
  auto impl = std::make_unique<Impl>();
  if (auto ok = impl->open(title, size); !ok) return tl::unexpected(ok.error());
  return std::unique_ptr<Window>(new Window(std::move(impl)));
}

bool Window::isOpen() const {
  return glfwWindowShouldClose(impl_->window) == GLFW_FALSE;
}

void Window::close() {
  glfwSetWindowShouldClose(impl_->window, GLFW_TRUE);
}

void Window::setTitle(const std::string& title) {
  glfwSetWindowTitle(impl_->window, title.c_str());
}

void Window::waitForEvents(double seconds) {
  glfwWaitEventsTimeout(seconds);
}

void Window::wake() {
  glfwPostEmptyEvent();
}

void Window::beginFrame() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  if (!impl_->picture) return;
  const ImVec2 corner = ImGui::GetIO().DisplaySize;
  ImGui::GetBackgroundDrawList()->AddImage(textureId(impl_->picture), {0.0F, 0.0F}, corner);
}

void Window::show(const Image& picture) {
  const gl::Api& gl = impl_->api;
  const bool isNewSize = picture.width != impl_->width || picture.height != impl_->height;
  if (!impl_->picture) impl_->picture = gl::Texture::create(gl);
  gl.bindTexture(GL_TEXTURE_2D, impl_->picture.id());
  if (isNewSize) {
    gl.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  gl.texImage2D(
      GL_TEXTURE_2D,
      0,
      GL_RGBA8,
      picture.width,
      picture.height,
      0,
      GL_RGBA,
      GL_UNSIGNED_BYTE,
      picture.rgba.data());
  impl_->width = picture.width;
  impl_->height = picture.height;
}

void Window::endFrame() {
  ImGui::Render();
  const Viewport pixels = size();
  const gl::Api& gl = impl_->api;
  gl.viewport(0, 0, pixels.width, pixels.height);
  gl.clearColor(1.0F, 1.0F, 1.0F, 1.0F);
  gl.clear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSwapBuffers(impl_->window);
}

Viewport Window::size() const {
  Viewport size{0, 0};
  glfwGetFramebufferSize(impl_->window, &size.width, &size.height);
  return size;
}

double Window::pixelRatio() const {
  int width = 0;
  int height = 0;
  glfwGetWindowSize(impl_->window, &width, &height);
  return width > 0 ? static_cast<double>(size().width) / width : 1.0;
}

double Window::nowSeconds() {
  return glfwGetTime();
}

}  // namespace limn
