// Manages a GLSL program and the values of its uniforms by name.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/types.h"
#include "render/gl_table.h"

namespace supple {

class Program {
 public:
  // Compiles VERTEX.vert and FRAGMENT.frag from a folder. A line `#include "other.glsl"` is replaced by that file, and
  // each of the definitions ("SAMPLES 4") becomes a #define. Throws RunError with the compiler's log.
  Program(const GlTable& gl, const std::filesystem::path& folder, const std::string& vertex,
          const std::string& fragment, const std::vector<std::string>& definitions = {});
  ~Program() { gl_.DeleteProgram(id_); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  // Makes this the current program, which the setters below require.
  void use() const { gl_.UseProgram(id_); }

  void set(const char* name, int value) const { gl_.Uniform1i(at(name), value); }
  void set(const char* name, unsigned value) const { gl_.Uniform1ui(at(name), value); }
  void set(const char* name, double value) const { gl_.Uniform1f(at(name), static_cast<float>(value)); }
  void set(const char* name, const Vec3& value) const;
  void set(const char* name, const Eigen::Vector4d& value) const;
  void set(const char* name, const Eigen::Matrix4f& value) const;
  void set_pairs(const char* name, std::span<const float> values) const;  // an array of vec2
  // Binds a texture to a unit, and makes the sampler of this name read it.
  void set_texture(const char* name, int unit, GLenum kind, GLuint texture) const;

 private:
  GLint at(const char* name) const { return gl_.GetUniformLocation(id_, name); }

  const GlTable& gl_;
  GLuint id_ = 0;
};

}  // namespace supple
