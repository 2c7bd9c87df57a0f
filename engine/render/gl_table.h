// Lists the OpenGL 3.3 core functions that the renderer calls. The table is filled at run time from the context.
#pragma once

#include <GL/glcorearb.h>

#define SUPPLE_GL_FUNCTIONS(F)                                 \
  F(PFNGLACTIVETEXTUREPROC, ActiveTexture)                     \
  F(PFNGLATTACHSHADERPROC, AttachShader)                       \
  F(PFNGLBINDBUFFERPROC, BindBuffer)                           \
  F(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                 \
  F(PFNGLBINDTEXTUREPROC, BindTexture)                         \
  F(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                 \
  F(PFNGLBLENDFUNCPROC, BlendFunc)                             \
  F(PFNGLBUFFERDATAPROC, BufferData)                           \
  F(PFNGLBUFFERSUBDATAPROC, BufferSubData)                     \
  F(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus)   \
  F(PFNGLCLEARPROC, Clear)                                     \
  F(PFNGLCLEARCOLORPROC, ClearColor)                           \
  F(PFNGLCOMPILESHADERPROC, CompileShader)                     \
  F(PFNGLCREATEPROGRAMPROC, CreateProgram)                     \
  F(PFNGLCREATESHADERPROC, CreateShader)                       \
  F(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                     \
  F(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)           \
  F(PFNGLDELETEPROGRAMPROC, DeleteProgram)                     \
  F(PFNGLDELETESHADERPROC, DeleteShader)                       \
  F(PFNGLDELETETEXTURESPROC, DeleteTextures)                   \
  F(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)           \
  F(PFNGLDEPTHMASKPROC, DepthMask)                             \
  F(PFNGLDISABLEPROC, Disable)                                 \
  F(PFNGLDRAWARRAYSPROC, DrawArrays)                           \
  F(PFNGLDRAWBUFFERPROC, DrawBuffer)                           \
  F(PFNGLDRAWELEMENTSPROC, DrawElements)                       \
  F(PFNGLENABLEPROC, Enable)                                   \
  F(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray) \
  F(PFNGLFINISHPROC, Finish)                                   \
  F(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D)       \
  F(PFNGLGENBUFFERSPROC, GenBuffers)                           \
  F(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)                 \
  F(PFNGLGENTEXTURESPROC, GenTextures)                         \
  F(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)                 \
  F(PFNGLGETERRORPROC, GetError)                               \
  F(PFNGLGETINTEGERVPROC, GetIntegerv)                         \
  F(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)             \
  F(PFNGLGETPROGRAMIVPROC, GetProgramiv)                       \
  F(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)               \
  F(PFNGLGETSHADERIVPROC, GetShaderiv)                         \
  F(PFNGLGETSTRINGPROC, GetString)                             \
  F(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)           \
  F(PFNGLLINKPROGRAMPROC, LinkProgram)                         \
  F(PFNGLPIXELSTOREIPROC, PixelStorei)                         \
  F(PFNGLPOLYGONOFFSETPROC, PolygonOffset)                     \
  F(PFNGLREADBUFFERPROC, ReadBuffer)                           \
  F(PFNGLREADPIXELSPROC, ReadPixels)                           \
  F(PFNGLSHADERSOURCEPROC, ShaderSource)                       \
  F(PFNGLTEXBUFFERPROC, TexBuffer)                             \
  F(PFNGLTEXIMAGE2DPROC, TexImage2D)                           \
  F(PFNGLTEXPARAMETERIPROC, TexParameteri)                     \
  F(PFNGLTEXSUBIMAGE2DPROC, TexSubImage2D)                     \
  F(PFNGLUNIFORM1FPROC, Uniform1f)                             \
  F(PFNGLUNIFORM1IPROC, Uniform1i)                             \
  F(PFNGLUNIFORM1UIPROC, Uniform1ui)                           \
  F(PFNGLUNIFORM2FVPROC, Uniform2fv)                           \
  F(PFNGLUNIFORM3FPROC, Uniform3f)                             \
  F(PFNGLUNIFORM4FPROC, Uniform4f)                             \
  F(PFNGLUNIFORM4FVPROC, Uniform4fv)                           \
  F(PFNGLUNIFORMMATRIX4FVPROC, UniformMatrix4fv)               \
  F(PFNGLUSEPROGRAMPROC, UseProgram)                           \
  F(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)         \
  F(PFNGLVIEWPORTPROC, Viewport)

namespace supple {

class GlContext;

struct GlTable {
#define SUPPLE_GL_MEMBER(type, name) type name = nullptr;
  SUPPLE_GL_FUNCTIONS(SUPPLE_GL_MEMBER)
#undef SUPPLE_GL_MEMBER
};

// Throws RunError with the name of the first function that the context does not have.
GlTable load_gl(const GlContext& context);

// Throws RunError when GL has recorded an error; the message says what was being done.
void check_gl(const GlTable& gl, const char* doing);

}  // namespace supple
