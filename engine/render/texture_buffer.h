// Holds all textures of a stage in OpenGL's memory, in linear light, with all their levels of detail, as one buffer
// that shaders read by number: textures of any sizes and numbers need no sampler each, and the filter is the same on
// all machines (shaders/texture.glsl).
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "render/draw_list.h"
#include "render/gl_table.h"
#include "render/program.h"

namespace supple {

class TextureBuffer {
 public:
  // Textures that several meshes share are held once. Where all of them are too large for the buffer, the finest levels
  // of the largest ones are left out.
  TextureBuffer(const GlTable& gl, const std::vector<DrawMesh>& meshes);
  ~TextureBuffer();
  TextureBuffer(const TextureBuffer&) = delete;
  TextureBuffer& operator=(const TextureBuffer&) = delete;

  // Returns the number that a mesh's first texture has here; those of its other textures follow.
  int first_of(const DrawMesh& mesh) const;

  // Makes a program's samplers texels and levels read these buffers. Returns the first unit that is still free.
  int bind(const Program& program, int first_unit) const;

 private:
  void make(GLuint& buffer, GLuint& texture, GLenum format, std::size_t bytes, const void* data);

  const GlTable& gl_;
  std::map<const std::vector<Texture>*, int> first_;
  std::vector<std::shared_ptr<const std::vector<Texture>>> kept_;  // so that no address above is used again
  GLuint texel_buffer_ = 0, texels_ = 0, level_buffer_ = 0, levels_ = 0;
};

// Holds a texture in linear light: four values of 16 bits a pixel, rows from the bottom.
struct LinearTexture {
  int width = 0, height = 0;
  std::vector<std::uint16_t> texels;
};
LinearTexture linear_texture(const Texture& texture);

// Returns the next coarser level: each texel is the mean over the area that it covers, also where sides are odd.
LinearTexture half_as_fine(const LinearTexture& fine);

}  // namespace supple
