#include "render/shader.h"

#include <fmt/core.h>

#include <fstream>
#include <sstream>

#include "base/error.h"

namespace supple {
namespace {

std::string read_source(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw RunError(fmt::format("{}: shader cannot be read", path.string()));
  std::string source;
  for (std::string line; std::getline(file, line);) {
    constexpr std::string_view include = "#include \"";
    if (line.starts_with(include)) {
      const std::string name = line.substr(include.size(), line.rfind('"') - include.size());
      source += read_source(path.parent_path() / name);
    } else {
      source += line + '\n';
    }
  }
  return source;
}

GLuint compile(const GlTable& gl, GLenum kind, const std::filesystem::path& path) {
  const std::string source = read_source(path);
  const char* text = source.c_str();
  const GLuint shader = gl.CreateShader(kind);
  gl.ShaderSource(shader, 1, &text, nullptr);
  gl.CompileShader(shader);
  GLint compiled = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (!compiled) {
    char log[2048] = "";
    gl.GetShaderInfoLog(shader, sizeof log, nullptr, log);
    throw RunError(fmt::format("{}: {}", path.string(), log));
  }
  return shader;
}

}  // namespace

GLuint load_program(const GlTable& gl, const std::filesystem::path& folder, const std::string& name) {
  const GLuint vertex = compile(gl, GL_VERTEX_SHADER, folder / (name + ".vert"));
  const GLuint fragment = compile(gl, GL_FRAGMENT_SHADER, folder / (name + ".frag"));
  const GLuint program = gl.CreateProgram();
  gl.AttachShader(program, vertex);
  gl.AttachShader(program, fragment);
  gl.LinkProgram(program);
  gl.DeleteShader(vertex);
  gl.DeleteShader(fragment);
  GLint linked = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
  if (!linked) {
    char log[2048] = "";
    gl.GetProgramInfoLog(program, sizeof log, nullptr, log);
    throw RunError(fmt::format("shader program {}: {}", name, log));
  }
  return program;
}

}  // namespace supple
