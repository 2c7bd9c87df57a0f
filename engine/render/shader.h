// Compiles GLSL programs from files in shaders/.
#pragma once

#include <filesystem>
#include <string>

#include "render/gl_table.h"

namespace supple {

// Compiles NAME.vert and NAME.frag; a line `#include "other.glsl"` is replaced by that file. Throws RunError with the
// compiler's log.
GLuint load_program(const GlTable& gl, const std::filesystem::path& folder, const std::string& name);

}  // namespace supple
