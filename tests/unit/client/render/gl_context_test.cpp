// SPDX-License-Identifier: Apache-2.0
#include "client/render/gl_context.h"

#include "shared/gl/dynamic_library.h"
#include "shared/gl/program.h"
#include "shared/gl/target.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

class ContextOf : public testing::TestWithParam<GlBackend> {};

TEST_P(ContextOf, MakesAContextThatCompilesEs3Shaders) {
  auto context = createGlContext(GetParam());
  ASSERT_TRUE(context) << context.error().message;
  const gl::Api& api = (*context)->api();
  const auto program = gl::Program::build(
      api,
      "test",
      "#version 300 es\nvoid main() { gl_Position = vec4(0.0); }\n",
      "#version 300 es\nprecision highp float;\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n");
  EXPECT_TRUE(program) << program.error().message;
}

TEST_P(ContextOf, AShaderMistakeIsOneLineThatNamesTheShader) {
  auto context = createGlContext(GetParam());
  ASSERT_TRUE(context) << context.error().message;
  const auto program = gl::Program::build(
      (*context)->api(),
      "mistaken",
      "#version 300 es\nvoid main() { gl_Position = vec4(0.0); }\n",
      "#version 300 es\nprecision highp float;\nvoid main() { undeclared = 1.0; }\n");
  ASSERT_FALSE(program);
  EXPECT_EQ(program.error().code, ErrorCode::kUnavailable);
  EXPECT_NE(program.error().message.find("fragment shader of 'mistaken'"), std::string::npos);
  EXPECT_NE(program.error().message.find("undeclared"), std::string::npos);
  EXPECT_EQ(program.error().message.find('\n'), std::string::npos);
}

TEST_P(ContextOf, ATargetLargerThanTheGlAllowsIsAnError) {
  auto context = createGlContext(GetParam());
  ASSERT_TRUE(context) << context.error().message;
  const auto target =
      gl::Target::create((*context)->api(), "a huge picture", {.size = {1 << 20, 16}});
  ASSERT_FALSE(target);
  EXPECT_EQ(target.error().code, ErrorCode::kLimitExceeded);
}

INSTANTIATE_TEST_SUITE_P(
    Backends,
    ContextOf,
    testing::Values(GlBackend::kEgl, GlBackend::kOsmesa),
    [](const auto& backend) { return backend.param == GlBackend::kEgl ? "Egl" : "Osmesa"; });

TEST(GlContext, OneProgramUsesBothLibrariesInTurn) {
  const auto version = [](GlBackend backend) {
    auto context = createGlContext(backend);
    EXPECT_TRUE(context) << context.error().message;
    if (!context) return std::string();
    return std::string(reinterpret_cast<const char*>((*context)->api().getString(GL_VERSION)));
  };
  EXPECT_NE(version(GlBackend::kEgl).find("OpenGL ES"), std::string::npos);
  EXPECT_EQ(version(GlBackend::kOsmesa).find("OpenGL ES"), std::string::npos);
  EXPECT_NE(version(GlBackend::kEgl).find("OpenGL ES"), std::string::npos);
}

TEST(GlContext, TwoContextsOfOneLibraryChangePlaces) {
  auto first = createGlContext(GlBackend::kEgl);
  auto second = createGlContext(GlBackend::kEgl);
  ASSERT_TRUE(first && second);
  // Each has objects of its own.
  ASSERT_TRUE((*first)->makeCurrent());
  const gl::Buffer buffer = gl::Buffer::create((*first)->api());
  ASSERT_TRUE((*second)->makeCurrent());
  EXPECT_EQ(gl::Buffer::create((*second)->api()).id(), buffer.id());
  ASSERT_TRUE((*first)->makeCurrent());
}

TEST(GlContext, AMissingLibraryIsAnErrorThatSaysWhatToInstall) {
  const auto library = DynamicLibrary::open("libLimnHasNoSuchLibrary.so.1", "a-package");
  ASSERT_FALSE(library);
  EXPECT_EQ(library.error().code, ErrorCode::kUnavailable);
  EXPECT_NE(library.error().message.find("a-package"), std::string::npos);
}

TEST(GlContext, AMissingEntryPointIsNamed) {
  const auto api = gl::loadApi([](const char*) -> gl::AnyFunction { return nullptr; });
  ASSERT_FALSE(api);
  EXPECT_EQ(api.error().code, ErrorCode::kUnavailable);
  EXPECT_NE(api.error().message.find("glActiveTexture"), std::string::npos);
}

TEST(GlContext, BackendNamesAreParsedAndOthersRefused) {
  EXPECT_EQ(parseGlBackend("egl").value(), GlBackend::kEgl);
  EXPECT_EQ(parseGlBackend("osmesa").value(), GlBackend::kOsmesa);
  EXPECT_EQ(parseGlBackend("vulkan").error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace limn
