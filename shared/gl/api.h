// SPDX-License-Identifier: Apache-2.0
#pragma once

// Only the types and constants of GLES: every entry point is called through Api, so that one
// program can hold several GL libraries (EGL's and OSMesa's) without their symbols meeting.
#undef GL_GLES_PROTOTYPES
#define GL_GLES_PROTOTYPES 0
#include "shared/core/result.h"

#include <GLES3/gl32.h>

#include <string_view>

/// The entry points Limn uses, all of GLES 3.0 core: X(member, GL name without gl, pointer type).
#define LIMN_GL_ENTRY_POINTS(X)                                                         \
  X(activeTexture, ActiveTexture, PFNGLACTIVETEXTUREPROC)                               \
  X(attachShader, AttachShader, PFNGLATTACHSHADERPROC)                                  \
  X(bindBuffer, BindBuffer, PFNGLBINDBUFFERPROC)                                        \
  X(bindFramebuffer, BindFramebuffer, PFNGLBINDFRAMEBUFFERPROC)                         \
  X(bindTexture, BindTexture, PFNGLBINDTEXTUREPROC)                                     \
  X(bindVertexArray, BindVertexArray, PFNGLBINDVERTEXARRAYPROC)                         \
  X(blendEquation, BlendEquation, PFNGLBLENDEQUATIONPROC)                               \
  X(blendFunc, BlendFunc, PFNGLBLENDFUNCPROC)                                           \
  X(bufferData, BufferData, PFNGLBUFFERDATAPROC)                                        \
  X(checkFramebufferStatus, CheckFramebufferStatus, PFNGLCHECKFRAMEBUFFERSTATUSPROC)    \
  X(clear, Clear, PFNGLCLEARPROC)                                                       \
  X(clearColor, ClearColor, PFNGLCLEARCOLORPROC)                                        \
  X(clearDepthf, ClearDepthf, PFNGLCLEARDEPTHFPROC)                                     \
  X(clearStencil, ClearStencil, PFNGLCLEARSTENCILPROC)                                  \
  X(colorMask, ColorMask, PFNGLCOLORMASKPROC)                                           \
  X(compileShader, CompileShader, PFNGLCOMPILESHADERPROC)                               \
  X(createProgram, CreateProgram, PFNGLCREATEPROGRAMPROC)                               \
  X(createShader, CreateShader, PFNGLCREATESHADERPROC)                                  \
  X(deleteBuffers, DeleteBuffers, PFNGLDELETEBUFFERSPROC)                               \
  X(deleteFramebuffers, DeleteFramebuffers, PFNGLDELETEFRAMEBUFFERSPROC)                \
  X(deleteProgram, DeleteProgram, PFNGLDELETEPROGRAMPROC)                               \
  X(deleteShader, DeleteShader, PFNGLDELETESHADERPROC)                                  \
  X(deleteTextures, DeleteTextures, PFNGLDELETETEXTURESPROC)                            \
  X(deleteVertexArrays, DeleteVertexArrays, PFNGLDELETEVERTEXARRAYSPROC)                \
  X(depthFunc, DepthFunc, PFNGLDEPTHFUNCPROC)                                           \
  X(depthMask, DepthMask, PFNGLDEPTHMASKPROC)                                           \
  X(disable, Disable, PFNGLDISABLEPROC)                                                 \
  X(drawArrays, DrawArrays, PFNGLDRAWARRAYSPROC)                                        \
  X(drawArraysInstanced, DrawArraysInstanced, PFNGLDRAWARRAYSINSTANCEDPROC)             \
  X(drawBuffers, DrawBuffers, PFNGLDRAWBUFFERSPROC)                                     \
  X(drawElements, DrawElements, PFNGLDRAWELEMENTSPROC)                                  \
  X(enable, Enable, PFNGLENABLEPROC)                                                    \
  X(enableVertexAttribArray, EnableVertexAttribArray, PFNGLENABLEVERTEXATTRIBARRAYPROC) \
  X(finish, Finish, PFNGLFINISHPROC)                                                    \
  X(framebufferTexture2D, FramebufferTexture2D, PFNGLFRAMEBUFFERTEXTURE2DPROC)          \
  X(genBuffers, GenBuffers, PFNGLGENBUFFERSPROC)                                        \
  X(genFramebuffers, GenFramebuffers, PFNGLGENFRAMEBUFFERSPROC)                         \
  X(genTextures, GenTextures, PFNGLGENTEXTURESPROC)                                     \
  X(genVertexArrays, GenVertexArrays, PFNGLGENVERTEXARRAYSPROC)                         \
  X(generateMipmap, GenerateMipmap, PFNGLGENERATEMIPMAPPROC)                            \
  X(getError, GetError, PFNGLGETERRORPROC)                                              \
  X(getIntegerv, GetIntegerv, PFNGLGETINTEGERVPROC)                                     \
  X(getProgramInfoLog, GetProgramInfoLog, PFNGLGETPROGRAMINFOLOGPROC)                   \
  X(getProgramiv, GetProgramiv, PFNGLGETPROGRAMIVPROC)                                  \
  X(getShaderInfoLog, GetShaderInfoLog, PFNGLGETSHADERINFOLOGPROC)                      \
  X(getShaderiv, GetShaderiv, PFNGLGETSHADERIVPROC)                                     \
  X(getString, GetString, PFNGLGETSTRINGPROC)                                           \
  X(getUniformLocation, GetUniformLocation, PFNGLGETUNIFORMLOCATIONPROC)                \
  X(linkProgram, LinkProgram, PFNGLLINKPROGRAMPROC)                                     \
  X(pixelStorei, PixelStorei, PFNGLPIXELSTOREIPROC)                                     \
  X(readBuffer, ReadBuffer, PFNGLREADBUFFERPROC)                                        \
  X(readPixels, ReadPixels, PFNGLREADPIXELSPROC)                                        \
  X(shaderSource, ShaderSource, PFNGLSHADERSOURCEPROC)                                  \
  X(stencilFunc, StencilFunc, PFNGLSTENCILFUNCPROC)                                     \
  X(stencilOpSeparate, StencilOpSeparate, PFNGLSTENCILOPSEPARATEPROC)                   \
  X(texImage2D, TexImage2D, PFNGLTEXIMAGE2DPROC)                                        \
  X(texParameteri, TexParameteri, PFNGLTEXPARAMETERIPROC)                               \
  X(texStorage2D, TexStorage2D, PFNGLTEXSTORAGE2DPROC)                                  \
  X(texSubImage2D, TexSubImage2D, PFNGLTEXSUBIMAGE2DPROC)                               \
  X(uniform1f, Uniform1f, PFNGLUNIFORM1FPROC)                                           \
  X(uniform1i, Uniform1i, PFNGLUNIFORM1IPROC)                                           \
  X(uniform2f, Uniform2f, PFNGLUNIFORM2FPROC)                                           \
  X(uniform2i, Uniform2i, PFNGLUNIFORM2IPROC)                                           \
  X(uniform3f, Uniform3f, PFNGLUNIFORM3FPROC)                                           \
  X(uniform4f, Uniform4f, PFNGLUNIFORM4FPROC)                                           \
  X(uniformMatrix4fv, UniformMatrix4fv, PFNGLUNIFORMMATRIX4FVPROC)                      \
  X(useProgram, UseProgram, PFNGLUSEPROGRAMPROC)                                        \
  X(vertexAttribDivisor, VertexAttribDivisor, PFNGLVERTEXATTRIBDIVISORPROC)             \
  X(vertexAttribIPointer, VertexAttribIPointer, PFNGLVERTEXATTRIBIPOINTERPROC)          \
  X(vertexAttribPointer, VertexAttribPointer, PFNGLVERTEXATTRIBPOINTERPROC)             \
  X(viewport, Viewport, PFNGLVIEWPORTPROC)

namespace limn::gl {

/// GL's entry points as one library resolved them. Calls act on the context that is current on the
/// calling thread; an Api must only be used with contexts of the library it was loaded from.
struct Api {
#define LIMN_GL_MEMBER(member, name, type) type member = nullptr;
  LIMN_GL_ENTRY_POINTS(LIMN_GL_MEMBER)
#undef LIMN_GL_MEMBER
};

using AnyFunction = void (*)();
/// eglGetProcAddress, OSMesaGetProcAddress or the like.
using GetProcAddress = AnyFunction (*)(const char* name);

/// Resolves every entry point. Errors: kUnavailable, naming the first one missing.
[[nodiscard]] Result<Api> loadApi(GetProcAddress getProcAddress);

}  // namespace limn::gl
