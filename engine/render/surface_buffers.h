// Holds all surfaces of a stage in OpenGL's memory, one after the other: as vertices and indices for the shadow map,
// and as buffer textures for the pass that shades, which is given only the number of a triangle and looks up the rest.
#pragma once

#include <vector>

#include "render/draw_list.h"
#include "render/gl_table.h"
#include "render/program.h"
#include "render/texture_buffer.h"

namespace supple {

class SurfaceBuffers {
 public:
  SurfaceBuffers(const GlTable& gl, const std::vector<DrawMesh>& meshes, const TextureBuffer& textures);
  ~SurfaceBuffers();
  SurfaceBuffers(const SurfaceBuffers&) = delete;
  SurfaceBuffers& operator=(const SurfaceBuffers&) = delete;

  // Uploads the positions of the vertices (x y z, by mesh) and the normals that follow from them, and the field where
  // meshes show one. The meshes must be those for which the buffers were made.
  void upload(const std::vector<DrawMesh>& meshes, const DrawList& list);

  // Draws the triangles that cast one mesh's shadow, which may be fewer than it has.
  void draw_caster(std::size_t mesh) const;

  // Makes a program's samplers places, normals, triangles, paint, squares, flats, materials, values, tints and
  // texture_places read these buffers. Returns the first unit that is still free.
  int bind(const Program& program, int first_unit) const;

 private:
  // Describes a buffer that shaders read as a texture with one texel for each element.
  struct Lookup {
    GLuint buffer = 0, texture = 0;
  };
  struct Range {
    unsigned first_vertex, first_caster, casters;
  };

  void make_lookup(Lookup& lookup, GLenum format, std::size_t bytes, const void* data, GLenum usage);
  void upload_field(const std::vector<DrawMesh>& meshes, const std::vector<std::vector<float>>& field);
  void put(const Lookup& lookup, const std::vector<float>& data) const;
  void make_static(const std::vector<DrawMesh>& meshes);
  void make_colors(const std::vector<DrawMesh>& meshes, const TextureBuffer& textures);

  const GlTable& gl_;
  std::vector<Range> ranges_;  // by mesh
  GLuint array_ = 0, indices_ = 0;
  Lookup places_;          // by vertex: x y z, and the open sky
  Lookup normals_;         // by vertex, and of cloth how hollow it is there
  Lookup triangles_;       // three vertices, and packed_look
  Lookup paint_;           // by vertex and layer: distances, eight for each vertex
  Lookup squares_;         // by vertex: place in the printed pattern
  Lookup flats_;           // by vertex: place on the flat cloth; empty when no mesh is cloth
  Lookup materials_;       // by mesh, see material_texels
  Lookup tints_;           // by vertex: the file's linear colour, and the number of its texture from one or zero
  Lookup texture_places_;  // by vertex: place in that texture; tints_ and this are empty without colours of files
  Lookup values_;          // by vertex: the field; empty when no mesh shows one
  std::vector<float> place_data_, normal_data_, value_data_;
};

}  // namespace supple
