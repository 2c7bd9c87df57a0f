#include "render/gl_table.h"

#include <fmt/core.h>

#include "base/error.h"
#include "render/gl_context.h"

namespace supple {

GlTable load_gl(const GlContext& context) {
  GlTable gl;
#define SUPPLE_GL_LOAD(type, name)                               \
  gl.name = reinterpret_cast<type>(context.resolve("gl" #name)); \
  if (gl.name == nullptr) throw RunError("this OpenGL has no gl" #name);
  SUPPLE_GL_FUNCTIONS(SUPPLE_GL_LOAD)
#undef SUPPLE_GL_LOAD
  return gl;
}

void check_gl(const GlTable& gl, const char* doing) {
  const GLenum error = gl.GetError();
  if (error != GL_NO_ERROR) throw RunError(fmt::format("OpenGL error 0x{:04x} while {}", error, doing));
}

}  // namespace supple
