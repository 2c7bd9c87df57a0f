#include "render/program.h"

#include <fmt/core.h>

#include <cstdlib>
#include <sstream>

#include "base/error.h"
#include "base/read_file.h"

namespace supple {
namespace {

// Reads a file and those that it includes, whose paths are appended to `files`. Compilers know a file by its number in
// that list, and name it in their messages (GLSL 3.30, section 3.3, "#line").
std::string read_source(const std::filesystem::path& path, const std::vector<std::string>& definitions,
                        std::vector<std::filesystem::path>& files) {
  const std::size_t number = files.size();
  files.push_back(path);
  std::istringstream file(read_file(path));
  std::string source = number == 0 ? "" : fmt::format("#line 1 {}\n", number);
  int read = 0;
  for (std::string line; std::getline(file, line);) {
    ++read;
    constexpr std::string_view include = "#include \"";
    const bool included = line.starts_with(include);
    if (included) {
      const std::string name = line.substr(include.size(), line.rfind('"') - include.size());
      source += read_source(path.parent_path() / name, {}, files);
    } else {
      source += line + '\n';
    }
    if (line.starts_with("#version")) {
      for (const std::string& definition : definitions) source += "#define " + definition + '\n';
    }
    // Where a condition leaves out an include, it leaves out the #line that follows it as well.
    if (included || line.starts_with("#version") || line.starts_with("#endif"))
      source += fmt::format("#line {} {}\n", read + 1, number);
  }
  return source;
}

// Puts the names of files in the place of their numbers, which Mesa writes as "1:27(3): error: ...".
std::string with_names(const std::string& log, const std::vector<std::filesystem::path>& files) {
  std::istringstream lines(log);
  std::string named;
  for (std::string line; std::getline(lines, line);) {
    char* end = nullptr;
    const unsigned long number = std::strtoul(line.c_str(), &end, 10);
    const bool placed = end != line.c_str() && *end == ':' && number < files.size();
    named += (placed ? files[number].string() + end : line) + '\n';
  }
  return named;
}

GLuint compile(const GlTable& gl, GLenum kind, const std::filesystem::path& path,
               const std::vector<std::string>& definitions) {
  std::vector<std::filesystem::path> files;
  const std::string source = read_source(path, definitions, files);
  const char* text = source.c_str();
  const GLuint shader = gl.CreateShader(kind);
  gl.ShaderSource(shader, 1, &text, nullptr);
  gl.CompileShader(shader);
  GLint compiled = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (!compiled) {
    char log[2048] = "";
    gl.GetShaderInfoLog(shader, sizeof log, nullptr, log);
    throw RunError(fmt::format("the shader {} does not compile:\n{}", path.string(), with_names(log, files)));
  }
  return shader;
}

}  // namespace

Program::Program(const GlTable& gl, const std::filesystem::path& folder, const std::string& vertex,
                 const std::string& fragment, const std::vector<std::string>& definitions)
    : gl_(gl) {
  const GLuint first = compile(gl, GL_VERTEX_SHADER, folder / (vertex + ".vert"), definitions);
  const GLuint second = compile(gl, GL_FRAGMENT_SHADER, folder / (fragment + ".frag"), definitions);
  id_ = gl.CreateProgram();
  gl.AttachShader(id_, first);
  gl.AttachShader(id_, second);
  gl.LinkProgram(id_);
  gl.DeleteShader(first);
  gl.DeleteShader(second);
  GLint linked = 0;
  gl.GetProgramiv(id_, GL_LINK_STATUS, &linked);
  if (!linked) {
    char log[2048] = "";
    gl.GetProgramInfoLog(id_, sizeof log, nullptr, log);
    throw RunError(fmt::format("shader program {}: {}", fragment, log));
  }
}

void Program::set(const char* name, const Vec3& value) const {
  gl_.Uniform3f(at(name), static_cast<float>(value.x()), static_cast<float>(value.y()), static_cast<float>(value.z()));
}

void Program::set(const char* name, const Eigen::Vector4d& value) const {
  const Eigen::Vector4f v = value.cast<float>();
  gl_.Uniform4f(at(name), v.x(), v.y(), v.z(), v.w());
}

void Program::set(const char* name, const Eigen::Matrix4f& value) const {
  gl_.UniformMatrix4fv(at(name), 1, GL_FALSE, value.data());
}

void Program::set_pairs(const char* name, std::span<const float> values) const {
  gl_.Uniform2fv(at(name), static_cast<GLsizei>(values.size() / 2), values.data());
}

void Program::set_texture(const char* name, int unit, GLenum kind, GLuint texture) const {
  gl_.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  gl_.BindTexture(kind, texture);
  gl_.Uniform1i(at(name), unit);
}

}  // namespace supple
